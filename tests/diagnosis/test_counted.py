"""Claims about a record whose flow was counted in pulses: it is judged by means between them, and hides no cause."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tests.dataset.test_pulses import counted
from tests.diagnosis.realities import belief, dataset, effects, rows
from waxstudy.believing.shown import full_flow_L_h
from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.diagnose import diagnose, record_of
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.result import Diagnosis
from waxstudy.diagnosis.select.meter import coarser_steps

DAYS = 7


def with_counted(data: pd.DataFrame, pulse_L: float) -> pd.DataFrame:
    return data.assign(flow_L_h=counted(data["flow_L_h"].clip(lower=0.0).to_numpy(), pulse_L))


def test_a_counted_flow_is_judged_where_a_span_ends_and_its_warning_says_so() -> None:
    data = rows("REAL", days=4)
    seen = record_of(dataset(with_counted(data, 10.0), "REAL"))
    assert seen.pulses
    assert record_of(dataset(data, "REAL")).pulses is None
    true = record_of(dataset(data, "REAL")).filled("flow_L_h")
    assert seen.filled("flow_L_h").mean() == pytest.approx(true.mean(), rel=0.02)
    assert seen.usual_flow_L_h == pytest.approx(np.median(true[true > 0.8 * true.max()]), rel=0.01)
    (said,) = (each for each in diagnose(chain(data), quick=True).warnings if "pulses" in each)
    assert "flow_L_h was counted in pulses of 10 L" in said


def chain(data: pd.DataFrame, pulse_L: float = 10.0) -> Dataset:
    """Motor and valve of a record whose flow was counted."""
    seen = with_counted(data, pulse_L)[["time", "heating_signal", "displacement", "flow_L_h"]]
    return replace(dataset(seen, "REAL"), setpoint_C=None, room=None)


@pytest.mark.parametrize("pulse_L", [3.0, 10.0])
def test_a_healthy_valve_whose_flow_is_counted_shows_nothing(pulse_L: float) -> None:
    diagnosis = diagnose(chain(rows("REAL", days=DAYS), pulse_L), quick=True)
    assert diagnosis.verdict == "none"
    assert {gap.stage for gap in diagnosis.stages} >= {"actuator", "valve"}


@pytest.mark.parametrize("pulse_L", [3.0, 10.0])
def test_a_valve_that_leaks_is_found_by_counts(pulse_L: float) -> None:
    leaks = rows("REAL", days=DAYS, effects=effects(let_by={"fraction": 0.05}))
    (found,) = diagnose(chain(leaks, pulse_L), quick=True).effects
    assert found.group == ["let-by", "stuck-open"]
    assert found.parameters["fraction"].value == pytest.approx(0.05, rel=0.03)


def test_a_flow_that_never_stops_is_counted_though_no_valve_opens() -> None:
    stuck = rows("REAL", days=4, effects=effects(stuck_open={"opening": 0.3}))
    seen = record_of(chain(stuck))
    assert seen.pulses
    assert seen.usual_flow_L_h == pytest.approx(stuck["flow_L_h"].median(), rel=0.02)


def test_the_full_flow_of_a_room_is_read_between_pulses() -> None:
    data = rows("REAL", days=4)
    fine, counts = (full_flow_L_h(dataset(each, "REAL")) for each in (data, with_counted(data, 10.0)))
    assert fine
    assert counts == pytest.approx(fine, rel=0.03)


def rounded(data: pd.DataFrame, step_L_h: float) -> pd.DataFrame:
    return data.assign(flow_L_h=(data["flow_L_h"] / step_L_h).round() * step_L_h)


def beside(pulse_L: float, before_L: float = 0.0, step_L_h: float = 0.1) -> Diagnosis:
    """What is said of motor and valve that nothing is wrong with, where a flow is counted, and maybe was before."""
    columns = ["time", "heating_signal", "displacement", "flow_L_h"]
    healthy, later = (rows("REAL", days=5, seed=seed)[columns] for seed in (1, 2))
    before_it = pd.DatetimeIndex(healthy["time"]) - pd.Timedelta(days=14)
    earlier = healthy.assign(time=before_it.astype(str))
    pairs = (earlier, before_L), (later, pulse_L)
    told = [with_counted(data, each_L) if each_L else data for data, each_L in pairs]
    made = [dataset(each, "REAL") for each in (told[0], rounded(told[1], step_L_h))]
    before, now = (replace(each, setpoint_C=None, room=None) for each in made)
    return diagnose(now, baseline=before, quick=True)


@pytest.mark.parametrize(
    ("pulse_L", "before_L", "then"), [(3.0, 0.0, "steps of 0.1 L/h"), (10.0, 1.5, "pulses of 1.5 L")]
)
def test_a_meter_that_has_come_to_count_is_something_unknown_at_the_valve(
    pulse_L: float, before_L: float, then: str
) -> None:
    diagnosis = beside(pulse_L, before_L)
    (left,) = (each for each in diagnosis.unexplained if each.is_finding)
    assert (diagnosis.verdict, left.stage, left.channel) == ("unknown", "valve", "flow_L_h")
    assert left.probability > 0.8
    said = f"flow_L_h comes in pulses of {pulse_L:g} L, in the baseline {then}: its meter or logger is another one"
    assert said in diagnosis.warnings


@pytest.mark.parametrize(("pulse_L", "before_L"), [(3.0, 3.0), (0.0, 3.0)])
def test_a_meter_that_counts_as_it_did_or_no_longer_is_no_finding(pulse_L: float, before_L: float) -> None:
    diagnosis = beside(pulse_L, before_L)
    assert diagnosis.verdict == "none"
    assert not any("another one" in each for each in diagnosis.warnings)


def test_a_meter_that_has_come_to_round_is_something_unknown_at_the_valve() -> None:
    diagnosis = beside(0.0, step_L_h=20.0)
    assert [each.stage for each in diagnosis.unexplained if each.is_finding] == ["valve"]
    said = "flow_L_h comes in steps of 20 L/h, in the baseline steps of 0.1 L/h: its meter or logger is another one"
    assert said in diagnosis.warnings


def seen(flow_L_h: float, pulse_L: float, interval_s: float) -> Record:
    """A record of a meter that counts pulses exactly, with a logger's noise on top."""
    on = np.tile(np.repeat([1.0, 0.0], round(20 * 60 / interval_s)), 60)
    flow = counted(flow_L_h * on, pulse_L, interval_s)
    flow += np.random.default_rng(1).normal(0.0, 0.3, len(on)) * (flow > 0.0)
    time = pd.date_range("2023-01-02", periods=len(on), freq=f"{interval_s:g}s").astype(str)
    columns = {"time": time, "heating_signal": on, "displacement": on, "flow_L_h": flow}
    return record_of(replace(dataset(pd.DataFrame(columns), "REAL"), setpoint_C=None, room=None))


@pytest.mark.parametrize(
    ("now", "before"),
    [((100.0, 1.0, 60.0), (240.0, 1.0, 60.0)), ((100.0, 1.0, 60.0), (100.0, 1.0, 300.0))],
    ids=["less flow", "other samples"],
)
def test_a_meter_that_counted_so_all_the_time_is_no_other_one(
    now: tuple[float, float, float], before: tuple[float, float, float]
) -> None:
    record, earlier = seen(*now), seen(*before)
    (valve,) = (each for each in segments(record, belief("REAL", record)) if "flow_L_h" in each.judged)
    healthy: Any = SimpleNamespace(is_noise=False, problem=SimpleNamespace(record=earlier))
    assert coarser_steps(valve, record, healthy) == 0.0
    other: Any = SimpleNamespace(is_noise=False, problem=SimpleNamespace(record=seen(113.0, 0.01, 60.0)))
    assert coarser_steps(valve, record, other) > 3.0
