"""Two days of a loop, as it was recorded and as eight exports of it."""

from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from tests.cli.conftest import entry
from tests.importing.exports import CHANNELS, Export, exports
from tests.synthetic.conftest import SETPOINT_C, simulated, study
from waxstudy.dataset.channels import CHANNELS as ALL
from waxstudy.study.model import Study
from waxstudy.synthetic.instruments import Instruments, measure
from waxstudy.synthetic.simulate import reality_loop, simulate

__all__ = ["entry", "simulated", "study"]


@pytest.fixture(scope="session")
def record(study: Study) -> pd.DataFrame:
    """Channels that a house may log, at 1 min."""
    reality = simulate(reality_loop(study, study.cases["O_WM"], ["january"], 2), study, SETPOINT_C)
    data = measure(reality, Instruments(without=tuple(name for name in ALL if name not in CHANNELS)))
    return data.set_index(pd.DatetimeIndex(data["time"], name="time"))[list(CHANNELS)]


@pytest.fixture(scope="session")
def made(record: pd.DataFrame, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Export]:
    return exports(record, tmp_path_factory.mktemp("exports"))


def read(folder: Path) -> pd.DataFrame:
    return pd.read_csv(folder / "data.csv", index_col="time", parse_dates=["time"])
