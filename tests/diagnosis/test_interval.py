"""Claims about figures with intervals: they cover the truth as often as they say; a shrinkage means what it says."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.diagnosis.realities import EFFECTS, belief, effects, estimator, planted, record
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Residual
from waxstudy.diagnosis.estimate.parameter_space import Space
from waxstudy.diagnosis.model.as_built import AsBuilt
from waxstudy.diagnosis.model.nuisance import nuisances
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.partition import FIT, SELECT, SHRINK
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.result import Interval
from waxstudy.diagnosis.select.intervals import CLOCK_S, _Local, _reaching, _reaching_round, parameter_intervals, shrink
from waxstudy.plugin import FloatArray, Prior

pytestmark = pytest.mark.quick

SAMPLES = 2000


def residual(values: FloatArray, blocks: int = 40, part: int = SHRINK) -> Residual:
    n = len(values)
    block = np.arange(n) * blocks // n
    every = np.ones(n, dtype=bool)
    return Residual("flow_L_h", "L/h", values, values, every, block, np.full(n, part), np.arange(n))


def random(seed: int = 1) -> np.random.Generator:
    return np.random.default_rng(seed)


# --- shrinkage -------------------------------------------------------------------------------------------


def test_an_effect_that_leaves_the_noise_alone_shrinks_the_gap_by_one() -> None:
    """Half of the whole is noise; what is left is the floor's size."""
    noise = random(2).normal(0.0, 1.0, SAMPLES)
    floor = float(np.sqrt(np.mean(noise**2)))
    found = shrink(residual(noise + 3.0), residual(noise), floor, random())
    assert found.value == pytest.approx(1.0, abs=1e-9)
    assert found.low <= 1.0 <= found.high
    assert found.high - found.low < 0.1


@given(st.floats(1.5, 20.0))
def test_an_effect_that_changes_nothing_shrinks_nothing(size: float) -> None:
    before = residual(random(3).normal(0.0, size, SAMPLES))
    found = shrink(before, before, 1.0, random())
    assert (found.value, found.low, found.high) == pytest.approx((0.0, 0.0, 0.0))


def test_a_harmful_effect_has_a_negative_shrinkage_and_a_lucky_one_more_than_one() -> None:
    """Nothing is clipped."""
    before, worse, less = (residual(random(4).normal(0.0, size, SAMPLES)) for size in (2.0, 4.0, 0.5))
    assert shrink(before, worse, 1.0, random()).value < -2.0
    assert shrink(before, less, 1.0, random()).value > 1.0


@given(st.floats(0.0, 1.0), st.floats(0.1, 1e3))
@settings(max_examples=30)
def test_a_shrinkage_has_no_unit(share: float, unit: float) -> None:
    before = random(5).normal(0.0, 3.0, SAMPLES)
    plain, scaled = (
        shrink(residual(before * factor), residual(share * before * factor), factor, random()) for factor in (1.0, unit)
    )
    assert scaled.value == pytest.approx(plain.value, rel=1e-6, abs=1e-6)
    assert scaled.low == pytest.approx(plain.low, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("size", [0.0, 0.5, 1.0])
def test_where_no_gap_was_above_the_floor_nothing_is_said_of_shrinking(size: float) -> None:
    before = residual(np.full(SAMPLES, size))
    found = shrink(before, residual(np.full(SAMPLES, 0.2)), 1.0, random())
    assert all(map(math.isnan, (found.value, found.low, found.high)))


@pytest.mark.parametrize(("share", "is_told"), [(0.95, False), (0.6, True)])
def test_of_a_gap_that_may_as_well_be_the_floor_no_share_is_told(share: float, is_told: bool) -> None:
    draw = random(7)
    before = residual(np.repeat(draw.normal(0.0, 1.0, 40), 10))
    found = shrink(before, residual(0.5 * before.error), share * before.gap(), draw)
    assert [math.isfinite(each) for each in (found.low, found.value, found.high)] == [is_told] * 3
    if is_told:
        assert found.low <= found.value <= found.high
        assert found.high - found.low < 1.5


def test_a_shrinkage_is_judged_on_the_days_kept_back_and_on_no_others() -> None:
    before = random(6).normal(0.0, 3.0, SAMPLES)
    part = np.where(np.arange(SAMPLES) < SAMPLES // 2, SELECT, SHRINK)
    block = np.arange(SAMPLES) // 50
    every, at = np.ones(SAMPLES, dtype=bool), np.arange(SAMPLES)
    after = np.where(part == SHRINK, 0.0, 100.0)
    both = [Residual("flow_L_h", "L/h", values, values, every, block, part, at) for values in (before, after)]
    assert shrink(both[0], both[1], 0.0, random()).value == 1.0


def test_a_shrinkage_s_interval_covers_it_as_often_as_it_says() -> None:
    """Blocks of one error each, drawn anew 200 times: 95 %, and no less than 89 % of so few."""
    truth, covered = 1.0 - 0.25, 0
    for seed in range(200):
        draw = random(100 + seed)
        size = draw.normal(0.0, 1.0, 40)
        other = draw.normal(0.0, 0.5, 40)
        found = shrink(residual(np.repeat(size, 10)), residual(np.repeat(other, 10)), 0.0, draw)
        covered += found.low <= truth <= found.high
    assert covered >= 178


# --- parameters ------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_parameter_s_interval_covers_it_as_often_as_it_says() -> None:
    """A valve's full flow in twenty records that differ by their noise; more than two misses are 1 in 13."""
    seen = record("REAL", days=6)
    believed = belief("REAL", seen)
    segment = next(each for each in segments(seen, believed) if each.stages == ("valve",))
    effect, covered, widths = EFFECTS["max-flow"], 0, []
    for seed in range(20):
        made = planted(segment, seen, believed, effects(max_flow={"factor": 0.8}), seed=seed)
        fitter = estimator(segment, made, believed)
        fitted = fitter.fit(effect, fitter.base, (FIT, SELECT))
        assert fitted
        interval = parameter_intervals(fitter, fitted)[effect]["factor"]
        covered += interval.low <= 0.8 <= interval.high
        widths.append(interval.high - interval.low)
    assert covered >= 18
    assert max(widths) < 0.02


@pytest.mark.parametrize("interval_s", [10.0, 60.0])
def test_a_motor_s_times_are_known_no_better_than_its_switches_nor_than_when_it_was_told(interval_s: float) -> None:
    seen = record("IDEAL", days=2, interval_s=interval_s)
    believed = belief("IDEAL", seen)
    segment = next(each for each in segments(seen, believed) if each.stages == ("actuator",))
    fitter, motor = estimator(segment, seen, believed), EFFECTS["wax-motor"]
    times = {"dead_time_s": 120.0, "rise_time_s": 100.0, "hold_time_s": 80.0, "fall_time_s": 140.0, "past": 0.5}
    fitted = fitter.problem.at([(motor, times)], np.zeros(0), fitter.base.convention)
    assert fitted
    for place, name in enumerate(Space(motor).names):
        prior = motor.priors[name]
        if name.endswith("_s") and not prior.is_log:
            open_s = _Local(fitter.problem, fitted)._timing(motor, place) * (prior.high - prior.low)
            assert open_s == pytest.approx(max(CLOCK_S, interval_s / 6.0))


def test_a_mass_is_known_as_well_as_days_tell_it_from_that_of_the_air() -> None:
    """However little a healthy record told of the air's capacity, its whole spread is not added."""
    seen = record("REAL", days=6)
    believed = belief("REAL", seen)
    room = next(each for each in segments(seen, believed) if each.with_room and not each.is_supply)
    of_air = next(each for each in nuisances(believed, seen, room.driven_by) if each.name == "air-capacity")
    effect, made = EFFECTS["thermal-mass"], planted(room, seen, believed, effects(thermal_mass={"factor": 1.5}))
    widths = []
    for sd in (0.01, 1.0):
        as_built = AsBuilt((replace(of_air, sd=sd),), np.zeros(1), np.array([[sd**2]]))
        fitter = Estimator(SegmentProblem(room, made, believed, as_built=as_built))
        fitted = fitter.fit(effect, fitter.base, (FIT, SELECT))
        assert fitted
        interval = parameter_intervals(fitter, fitted)[effect]["factor"]
        assert interval.low <= 1.5 <= interval.high
        widths.append(math.log(interval.high / interval.low))
    assert widths[0] < widths[1] < 1.5 * widths[0]


def test_an_effect_of_a_model_without_parameters_has_no_intervals() -> None:
    seen = record("REAL", days=6)
    believed = belief("REAL", seen)
    segment = next(each for each in segments(seen, believed) if each.stages == ("valve",))
    fitter = estimator(segment, seen, believed)
    assert parameter_intervals(fitter, fitter.base) == {}


@pytest.mark.parametrize(("is_log", "low", "high"), [(True, 0.95, 8.4), (False, 0.9, 8.1)])
def test_an_interval_reaches_around_what_other_readings_give_and_no_farther(
    is_log: bool, low: float, high: float
) -> None:
    prior = Prior(0.1, 10.0, is_log=is_log, noticeable=1.1)
    own = Interval(2.0, 1.9, 2.1)
    assert _reaching(own, [], prior) == own
    reached = _reaching(own, [1.0, 3.0, 8.0, 3.0], prior)
    assert reached == _reaching(own, [8.0, 1.0], prior)
    assert (reached.value, reached.low, reached.high) == pytest.approx((2.0, low, high))
    assert _reaching(own, [9.9], prior).high == 10.0


@pytest.mark.parametrize(
    ("own", "other_h", "reached"),
    [
        ((23.5, 23.2, 23.8), 0.2, (23.2, 0.5)),
        ((23.9, 22.9, 0.9), 0.1, (22.9, 1.1)),
        ((0.2, 23.9, 0.5), 23.5, (23.2, 0.5)),
        ((12.0, 11.0, 13.0), 12.5, (11.0, 13.5)),
        ((6.0, 1.0, 11.0), 18.0, (13.0, 11.0)),
        ((6.0, 18.5, 17.5), 7.0, (0.0, 24.0)),
    ],
)
def test_an_interval_of_an_hour_reaches_over_midnight(
    own: tuple[float, float, float], other_h: float, reached: tuple[float, float]
) -> None:
    found = _reaching_round(Interval(*own), [other_h])
    assert found.value == own[0]
    assert (found.low, found.high) == pytest.approx(reached)
    same = _reaching_round(Interval(*own), [])
    assert (same.value, same.low, same.high) == pytest.approx(own)
