"""Hours between which an effect of a room acts: looked for over the whole day, and fitted to minutes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.diagnosis.realities import EFFECTS, dataset, effects, planted, rows
from tests.diagnosis.test_calibration import DAYS, of_room
from waxstudy.diagnosis.diagnose import QUICK, record_of
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.parameter_space import Space
from waxstudy.diagnosis.estimate.solver import MOST_SD, LeastSquares
from waxstudy.diagnosis.model.edits import Values
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.day import BINS, parts_of_day, promising
from waxstudy.diagnosis.select.looks import acts_all_day
from waxstudy.diagnosis.select.superposed import Superposed
from waxstudy.diagnosis.select.timed import timed
from waxstudy.plugin import Belief, Effect, FloatArray
from waxstudy.plugin.hours import DAY_H

SAMPLES, NUISANCES = 200, 3
TAKES, BOTH_WAYS = (0.0, 5.0), (-5.0, 5.0)  # strengths
edges = st.integers(0, BINS - 1)


def a_day(seed: int = 1) -> tuple[FloatArray, FloatArray]:
    """Return what an effect does in each part of the day, and what nuisances take, as a basis."""
    random = np.random.default_rng(seed)
    return random.normal(size=(SAMPLES, BINS)), np.linalg.qr(random.normal(size=(SAMPLES, NUISANCES)))[0]


def free(values: FloatArray, basis: FloatArray) -> FloatArray:
    return np.asarray(values - basis @ (basis.T @ values))


def test_the_parts_of_a_day_follow_each_other_round_the_clock() -> None:
    parts = parts_of_day()
    assert len(parts) == BINS
    assert all(end == start for (_, end), (start, _) in zip(parts, parts[1:] + parts[:1], strict=True))


@given(edges, st.integers(1, BINS - 1), st.floats(0.1, 5.0))
@settings(deadline=None)
def test_the_hours_of_what_acted_are_the_most_promising_over_midnight_too(first: int, long: int, strong: float) -> None:
    changes, basis = a_day()
    acted = free(strong * changes[:, np.arange(first, first + long) % BINS].sum(axis=1), basis)
    best = promising(-acted, changes, basis, TAKES, 3)[0]
    assert best.from_h == pytest.approx(first * DAY_H / BINS)
    assert best.to_h == pytest.approx((first + long) % BINS * DAY_H / BINS)
    assert best.gain == pytest.approx(0.5 * acted @ acted)  # all of it would go


def test_what_gives_heat_is_found_only_of_an_effect_that_may() -> None:
    changes, basis = a_day()
    gave = free(changes[:, 10:14].sum(axis=1), basis)
    heater, window = (promising(gave, changes, basis, may, 1)[0] for may in (BOTH_WAYS, TAKES))
    assert (heater.from_h, heater.to_h) == (5.0, 7.0)
    assert window.gain < 0.5 * heater.gain


def test_no_effect_is_taken_to_be_stronger_than_it_can_be() -> None:
    changes, basis = a_day()
    acted = free(3.0 * changes[:, 10:12].sum(axis=1), basis)
    able, weak = (promising(-acted, changes, basis, (0.0, most), 1)[0] for most in (5.0, 1.0))
    assert (able.from_h, able.to_h) == (5.0, 6.0)
    assert weak.gain < able.gain


def test_spans_worth_a_closer_look_are_not_all_the_same_one() -> None:
    changes, basis = a_day()
    changes = np.cumsum(changes, axis=1)  # neighbours do much the same
    acted = free(changes[:, 20:30].sum(axis=1), basis)
    found = promising(-acted, changes, basis, TAKES, 3)
    assert len(found) == 3
    assert all(not one.is_near(other) for one in found for other in found if one is not other)
    assert found[0].gain >= found[1].gain >= found[2].gain


class Ventilation(EFFECTS["window-opening"]):  # type: ignore[misc]
    """An effect of somebody else's, with hours, no starts, and every parameter neutral."""

    name = "ventilation"

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        return {"flow_L_s": 0.0, "from_h": 7.0, "to_h": 8.0}

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return ()


@cache
def window_fit(effect: type[Effect], flow_L_s: float, from_h: float, to_h: float, thorough: float = 1.0) -> Values:
    """What is fitted of a window in a room that is known from a week."""
    calibration, believed = of_room()
    record = record_of(dataset(rows("REAL", DAYS, interval_s=300.0), "REAL"))
    there = calibration.as_built.believed(believed)
    segment = next(each for each in segments(record, there) if each.with_room and not each.is_supply)
    for _ in range(4):  # what flows depends on the air, which it cools
        window = effects(window_opening={"flow_L_s": flow_L_s, "from_h": from_h, "to_h": to_h})
        record = planted(segment, record, there, window)
    problem = SegmentProblem(segment, record, believed, as_built=calibration.as_built, parts=np.full(len(record), FIT))
    estimator = Estimator(problem, thorough, keeps=True)
    (fitted,) = Superposed(estimator, estimator.base).fits([effect], estimator.base, lambda name: None)
    ((_, values),) = fitted.effects
    return values


@pytest.mark.slow
@pytest.mark.parametrize("effect", [EFFECTS["window-opening"], Ventilation])
@pytest.mark.parametrize(("flow_L_s", "from_h", "to_h"), [(1.5, 4.6, 6.7), (60.0, 4.6, 6.7), (30.0, 22.2, 23.97)])
def test_a_window_is_found_to_minutes_however_far_the_air_falls(
    effect: type[Effect], flow_L_s: float, from_h: float, to_h: float
) -> None:
    found = window_fit(effect, flow_L_s, from_h, to_h)
    for name, true in (("from_h", from_h), ("to_h", to_h)):
        assert abs((found[name] - true + 12.0) % 24.0 - 12.0) < 0.1
    assert found["flow_L_s"] == pytest.approx(flow_L_s, rel=0.25)


@pytest.mark.slow
def test_a_quick_look_finds_a_window_as_a_thorough_one_does() -> None:
    quick, thorough = (window_fit(EFFECTS["window-opening"], 60.0, 4.6, 6.7, share) for share in (QUICK, 1.0))
    assert quick == pytest.approx(thorough, rel=0.05)


@pytest.mark.parametrize(
    ("from_h", "to_h", "is_all_day"), [(9.2, 9.1, True), (0.0, 23.9, True), (9.0, 8.0, False), (7.0, 8.0, False)]
)
def test_a_window_that_rests_for_minutes_is_open_all_day(from_h: float, to_h: float, is_all_day: bool) -> None:
    values = {"flow_L_s": 1.0, "from_h": from_h, "to_h": to_h}
    assert acts_all_day(EFFECTS["window-opening"], values) is is_all_day
    assert not acts_all_day(EFFECTS["setpoint-offset"], values)


@given(st.floats(-1.0, 2.0))
def test_hours_go_on_round_the_clock_and_midnight_may_be_either_end(at: float) -> None:
    space = Space(EFFECTS["window-opening"])
    hour = space.values(np.array([0.5, at, 0.5]))["from_h"]
    assert hour == pytest.approx(24.0 * at if 0.0 <= at <= 1.0 else 24.0 * at % 24.0)


class Departing:
    """As much of a problem as a step asks for: departures alone."""

    sd = np.ones(NUISANCES)


@given(st.integers(0, 200))
@settings(deadline=None, max_examples=60)
def test_no_step_within_the_bounds_is_better_than_the_one_taken(seed: int) -> None:
    random = np.random.default_rng(seed)
    slopes, missed = random.normal(size=(20, NUISANCES)), 30.0 * random.normal(size=20)
    slopes[:, 1] = slopes[:, 0] + 0.05 * slopes[:, 1]  # two that do nearly the same, as films of a room do
    x = random.uniform(-MOST_SD, MOST_SD, NUISANCES)
    solver = LeastSquares(Departing(), (), None, ())  # type: ignore[arg-type]
    step = solver.step(slopes, missed, 0.0, x)
    assert np.all(np.abs(x + step) <= MOST_SD + 1e-9)
    others = random.uniform(-MOST_SD, MOST_SD, (2000, NUISANCES)) - x
    near = np.clip(x + step + 0.1 * random.normal(size=(2000, NUISANCES)), -MOST_SD, MOST_SD) - x
    left = np.linalg.norm(missed + np.vstack((others, near)) @ slopes.T, axis=1)
    assert np.linalg.norm(missed + slopes @ step) <= left.min() + 1e-6


def test_an_effect_with_hours_acts_between_them_unless_it_says_otherwise() -> None:
    window, setpoint, leak = (EFFECTS[name] for name in ("window-opening", "setpoint-offset", "infiltration"))
    hours = {"from_h": 22.0, "to_h": 5.0}
    assert window.hours(window.Parameters(flow_L_s=5.0, **hours)) == (22.0, 5.0)
    assert setpoint.hours(setpoint.Parameters(offset_K=1.0, **hours)) == (22.0, 5.0)
    assert setpoint.hours(setpoint.Parameters(offset_K=1.0)) is None
    assert leak.hours(leak.Parameters(factor=2.0)) is None
    heat = timed(EFFECTS["extra-heat"])
    assert heat.hours(heat.Parameters(heat_W=10.0, **hours)) == (22.0, 5.0)
