"""Two days of the small study's cases, simulated once."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from tests.conftest import SMALL
from waxstudy.plugin.registry import installed
from waxstudy.study.model import Study
from waxstudy.study.read import read_study
from waxstudy.synthetic.instruments import Instruments
from waxstudy.synthetic.simulate import Reality, reality_loop, simulate
from waxstudy.synthetic.write import Telling, write

DELAYED = '{ id = "O_D", sensor = { use = "delay", delay_s = 600.0 } },\n'
SETPOINT_C = 21.0

Simulated = Callable[[str], Reality]


@pytest.fixture(scope="session")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    """The small study with a delayed sensor from O_D on, and a second week."""
    path = tmp_path_factory.mktemp("dataset") / "small.toml"
    text = SMALL.replace('  { id = "O_WM"', f'  {DELAYED}  {{ id = "O_WM"')
    path.write_text(text + '\n[weather.february]\nuse = "tallinn-week"\nmonth = "february"\n')
    return read_study(path, installed())


@pytest.fixture(scope="session")
def simulated(study: Study) -> Simulated:
    """The first two days of a case."""

    @cache
    def simulated(case: str) -> Reality:
        return simulate(reality_loop(study, study.cases[case], ["january"], 2), study, SETPOINT_C)

    return simulated


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "room-7"


def written(folder: Path, study: Study, simulated: Simulated, case: str, believed: str, **measured: Any) -> Path:
    telling = Telling(study, study.cases[case], study.cases[believed], ["january"], SETPOINT_C)
    write(folder, telling, simulated(case), Instruments(**measured))
    return folder


def described(folder: Path) -> dict[str, Any]:
    return tomllib.loads((folder / "dataset.toml").read_text(encoding="utf-8"))
