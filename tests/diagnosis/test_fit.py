"""Claims about fitting: what was put into a record is found again, and nothing where nothing was put."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.diagnosis.realities import (
    EFFECTS,
    PERFECT,
    belief,
    effects,
    estimator,
    one_more,
    planted,
    record,
    with_effects,
)
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.parameter_space import Space, descend
from waxstudy.diagnosis.model.nuisance import FLOOR, START, of_record
from waxstudy.diagnosis.model.room_response import OF_AIR_AND_FLOOR
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.intervals import _form_share, parameter_intervals
from waxstudy.plugin import Belief, Prior

OF_START = (START, FLOOR)
# what is believed and what is put in: of a chain's first stages into its closed loop, else into its segment
IN_LOOP: Mapping[str, tuple[str, Mapping[str, float]]] = {
    "sensor-delay": ("IDEAL", {"delay_s": 420.0}),
    "sensor-bias": ("IDEAL", {"bias_K": 0.5}),
    "dead-band": ("IDEAL", {"dead_band_K": 0.9}),
    "pwm-period": ("PWM", {"period_s": 1800.0}),
}
IN_LINK: Mapping[str, tuple[str, Mapping[str, float]]] = {
    "slow-actuator": ("REAL", {"factor": 1.5}),
    "limited-travel": ("REAL", {"opening": 0.7}),
    "let-by": ("REAL", {"fraction": 0.02}),
    "stuck-open": ("REAL", {"opening": 0.3}),
    "max-flow": ("REAL", {"factor": 0.8}),
    "supply-offset": ("REAL", {"offset_K": -2.0}),
    "thermal-mass": ("REAL", {"factor": 2.0}),
}
PLANTED = {**IN_LOOP, **IN_LINK}
EACH = pytest.mark.parametrize("name", PLANTED)


@cache
def ready(case: str) -> tuple[Record, Belief, tuple[Segment, ...]]:
    seen = record(case, days=6)
    believed = belief(case, seen)
    return seen, believed, tuple(segments(seen, believed))


def segment_of(name: str, cut: Sequence[Segment]) -> Segment:
    return next(each for each in cut if EFFECTS[name].stage in each.stages)


@cache
def found(name: str) -> tuple[Estimator[SegmentProblem], Hypothesis]:
    """An effect put into the record of what is believed, and fitted again."""
    case, values = PLANTED[name]
    true = ((name, tuple(values.items())),)
    seen, believed, cut = ready(case)
    segment = segment_of(name, cut)
    seen = record(case, days=6, effects=true) if name in IN_LOOP else planted(segment, seen, believed, true)
    fitter = estimator(segment, seen, belief(case, seen) if name in IN_LOOP else believed)
    fitted = one_more(fitter, EFFECTS[name])
    return fitter, fitted


@EACH
def test_an_effect_that_was_put_in_is_found_within_its_interval(name: str) -> None:
    fitter, fitted = found(name)
    truth = PLANTED[name][1]
    ((effect, values),) = fitted.effects
    for parameter, interval in parameter_intervals(fitter, fitted)[effect].items():
        assert interval.value == values[parameter]
        assert interval.low <= interval.value <= interval.high
        slack = 0.02 * abs(truth[parameter])
        assert interval.low - slack <= truth[parameter] <= interval.high + slack
        assert interval.value == pytest.approx(truth[parameter], rel=0.2)


@EACH
def test_an_effect_that_was_put_in_takes_most_of_the_loss_away(name: str) -> None:
    fitter, fitted = found(name)
    assert fitted.loss(FIT) < 0.5 * fitter.base.loss(FIT)


@pytest.mark.parametrize(
    ("dead_s", "rise_s", "hold_s", "fall_s"),
    [(500.0, 400.0, 330.0, 480.0), (400.0, 400.0, 300.0, 400.0)],
)
def test_a_slow_stroke_is_not_taken_for_a_late_and_sudden_one(
    dead_s: float, rise_s: float, hold_s: float, fall_s: float
) -> None:
    """From a stroke that is shorter than a sample no slope leads to a longer one."""
    times_s = {"dead_time_s": dead_s, "rise_time_s": rise_s, "hold_time_s": hold_s, "fall_time_s": fall_s}
    seen, believed, cut = ready("REAL")
    segment = segment_of("constant-times", cut)
    slow = planted(segment, seen, believed, effects(constant_times=times_s))
    fitter, motor = estimator(segment, slow, believed), EFFECTS["constant-times"]
    fitted = one_more(fitter, motor)
    true = fitter.problem.at([(motor, times_s)], fitter.base.departures, fitter.base.convention)
    assert true
    assert fitted.loss(FIT) < 1.05 * true.loss(FIT)


@EACH
def test_what_is_found_lies_within_the_bounds_it_was_looked_for_in(name: str) -> None:
    ((effect, values),) = found(name)[1].effects
    for parameter, prior in effect.priors.items():
        assert prior.low <= values[parameter] <= prior.high


def of_room(days: int, **true: Mapping[str, float]) -> tuple[Estimator[SegmentProblem], Hypothesis]:
    """A room's effect put into its segment of a short record, and the best fit of its name."""
    seen = record("REAL", days=days)
    believed = belief("REAL", seen)
    segment = segment_of(next(iter(true)).replace("_", "-"), segments(seen, believed))
    put_in = effects(**true)
    fitter = estimator(segment, planted(segment, seen, believed, put_in), believed)
    fitted = one_more(fitter, EFFECTS[put_in[0][0]])
    return fitter, fitted


@pytest.mark.parametrize(("flow_L_s", "from_h", "to_h"), [(3.0, 7.0, 8.0), (6.0, 22.2, 23.0), (2.0, 10.5, 15.5)])
def test_a_small_or_short_window_is_found_at_whatever_hour(flow_L_s: float, from_h: float, to_h: float) -> None:
    _, fitted = of_room(4, window_opening={"flow_L_s": flow_L_s, "from_h": from_h, "to_h": to_h})
    ((_, found),) = fitted.effects
    assert found["from_h"] == pytest.approx(from_h, abs=0.3)
    assert found["to_h"] == pytest.approx(to_h, abs=0.3)
    assert found["flow_L_s"] == pytest.approx(flow_L_s, rel=0.2)


def test_a_room_that_was_colder_than_its_first_day_is_no_other_room() -> None:
    seen = record("REAL", days=3)
    believed = belief("REAL", seen)
    assert believed.inputs
    colder = replace(believed, inputs=replace(believed.inputs, start_K=-3.0, start_floor_K=-1.0))
    segment = segment_of("solar-factor", segments(seen, believed))
    fitter = estimator(segment, planted(segment, seen, colder), believed)
    names = [unknown.name for unknown in fitter.problem.nuisances]
    start_K, floor_K = (fitter.base.departures[names.index(name)] for name in OF_START)
    assert start_K < -2.0
    assert start_K + floor_K == pytest.approx(-4.0, abs=0.5)
    others = [
        abs(z)
        for name, z in zip(names, fitter.base.departures / fitter.problem.sd, strict=True)
        if name not in OF_START
    ]
    assert max(others) < 1.0


def test_a_room_that_leaves_little_shows_that_its_form_is_good_and_one_that_has_to_depart_does_not() -> None:
    fitter, fitted = of_room(6, floor_cover={"resistance_m2K_W": 0.05})
    assert 0.0 < _form_share(fitter, fitted) < 0.5
    assert _form_share(fitter, fitter.base) == 1.0
    strained = replace(fitted, departures=2.0 * fitter.problem.sd)
    assert _form_share(fitter, strained) == 1.0


@pytest.mark.parametrize("true", [{}, {"infiltration": {"factor": 3.0}}, {"thermal_mass": {"factor": 1.5}}])
def test_a_room_in_long_steps_is_refined_to_what_short_ones_give(true: Mapping[str, Mapping[str, float]]) -> None:
    seen = record("REAL", days=4)
    believed = belief("REAL", seen)
    segment = segment_of("thermal-mass", segments(seen, believed))
    convention, edited = segment.conventions[0], with_effects(believed, effects(**true))
    fine, coarse = (segment.predict(seen, edited, convention, is_fine=way) for way in (True, False))
    refined = estimator(segment, seen, believed).problem.predicted(edited, convention)
    for channel in OF_AIR_AND_FLOOR:
        off_K = [np.nanstd((each[channel] - fine[channel])[24:]) for each in (refined, coarse)]
        assert off_K[0] <= 0.25 * off_K[1], channel
    whole = estimator(segment, seen, believed).problem.predicted.fine(edited, convention)
    assert all(np.array_equal(whole[channel], fine[channel], equal_nan=True) for channel in OF_AIR_AND_FLOOR)


@pytest.mark.parametrize("case", ["REAL", "PWM"])
@pytest.mark.parametrize(("interval_s", "most_K"), [(60.0, 0.002), (300.0, 0.004), (900.0, 0.015)])
def test_a_room_that_is_as_believed_is_missed_by_thousandths_whatever_the_samples(
    case: str, interval_s: float, most_K: float
) -> None:
    seen = record(case, interval_s=interval_s, **PERFECT)
    believed = belief(case, seen)
    segment = segment_of("thermal-mass", segments(seen, believed))
    began = of_record(believed, seen, segment.driven_by)
    for residual in estimator(segment, seen, believed, unknowns=began).base.residuals:
        if residual.channel in OF_AIR_AND_FLOOR:
            assert residual.gap() < most_K, residual.channel


def test_a_chain_s_noise_is_its_instruments_and_never_narrowed() -> None:
    fitter, fitted = found("max-flow")
    assert _form_share(fitter, fitted) == 1.0


# sensors and controllers are judged by switches that noise moves: their neutral is checked by what they gain
@pytest.mark.parametrize("name", ["slow-actuator", "limited-travel", "let-by", "max-flow", "supply-offset"])
def test_where_nothing_was_put_in_neutral_is_found(name: str) -> None:
    seen, believed, cut = ready("REAL")
    effect = EFFECTS[name]
    segment = segment_of(name, cut)
    fitter = estimator(segment, planted(segment, seen, believed), believed)
    fitted = one_more(fitter, effect)
    ((_, values),) = fitted.effects
    neutral = effect.neutral(believed)
    assert neutral
    for parameter, prior in effect.priors.items():
        step = prior.noticeable - 1.0 if prior.is_log else prior.noticeable
        assert values[parameter] == pytest.approx(neutral[parameter], abs=2.0 * step)


@pytest.mark.parametrize("name", ["let-by", "supply-offset"])
def test_the_same_record_gives_the_same_fit(name: str) -> None:
    fitter, fitted = found(name)
    again = estimator(fitter.problem.segment, fitter.problem.record, fitter.problem.belief)
    ((effect, values),) = fitted.effects
    other = one_more(again, effect)
    assert dict(other.effects)[effect] == values
    assert np.array_equal(other.departures, fitted.departures)


def test_where_a_parameter_may_move_and_nothing_changes_its_interval_says_so() -> None:
    """Pulses of a record are in steps: only what lies between two of them tells a shortest pulse."""
    seen = record("PWM", days=6, effects=effects(min_pulse={"min_pulse_s": 200.0}))
    segment = segment_of("min-pulse", segments(seen, belief("PWM", seen)))
    fitter = estimator(segment, seen, belief("PWM", seen))
    fitted = one_more(fitter, EFFECTS["min-pulse"])
    interval = parameter_intervals(fitter, fitted)[EFFECTS["min-pulse"]]["min_pulse_s"]
    assert interval.low < interval.value < interval.high
    assert interval.low <= 200.0 <= interval.high
    same = fitter.problem.at([(EFFECTS["min-pulse"], {"min_pulse_s": 200.0})], fitted.departures, fitted.convention)
    assert same
    assert same.loss(FIT) == fitted.loss(FIT)


def test_a_fit_does_not_end_in_a_notch_of_a_jagged_loss() -> None:
    """What moves single switches has many: the truth must be found, or another name would fit better."""
    seen, believed, cut = ready("REAL")
    true = effects(slow_actuator={"factor": 1.6})
    segment = segment_of("slow-actuator", cut)
    fitter = estimator(segment, planted(segment, seen, believed, true), believed)
    fitted = one_more(fitter, EFFECTS["slow-actuator"])
    at_truth = fitter.problem.at(
        [(EFFECTS["slow-actuator"], {"factor": 1.6})], fitter.base.departures, fitter.base.convention
    )
    assert at_truth
    assert fitted.loss(FIT) < at_truth.loss(FIT) + 9.0


def test_an_effect_that_cannot_apply_is_not_fitted() -> None:
    seen, believed, cut = ready("IDEAL")
    effect = EFFECTS["slow-actuator"]
    assert effect.hindrance(believed)
    segment = next(each for each in cut if each.stages == ("actuator",))
    fitter = estimator(segment, seen, believed)
    assert fitter.fit(effect, fitter.base) is None


def test_a_second_effect_is_fitted_together_with_the_first() -> None:
    seen, believed, cut = ready("REAL")
    truth = effects(let_by={"fraction": 0.03}, max_flow={"factor": 0.8})
    segment = next(each for each in cut if each.stages == ("valve",))
    fitter = estimator(segment, planted(segment, seen, believed, truth), believed)
    first = one_more(fitter, EFFECTS["max-flow"])
    both = one_more(fitter, EFFECTS["let-by"], first)
    values = {effect.name: dict(each) for effect, each in both.effects}
    assert values["max-flow"]["factor"] == pytest.approx(0.8, rel=0.02)
    assert values["let-by"]["fraction"] == pytest.approx(0.03, rel=0.1)


def test_a_room_s_departures_take_up_what_its_priors_allow() -> None:
    """A standard deviation of each is fitted away."""
    seen, believed, cut = ready("REAL")
    segment = next(each for each in cut if each.with_room)
    plain = estimator(segment, seen, believed)
    moved = planted(segment, seen, plain.problem.edited((), plain.problem.sd))
    fitter = estimator(segment, moved, believed)
    believed_only = fitter.problem.at((), np.zeros(len(fitter.problem.sd)), fitter.base.convention)
    assert believed_only
    before, after = (
        next(e for e in m.residuals if e.channel == "air_temperature_C") for m in (believed_only, fitter.base)
    )
    assert before.gap() > 0.1
    assert after.gap() < 0.05
    assert (np.abs(fitter.base.departures) < 3.0 * fitter.problem.sd).all()


# --- the cube --------------------------------------------------------------------------------------------


@given(st.sampled_from(sorted(EFFECTS)), st.lists(st.floats(0.0, 1.0), min_size=12, max_size=12))
def test_a_place_in_the_cube_and_values_are_each_other_s_inverse(name: str, places: list[float]) -> None:
    space = Space(EFFECTS[name])
    x = np.array(places[: len(space.names)])
    assert space.inside(space.values(x)) == pytest.approx(x, abs=1e-9)


@given(st.sampled_from(sorted(EFFECTS)), st.floats(-5.0, 5.0))
def test_whatever_the_place_the_values_are_within_their_bounds(name: str, at: float) -> None:
    space = Space(EFFECTS[name])
    for parameter, value in space.values(np.full(len(space.names), at)).items():
        prior: Prior = EFFECTS[name].priors[parameter]
        slack = 1e-9 * abs(value)
        assert prior.low - slack <= value <= prior.high + slack


@pytest.mark.parametrize("case", ["IDEAL", "REAL", "PWM", "PI"])
def test_fits_start_within_the_bounds(case: str) -> None:
    _, believed, _ = ready(case)
    for effect in EFFECTS.values():
        if not effect.hindrance(believed):
            for values in effect.starts(believed):
                x = Space(effect).inside(values)
                assert ((x >= 0.0) & (x <= 1.0)).all(), (effect.name, values)


@pytest.mark.parametrize("name", sorted(EFFECTS))
def test_a_first_look_spreads_its_points_over_the_whole_range(name: str) -> None:
    space = Space(EFFECTS[name])
    points = np.array([space.inside(each) for each in space.points(1.0)])
    assert len(np.unique(points, axis=0)) == len(points) >= 17
    assert (points.max(axis=0) > 0.9).all()
    assert (points.min(axis=0) < 0.1).all()


@pytest.mark.parametrize("start", [0.46, 0.5, 0.54])
def test_where_a_range_fits_alike_its_middle_is_taken(start: float) -> None:
    """A shortest pulse between two that were recorded says nothing: its ends would be the worst guess."""
    found = descend(lambda x: float(not 0.45 <= x[0] <= 0.55), np.array([start]), 30)
    assert found[0] == pytest.approx(0.5, abs=0.02)
