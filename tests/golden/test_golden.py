"""Results stay what they were, to the tolerance that their own scatter allows."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.golden.compare import differences
from tests.golden.results import (
    GOLDEN,
    KEYS,
    SEASON,
    SEASON_MEMBERS,
    SWEEP_MEMBERS,
    SWEPT,
    fleet,
    looped,
    season,
    swept,
    table,
    traces,
    tuned,
)
from waxstudy.report.comparison import COLUMNS
from waxstudy.simulation import kernel

TRACE_KEYS = (*KEYS, "minute")
# temperatures [K], heat [W/m2, W] and fractions: far above rounding, far below anything that a reader could see
TRACE_TOLERANCE = dict.fromkeys(kernel.TRACE, 1e-6)
TURNING = ["resolved", "single_run_share", "corrected_resolved", "corrected_single_run_share"]
FLEET_KEYS = ("week", "state", "at_h")
# s, K, C, min and shares, of 40 loops whose cycles may begin a period sooner or later
WITHOUT_BAND = {
    **dict.fromkeys(("loops", "slowest_s"), 5.0),
    **dict.fromkeys(("warmer_K", "colder_K", "warmest_C", "coldest_C"), 0.1),
    **dict.fromkeys(("below_min", "below_without_min"), 1.0),
    **dict.fromkeys(("opening_before", "idle_share"), 0.1),
}
SHIFT_K = 2e-3  # of the search for equal comfort: a quarter of an hour a week
STANDARD_ERRORS = 2.0  # the 95 % interval of an ensemble mean


def test_short_traces_are_the_golden_ones() -> None:
    golden = pd.read_csv(GOLDEN / "traces.csv")
    assert differences(golden, traces(), TRACE_KEYS, TRACE_TOLERANCE) == []


@pytest.mark.slow
def test_ensemble_means_lie_within_their_standard_error(tmp_path: Path) -> None:
    golden = pd.read_csv(GOLDEN / "table5.csv")
    fresh = table(tmp_path / "run")
    # whether a difference is resolved may turn with the last digit of an interval; its figures are compared
    golden, fresh = golden.drop(columns=TURNING), fresh.drop(columns=TURNING)
    assert differences(golden, fresh, KEYS, _tolerance(golden)) == []


@pytest.mark.slow
def test_the_rooms_of_a_sweep_have_their_golden_figures(tmp_path: Path) -> None:
    golden = pd.read_csv(GOLDEN / "sweep.csv")
    allowed = _of_members(golden, SWEPT, SWEEP_MEMBERS)
    assert differences(golden, swept(tmp_path / "sweep"), ("point", "case"), allowed) == []


@pytest.mark.slow
def test_the_cases_of_a_season_have_their_golden_figures(tmp_path: Path) -> None:
    golden = pd.read_csv(GOLDEN / "season.csv")
    allowed = _of_members(golden, SEASON, SEASON_MEMBERS)
    assert differences(golden, season(tmp_path), ("case",), allowed) == []


def test_loops_have_their_golden_margins_and_wear() -> None:
    """They are linearised where members work, which hardly moves; strokes a day of four members may be a tenth off."""
    golden = pd.read_csv(GOLDEN / "loop.csv")
    share = {name: 0.1 if name.endswith("per_day") else 0.02 for name in golden if name != "case"}
    allowed = {name: each * golden[name].abs() + 1e-6 for name, each in share.items()}
    assert differences(golden, looped(), ("case",), allowed) == []


@pytest.mark.slow
def test_a_tuning_finds_what_it_did(tmp_path: Path) -> None:
    """A hundredth of the score; the point itself lies in a flat valley, and may be a third off."""
    golden = pd.read_csv(GOLDEN / "tune.csv")
    allowed = {name: 0.3 * golden[name] for name in golden if name != "setting"} | {"score": 0.01}
    assert differences(golden, tuned(tmp_path / "tuned"), ("setting",), allowed) == []


def _of_members(golden: pd.DataFrame, columns: Sequence[str], members: int) -> dict[str, float | pd.Series]:
    """Means within two standard errors, spreads within their 95 % range, all within what the search for shifts leaves.

    A kelvin of shift is at most a kelvin of error, and 0.5 kWh/m2 a week of heat in these rooms.
    """
    allowed: dict[str, float | pd.Series] = {}
    for column in columns:
        spread = golden[f"{column}_sd"]
        allowed[column] = STANDARD_ERRORS * spread / np.sqrt(members) + SHIFT_K
        allowed[f"{column}_sd"] = STANDARD_ERRORS * spread / np.sqrt(2.0 * (members - 1)) + SHIFT_K
    return allowed


def _tolerance(golden: pd.DataFrame) -> dict[str, float | pd.Series]:
    """Means within two standard errors, spreads within the 95 % range of a standard deviation, cycles within one."""
    n = golden["members"]
    allowed: dict[str, float | pd.Series] = {"cycles_per_week": 1.0, "members": 0.0}
    for column in COLUMNS:
        spread = golden[f"{column}_sd"].fillna(0.0)
        allowed[column] = STANDARD_ERRORS * spread / np.sqrt(n) + 1e-5
        allowed[f"{column}_sd"] = STANDARD_ERRORS * spread / np.sqrt(2.0 * (n - 1)) + 1e-5
    return allowed


def test_a_fleet_answers_as_it_did_within_the_band_of_other_fleets(tmp_path: Path) -> None:
    golden = pd.read_csv(GOLDEN / "activation.csv")
    found = differences(golden, fleet(tmp_path / "fleet"), FLEET_KEYS, _of_bands(golden))
    assert found == []


def _of_bands(golden: pd.DataFrame) -> dict[str, float | pd.Series]:
    """Half a band, which is about two standard errors, for a figure and both of its ends; what has none, as stated."""
    allowed = dict[str, float | pd.Series](WITHOUT_BAND)
    for low in (column for column in golden if column.endswith("_low")):
        name = low.removesuffix("_low")
        for column in (name, low, f"{name}_high"):
            allowed[column] = (golden[f"{name}_high"] - golden[low]) / 2.0 + 1e-5
    return allowed


def test_the_comparison_sees_every_kind_of_difference() -> None:
    golden = pd.DataFrame({"case": ["a", "b"], "x": [1.0, 2.0], "word": ["p", "q"]})
    within = {"x": 0.1}

    def found(fresh: pd.DataFrame) -> list[str]:
        return differences(golden, fresh, ["case"], within)

    assert found(golden.assign(x=[1.05, 2.0])) == []
    assert found(golden.assign(x=[1.2, 2.0])) == ["x a: 1.2 instead of 1.0"]
    assert found(golden.assign(x=[np.nan, 2.0])) == ["x a: nan instead of 1.0"]
    assert found(golden.assign(word=["p", "r"])) == ["word b: r instead of q"]
    assert found(golden.assign(y=1.0)) == ["column y is new"]
    assert found(golden.drop(columns="x")) == ["column x is missing"]
    assert found(golden.iloc[:1]) == ["row b is missing"]
    assert found(pd.concat([golden, golden.assign(case=["c", "d"])])) == ["row c is new", "row d is new"]
