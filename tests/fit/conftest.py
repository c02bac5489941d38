"""A record of the bench that every test may spoil in its own way, and what is to come out of it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pandas as pd
import pytest

from waxstudy.identification.description import described
from waxstudy.identification.records import Record, read_records
from waxstudy.identification.times import cycles_of
from waxstudy.rig.bench import Motors, run_trial
from waxstudy.rig.instruments import Bench
from waxstudy.rig.programme import Trial

QUIET = Bench(spikes_per_day=0.0)
STEADY = Trial("B1", "B", "1", False, (15.0, 15.0), (15.0, 15.0), 240.0, "displacement")


def table_of(trial: Trial, bench: Bench = QUIET, seed: int = 1, actuator: str = "variable-times") -> pd.DataFrame:
    """Return a record of the bench as the columns of its file."""
    made = run_trial(Motors(actuator, {}, "quick-opening", bench, seed), trial)
    return pd.DataFrame({"time_s": made.time_s, "displacement_mm": made.value, "signal_V": made.signal_V})


@pytest.fixture(scope="session")
def steady() -> pd.DataFrame:
    """Four hours of a motor heated 15-15 min, in seconds, millimetres and volts."""
    return table_of(STEADY)


Read = Callable[..., Record]


@pytest.fixture
def read(tmp_path: Path) -> Read:
    """Write a record as text, or a table as CSV, and read it as the fit does."""

    def reading(content: str | bytes | pd.DataFrame, name: str = "record.csv") -> Record:
        path = tmp_path / name
        if isinstance(content, pd.DataFrame):
            content.to_csv(path, index=False)
        elif isinstance(content, bytes):
            path.write_bytes(content)
        else:
            path.write_text(content, encoding="utf-8")
        (record,) = read_records(described([path]), "B")
        return record

    return reading


def medians(record: Record) -> dict[str, float]:
    """Return the medians of the times of the cycles that are used [s]."""
    cycles = cycles_of(record)
    kept = cycles[(cycles["lost"] == "") & (cycles["cycle"] > 1)]
    return {name: float(kept[name].median()) for name in ("dead_s", "rise_s", "overheat_s", "hold_s", "fall_s")}
