"""Every parquet file says the unit of each column, and when each of its rows was."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from datetime import date, datetime, timedelta
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st

import waxstudy
from waxstudy.plugin.registry import installed
from waxstudy.results.kpis import TRACE_CHANNELS, stamps
from waxstudy.results.parquet import write_parquet
from waxstudy.results.run import CaseFolder, Run, writing_case
from waxstudy.simulation.run import prepare
from waxstudy.study.read import read_study

DAYS, DAY_S = 365, 86_400
FIRST_DAY = "2023-01-01"


def units_in(path: Path) -> dict[str, str]:
    """Return column -> unit as the file says it; fails where a column says none."""
    return {field.name: field.metadata[b"unit"].decode() for field in pq.read_schema(path)}


@cache
def a_year(interval_s: float) -> pd.DataFrame:
    return pd.DataFrame(stamps(FIRST_DAY, interval_s, round(DAYS * DAY_S / interval_s)))


def written(trace: pd.DataFrame, place: Path) -> pa.Table:
    """Return a member's trace as it can be read from the folder of its case."""
    case = CaseFolder("case", "year", "0" * 16)
    (place / "cases").mkdir()
    table = trace.assign(**dict.fromkeys(TRACE_CHANNELS, 21.0), member=0)
    with writing_case(place, case) as writer:
        writer.trace(table)
        writer.figures(pd.DataFrame(), pd.DataFrame())
    return pq.read_table(place / "cases" / case.name / "traces.parquet")


@given(day=st.integers(0, DAYS - 1), interval_s=st.sampled_from([2.5, 5.0, 60.0]))
def test_stamps_of_a_trace_are_exact_over_a_year(day: int, interval_s: float) -> None:
    rows = round(DAY_S / interval_s)
    with tempfile.TemporaryDirectory() as place:
        read = written(a_year(interval_s)[day * rows :][:rows].reset_index(drop=True), Path(place))
    ends_s = [DAY_S * day + interval_s * (n + 1) for n in range(rows)]
    assert read["time_s"].to_pylist() == ends_s
    assert read["time"].to_pylist() == [datetime.fromisoformat(FIRST_DAY) + timedelta(seconds=s) for s in ends_s]


@given(first_day=st.dates(date(1700, 1, 1)), tenths=st.integers(1, 36_000), row=st.integers(1, 1000))
def test_stamps_are_calendar_time_at_the_ends_of_intervals(first_day: date, tenths: int, row: int) -> None:
    time = stamps(first_day.isoformat(), tenths / 10, row)["time"]
    assert time[-1] == np.datetime64(first_day, "ms") + np.timedelta64(100 * tenths * row, "ms")


def test_every_file_of_a_run_has_units_and_its_traces_the_calendar(finished: Path) -> None:
    run = Run(finished)
    files = sorted(finished.rglob("*.parquet"))
    assert len(files) == 2 * len(run.cases)
    for path in files:
        told = units_in(path)
        assert told.pop("member") == "1"
        assert told.pop("percent", "%") == "%"
        assert told.pop("time", "local standard time") == "local standard time"
        for name, unit in told.items():
            assert unit == "1" or name.endswith("_" + unit.replace("/", "_")), name
    trace = run.traces("O_CP", "january")
    assert trace["time"].iloc[[0, -1]].astype(str).tolist() == ["2021-01-01 00:01:00", "2021-01-08 00:00:00"]
    assert (trace["time_s"].to_numpy() == 60.0 * np.arange(1, len(trace) + 1)).all()


def test_the_same_weather_of_another_year_computes_its_case_again(small_study: Path) -> None:
    plan = prepare(read_study(small_study, installed()))
    (case, *_), driven = plan.study.cases.values(), plan.driven["january"]
    plan.driven["later"] = replace(driven, weather=replace(driven.weather, first_day="2024-01-01"))
    assert plan.key(case, "later") != plan.key(case, "january")


def test_a_column_without_a_unit_is_not_written(tmp_path: Path) -> None:
    with pytest.raises(KeyError, match="moisture"):
        write_parquet(pd.DataFrame({"moisture": [0.0]}), tmp_path / "x.parquet", {"air_C": "C"})
    assert list(tmp_path.iterdir()) == []


def test_all_parquet_files_are_written_in_one_place() -> None:
    sources = [path for folder in waxstudy.__path__ for path in Path(folder).rglob("*.py")]
    writing = [path.name for path in sources if any(w in path.read_text() for w in ("to_parquet", "write_table("))]
    assert writing == ["parquet.py"]
