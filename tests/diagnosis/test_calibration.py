"""Claims about calibration on a healthy record: what was put in is found, and what is left is described."""

from __future__ import annotations

import doctest
from dataclasses import replace
from functools import cache
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.diagnosis.realities import EFFECTS, belief, dataset, effects, plain, planted, record, rows, with_effects
from waxstudy.dataset.read import Dataset
from waxstudy.dataset.stand_ins import GAINS
from waxstudy.diagnosis.calibration import told
from waxstudy.diagnosis.calibration.calibrate import (
    Calibration,
    _as_good,
    _covariance,
    _fitted,
    _gain,
    _most_gained,
    _still_best,
    calibrate,
    lasting_unknowns,
)
from waxstudy.diagnosis.calibration.healthy import together
from waxstudy.diagnosis.calibration.told import calibrated, doubts, fits
from waxstudy.diagnosis.consequence.times import when
from waxstudy.diagnosis.diagnose import record_of
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.model.as_built import Knob, knobs
from waxstudy.diagnosis.model.conventions import AFTER, BEFORE, PLAIN, RAW, Convention
from waxstudy.diagnosis.model.discrepancy import Discrepancy
from waxstudy.diagnosis.model.nuisance import nuisances
from waxstudy.diagnosis.model.room_response import built
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.result import Calibrated
from waxstudy.diagnosis.select.changed import Choice, joint
from waxstudy.plugin import Belief, FloatArray

DAYS = 7
PUT_IN = effects(
    floor_cover={"resistance_m2K_W": 0.02}, solar_factor={"factor": 0.85}, gain_shift={"shift_h": 0.0, "factor": 1.3}
)
CHAIN = {"valve": effects(max_flow={"factor": 0.9}), "actuator": effects(slow_actuator={"factor": 1.2})}


@pytest.mark.parametrize(("tolerance", "wider"), [(1.0, 2.5), (4.0, 4.0)])
def test_a_room_that_was_guessed_may_differ_as_far_as_its_tolerance_says(tolerance: float, wider: float) -> None:
    record = record_of(dataset(rows("REAL", 3, interval_s=300.0), "REAL"))
    believed = belief("REAL", record)
    (room,) = [each for each in segments(record, believed) if each.with_room and not each.is_supply]
    found = {each.name: each.sd for each in lasting_unknowns(room, record, believed, (), tolerance)}
    drawn = {each.name: each.sd for each in nuisances(believed, record, room.driven_by)}
    assert {name: sd / drawn[name] for name, sd in found.items()} == pytest.approx(dict.fromkeys(found, wider))


# --- what was put in ---------------------------------------------------------------------------------


def documents(record: Record, made: Dataset) -> Belief:
    return made.believed(record.inputs)


@cache
def of_room() -> tuple[Calibration, Belief]:
    """A week of a room that was built otherwise than its documents say, seen with noise."""
    made = dataset(rows("REAL", DAYS, interval_s=300.0), "REAL")
    record = record_of(made)
    believed = documents(record, made)
    segment = next(each for each in segments(record, believed) if each.with_room and not each.is_supply)
    keep = {*segment.judged, segment.driven_by, "supply_temperature_C", "outdoor_temperature_C"}
    keep |= {"solar_gain_W", "internal_gain_W"}
    built = planted(segment, record, believed, PUT_IN)
    alone = replace(built, values={name: each for name, each in built.values.items() if name in keep})
    return calibrate(alone, believed, list(EFFECTS.values())), believed


@cache
def of_chain() -> tuple[Calibration, Belief]:
    """The same of a chain."""
    without = ("air_temperature_C", "operative_temperature_C", "floor_surface_temperature_C", "return_temperature_C")
    made = dataset(rows("REAL", 4, interval_s=60.0, without=without), "REAL")
    record = record_of(made)
    believed = documents(record, made)
    for segment in segments(record, believed):
        if segment.name in CHAIN:
            record = planted(segment, record, believed, CHAIN[segment.name])
    return calibrate(record, believed, list(EFFECTS.values())), believed


def named(of: tuple[Calibration, Belief]) -> dict[str, Calibrated]:
    return {each.name: each for each in calibrated(*of)}


@pytest.mark.parametrize(
    ("effect", "came", "is_kept"),
    [
        ("dead-band", {"sensor_delay": {"delay_s": 60.0}}, True),
        ("dead-band", {"setpoint_offset": {"offset_K": 0.1, "from_h": 0.0, "to_h": 24.0}}, False),
        ("dead-band", {}, True),
        ("constant-times", {"slow_actuator": {"factor": 1.2}}, True),
        ("limited-travel", {"slow_actuator": {"factor": 1.2}}, False),
    ],
)
def test_a_fit_is_kept_where_nothing_that_it_moves_was_changed_since(
    effect: str, came: dict[str, Any], is_kept: bool
) -> None:
    """A sensor whose reading was logged moves no controller, and times that replace a motor's own replace slow ones."""
    values = {
        "dead-band": {"dead_band_K": 0.7},
        "constant-times": {"dead_time_s": 150.0, "rise_time_s": 146.0, "hold_time_s": 110.0, "fall_time_s": 123.0},
        "limited-travel": {"opening": 0.8},
    }
    record = record_of(dataset(rows("REAL", 3, interval_s=60.0), "REAL"))
    believed, found = belief("REAL", record), EFFECTS[effect]
    link = next(each for each in segments(record, believed) if found.stage in each.stages)
    before = SegmentProblem(link, record, believed)
    departed = np.zeros(0), link.conventions[0]
    without, one = before.at((), *departed), before.at([(found, values[effect])], *departed)
    later = SegmentProblem(link, record, with_effects(believed, effects(**came)))
    fitted = later.at((), *departed)
    assert without
    assert one
    assert fitted
    assert (_still_best(later, found, fitted, without, one) is not None) is is_kept
    # an effect that moves nothing where it was fitted says nothing of where it would be now
    assert _still_best(later, found, fitted, without, without) is None


def test_a_fit_that_misses_more_gains_nothing_however_its_cycles_look() -> None:
    """Two channels of four cycles: one has two that are worse, in the other two better ones are no gain over noise."""

    def missed(*channels: tuple[float, ...]) -> Any:
        return SimpleNamespace(by_motion=[channel(name, each) for name, each in zip("ab", channels, strict=True)])

    def channel(name: str, each: tuple[float, ...]) -> Residual:
        cycle = np.arange(len(each))
        return Residual(name, "K", np.array(each), np.array(each), cycle >= 0, cycle, np.zeros(len(each)), cycle)

    before = missed((1.0, 1.0, 1.0, 1.0), (0.9, 0.9, 0.9, 0.9))
    after = missed((1.0, 1.7, 1.7, 1.0), (0.1, 0.9, 0.9, 0.1))
    share = {"a": 1.0, "b": 1.0}
    assert _gain(before, after, share) < 0.0
    assert _most_gained(before, share) == 0.0


@pytest.mark.parametrize("true_K", [0.5, 0.9])
def test_no_effect_of_a_healthy_chain_gains_more_than_what_is_missed_beyond_noise(true_K: float) -> None:
    record = record_of(dataset(rows("REAL", 3, effects(dead_band={"dead_band_K": true_K}), interval_s=60.0), "REAL"))
    believed = belief("REAL", record)
    link = next(each for each in segments(record, believed) if "controller" in each.stages)
    problem = SegmentProblem(link, record, believed)
    tried = [
        problem.at([(EFFECTS["dead-band"], {"dead_band_K": width_K})], np.zeros(0), link.conventions[0])
        for width_K in (0.3, 0.5, 0.7, 0.9)
    ]
    none = problem.at((), np.zeros(0), link.conventions[0])
    assert none
    share = {each.channel: together(each) for each in none.by_motion}
    gains, most = [_gain(none, one, share) for one in tried if one], _most_gained(none, share)
    assert len(gains) == 4
    assert max(gains) <= most
    assert (max(gains) > 8.0) is (true_K != 0.5)  # the dead band as believed explains all


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "value"),
    [("floor-cover resistance_m2K_W", 0.02), ("solar-factor factor", 0.85), ("gain-shift factor", 1.3)],
)
def test_what_a_house_differs_by_lies_within_its_interval(name: str, value: float) -> None:
    found = named(of_room())[name]
    assert found.value.low <= value <= found.value.high
    assert found.part == ("room" if name.startswith("floor-cover") else "drives")


@pytest.mark.slow
def test_what_differs_clearly_is_told_and_what_does_not_is_not() -> None:
    found = named(of_room())
    assert found["solar-factor factor"].is_clear
    assert not found["supply-offset offset_K"].is_clear
    assert found["solar-factor factor"].documented == 1.0
    assert list(doubts(*of_room())) == []


@pytest.mark.slow
def test_the_parameters_of_one_effect_share_a_sentence() -> None:
    found = named(of_room())
    shift, factor = found["gain-shift shift_h"], found["gain-shift factor"]
    assert shift.sentence == factor.sentence
    assert f"{factor.value.value:.2f} times as much" in factor.sentence


@pytest.mark.slow
def test_a_calibrated_room_is_followed_closely_and_without_bias() -> None:
    found = {each.channel: each for each in fits(of_room()[0])}
    air = found["air_temperature_C"]
    assert air.rmse < 0.15
    assert air.cv_rmse_percent == pytest.approx(100.0 * air.rmse / 21.0, rel=0.1)
    assert abs(air.nmbe_percent) < 0.3


@pytest.mark.slow
def test_the_hours_at_which_people_heat_a_room_are_found_though_nobody_recorded_gains() -> None:
    made = dataset(rows("REAL", DAYS, interval_s=300.0, without=(GAINS,)), "REAL")
    record = record_of(made)
    believed = documents(record, made)
    assert made.room
    assert believed.inputs
    hour = (np.arange(len(record)) + 0.5) * 300.0 / 3600.0 % 24.0
    cooking_W = 6.0 * built(made.room).floor_area_m2 * ((hour >= 17.0) & (hour < 19.0))
    warmer = replace(believed, inputs=replace(believed.inputs, gains_W=believed.inputs.gains_W + cooking_W))
    segment = next(each for each in segments(record, believed) if each.with_room and not each.is_supply)
    calibration = calibrate(planted(segment, record, warmer), believed, list(EFFECTS.values()))
    known = calibration.as_built
    place = {knob.name: place for place, knob in enumerate(known.knobs)}
    sd = np.sqrt(np.diag(known.covariance))
    for name, true in (("gains at 18 h", 6.0), ("gains at 3 h", 0.0)):
        assert known.departures[place[name]] == pytest.approx(true, abs=1.96 * sd[place[name]])
    assert known.departures[place["gains at 18 h"]] > 1.96 * sd[place["gains at 18 h"]]
    assert not any(each.name.startswith("gains at") for each in calibrated(calibration, believed))  # no documents


@pytest.mark.parametrize("pace", [0.85, 0.95, 1.06, 1.2])
def test_a_fit_of_a_healthy_motor_misses_no_more_than_the_pace_that_it_has(pace: float) -> None:
    """Slopes of what switches are jagged: fits by them alone ended at 1.00 of a motor that took 0.95 of its time."""
    seen = record("WAX", effects=effects(slow_actuator={"factor": pace}))
    believed = belief("WAX", seen)
    (link,) = (each for each in segments(seen, believed) if each.stages == ("actuator",))
    unknowns = list(knobs(list(EFFECTS.values()), link.stages, believed))
    problem = SegmentProblem(link, seen, believed, holds_out=False, unknowns=unknowns)
    found, true = _fitted(problem), problem.at((), np.log([pace]), problem.conventions[0])
    estimator = Estimator(problem)
    assert np.exp(found.departures) == pytest.approx(pace, rel=0.05)
    assert estimator.score(found, ALL) <= 1.01 * estimator.score(true, ALL)


# --- how far a factor may depart from what was calibrated ---------------------------------------------


def leak(by_record: float = 0.0) -> Knob:
    (knob,) = (each for each in knobs([EFFECTS["infiltration"]], ("room",), belief("REAL", record("REAL"))))
    return replace(knob, by_record=by_record)


@given(st.floats(-0.5, 1.0), st.floats(-3.0, 3.0, allow_subnormal=False))
def test_a_departure_of_a_factor_is_as_far_as_its_record_has_the_heat_and_what_is_believed_its_logarithm(
    by_record: float, departure: float
) -> None:
    told, step = float(np.clip(by_record, 0.0, 0.99)), leak(by_record).step(departure)
    assert (1.0 - told) * step**2 + told * np.expm1(step) ** 2 == pytest.approx(departure**2, rel=1e-6, abs=1e-12)
    assert np.sign(step) == np.sign(departure)
    assert step <= departure + 1e-9  # a leak grows by less than its logarithm has it, and shrinks by more
    assert leak(by_record).step(1e-4) == pytest.approx(1e-4, rel=1e-3)


@pytest.mark.parametrize(
    ("left", "share"), [(0.6, 0.0), (0.9, 0.0), (0.3, 0.09 * 0.75 / 0.13), (0.06, 0.0036 * 0.99 / 0.0436), (0.0, 0.0)]
)
def test_what_a_record_tells_of_a_factor_is_the_share_that_neither_belief_nor_change_has(
    left: float, share: float
) -> None:
    """Of a leak's logarithm 0.6 is believed, and 0.2 varies from one record to another; a record may tell nothing."""
    found = leak().known_within(float(np.hypot(left, 0.2)))
    assert (leak().sd, leak().varies) == (0.6, 0.2)
    assert found.by_record == pytest.approx(share, abs=1e-9)
    assert found.step(0.5) == pytest.approx(0.5, rel=0.2)


def test_an_offset_departs_as_it_is() -> None:
    (knob,) = (each for each in knobs([EFFECTS["sensor-bias"]], ("sensor",), belief("REAL", record("REAL"))))
    assert knob.known_within(0.05).step(0.3) == 0.3


# --- how the log of a healthy record may be read -----------------------------------------------------


@pytest.mark.parametrize(
    ("sensor", "output", "noise", "is_as_good"),
    [
        (1.0, 1.0, 0.0, True),
        (1.2, 0.8, 0.0, True),
        (1.3, 1.0, 0.0, False),
        (1.0, 1.3, 0.0, False),
        (1.0, 1.3, 40.0, True),
        (1.3, 1.0, 40.0, False),
    ],
)
def test_a_log_may_be_read_in_ways_that_leave_hardly_more_but_for_the_noise_that_a_controller_is_given(
    sensor: float, output: float, noise: float, is_as_good: bool
) -> None:
    def leaving(way: Convention, *left: float) -> Hypothesis:
        channels = zip(("sensor_temperature_C", "control_output"), left, strict=True)
        return Hypothesis((), way, np.zeros(0), [of_error(np.full(100, each), channel) for channel, each in channels])

    def of_error(error: FloatArray, channel: str) -> Residual:
        whole, none = np.ones(len(error), dtype=bool), np.zeros(len(error), dtype=int)
        return Residual(channel, "K", error, error, whole, none, none, none)

    def made(discounts_noise: bool) -> Any:
        return SimpleNamespace(
            discounts_noise=discounts_noise,
            segment=SimpleNamespace(conventions=(AFTER, BEFORE, RAW)),
            at=lambda effects, departures, way: leaving(way, *left_by[way]),
            drive_noise=lambda fitted, channel: {0: noise if fitted.convention == BEFORE else 0.0},
        )

    left_by = {BEFORE: (sensor, output), RAW: (0.9, 0.9)}
    first = leaving(AFTER, 1.0, 1.0)
    assert list(_as_good(made(discounts_noise=True), first)) == ([BEFORE] if is_as_good else [])
    assert list(_as_good(made(discounts_noise=False), first)) == ([BEFORE] if max(sensor, output) <= 1.2 else [])
    left_by = {BEFORE: (0.2, 0.2), RAW: (0.2, 0.2)}  # less than the least that is usual
    assert list(_as_good(made(discounts_noise=False), leaving(AFTER, 0.0, 0.1))) == [BEFORE]
    left_by = {BEFORE: (1.0, 1.0), RAW: (1.0, 1.0)}
    assert not list(_as_good(made(discounts_noise=False), leaving(AFTER, 0.0, 0.0)))


@pytest.mark.parametrize(("interval_s", "ways"), [(900.0, {BEFORE}), (10.0, set())])
def test_a_healthy_thermostat_says_how_its_log_is_read_only_where_samples_are_close(
    interval_s: float, ways: set[Convention]
) -> None:
    data = rows("WAX", DAYS, interval_s=interval_s)[
        ["time", "sensor_temperature_C", "air_temperature_C", "control_output"]
    ]
    healthy = record_of(dataset(data, "WAX"))
    found = calibrate(healthy, belief("WAX", healthy), []).as_built
    assert {name: set(each) for name, each in found.as_good.items()} == {"sensor+controller": ways}


@pytest.mark.slow
def test_a_chain_is_found_as_it_was_built_and_nothing_besides() -> None:
    found = named(of_chain())
    assert found["max-flow factor"].value.value == pytest.approx(0.9, rel=0.02)
    assert found["slow-actuator factor"].value.value == pytest.approx(1.2, rel=0.05)
    assert found["slow-actuator factor"].part == "chain"
    assert found["max-flow factor"].part == "room"  # its circuit has the full flow
    assert found["max-flow factor"].is_clear
    assert not found["sensor-bias bias_K"].is_clear
    assert not found["setpoint-offset offset_K"].is_clear
    assert found.keys() == {
        "sensor-bias bias_K",
        "setpoint-offset offset_K",
        "slow-actuator factor",
        "max-flow factor",
    }
    assert np.isnan(found["max-flow factor"].value.low)


@pytest.mark.parametrize("hangs_together", [False, True])
def test_what_is_known_of_a_room_is_wider_along_what_errors_of_hours_move_together(
    hangs_together: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One departure shifts all samples alike, which errors of six hours do too; eleven move them up and down.

    Of 56 blocks chance makes some directions look as if they hung together: that is not counted.
    """
    blocks, size, k, random = 56, 36, 12, np.random.default_rng(4)
    shared = random.normal(size=blocks).repeat(size)
    errors = shared if hangs_together else random.normal(size=blocks * size)
    every, zero = np.ones(len(errors), dtype=bool), np.zeros(len(errors), dtype=int)
    missed = Residual("air_temperature_C", "K", errors, errors, every, zero, zero, np.arange(len(errors)))
    slopes = random.normal(size=(len(errors), k))
    slopes[:, 0] = 1.0
    monkeypatch.setattr(Estimator, "slopes_at", lambda self, fitted: slopes)
    problem: Any = SimpleNamespace(sd=np.full(k, 100.0), prior=np.eye(k), record=SimpleNamespace(interval_s=600.0))
    found = np.diag(_covariance(problem, Hypothesis((), PLAIN, np.zeros(k), [missed])))
    straight = np.diag(np.linalg.inv(slopes.T @ slopes))
    luck = (1.0 + (k / blocks) ** 0.5) ** 2
    assert found[0] / straight[0] == pytest.approx(size / luck if hangs_together else 1.0, rel=0.3)
    assert found[1:] / straight[1:] == pytest.approx(np.ones(k - 1), rel=0.25)


@pytest.mark.parametrize(
    ("before", "after", "gains"), [(0.9, 0.6, 0.0), (2.0, 0.6, 0.5 * 3.0), (2.0, 1.5, 0.5 * 7 / 9)]
)
def test_to_leave_less_than_noise_of_a_healthy_record_is_no_gain(before: float, after: float, gains: float) -> None:
    """A slower sensor or a weaker controller smooths the noise of what it reads. One of ten cycles is left out."""
    gained = _gain(of_cycles(np.full(1000, before)), of_cycles(np.full(1000, after)), {"sensor_temperature_C": 4.0})
    assert gained == pytest.approx(0.9 * gains * 1000 / 4.0)


def test_what_a_single_cycle_of_a_healthy_record_says_is_no_gain() -> None:
    """A switch that slips by hours is one that the room hardly decided, and a dead band that suits it is chance."""
    slipped = np.where(np.arange(1000) // 100 == 3, 20.0, 2.0)
    share = {"sensor_temperature_C": 1.0}
    assert _gain(of_cycles(slipped), of_cycles(np.full(1000, 2.0)), share) == pytest.approx(0.0, abs=1e-9)
    assert _gain(of_cycles(slipped), of_cycles(np.full(1000, 2.1)), share) < 0.0
    assert _gain(of_cycles(np.full(1000, 20.0)), of_cycles(np.full(1000, 2.0)), share) > 1000.0


def of_cycles(missed: np.ndarray) -> Hypothesis:
    """What is missed of a sensor (1000,) in ten cycles."""
    every, fit = np.ones(1000, dtype=bool), np.zeros(1000, dtype=int)
    cycle = np.arange(1000) // 100
    residual = Residual("sensor_temperature_C", "K", missed, missed, every, cycle, fit, np.arange(1000))
    return Hypothesis((), PLAIN, np.zeros(0), [residual])


@pytest.mark.slow
def test_what_was_calibrated_is_what_is_believed_from_then_on() -> None:
    calibration, documented = of_chain()
    actuator = calibration.as_built.believed(documented).blocks["actuator"]
    expected = with_effects(documented, CHAIN["actuator"]).blocks["actuator"]
    one, other = (dict(each.parameters) for each in (actuator, expected))
    assert one.keys() == other.keys()
    assert all(one[name] == pytest.approx(other[name], rel=0.05) for name, each in other.items() if type(each) is float)


def test_an_effect_of_nothing_is_not_there_whatever_its_hours() -> None:
    offset, hours = EFFECTS["setpoint-offset"], {"from_h": 22.0, "to_h": 6.0}
    still = {"offset_K": 0.0}
    assert not told._is_there(offset, {"offset_K": 0.0, **hours}, still)
    assert told._is_there(offset, {"offset_K": -1.0, **hours}, still)


def test_the_examples_of_how_departures_are_worded_hold() -> None:
    tried = doctest.testmod(told)
    assert (tried.attempted, tried.failed) == (3, 0)


# --- what a model leaves -----------------------------------------------------------------------------


def wandering(sd_K: float, length: float, noise_K: float, count: int, seed: int) -> np.ndarray:
    """An Ornstein-Uhlenbeck process with white noise on it."""
    random, kept = np.random.default_rng(seed), np.exp(-1.0 / length)
    found = np.zeros(count)
    found[0] = sd_K * random.normal()
    for place in range(1, count):
        found[place] = kept * found[place - 1] + sd_K * (1.0 - kept**2) ** 0.5 * random.normal()
    return found + noise_K * random.normal(size=count)


@given(st.floats(0.05, 0.5), st.floats(4.0, 60.0), st.floats(0.02, 0.1), st.integers(0, 10_000), st.floats(0.0, 0.3))
def test_whitening_makes_white_noise_of_what_hangs_together(
    sd_K: float, length: float, noise_K: float, seed: int, lost: float
) -> None:
    error = wandering(sd_K, length, noise_K, 2000, seed)
    known = np.random.default_rng(seed + 1).random(2000) >= lost
    white = Discrepancy(sd_K, length * 900.0, noise_K).whitened(error, known, 900.0)
    assert (white[~known] == 0.0).all()
    seen = white[known]
    assert np.std(seen) == pytest.approx(1.0, abs=0.12)
    for lag in (1, 4, 16):
        assert abs(np.corrcoef(seen[:-lag], seen[lag:])[0, 1]) < 0.12


@pytest.mark.parametrize("seed", range(3))
def test_the_likeliest_discrepancy_is_near_the_one_that_made_the_errors(seed: int) -> None:
    error = wandering(0.2, 20.0, 0.05, 3000, seed)
    found = Discrepancy.of(error, np.ones(3000, dtype=bool), 900.0, 0.01)
    assert found.sd_K == pytest.approx(0.2, rel=0.25)
    assert found.length_s == pytest.approx(20.0 * 900.0, rel=0.5)
    assert found.noise_K == pytest.approx(0.05, rel=0.25)
    assert found.rms_K == pytest.approx(np.std(error), rel=0.25)


def test_a_noise_that_is_known_is_the_least_that_is_found() -> None:
    found = Discrepancy.of(np.zeros(500), np.ones(500, dtype=bool), 900.0, 0.03)
    assert found.noise_K >= 0.03


# --- probabilities -----------------------------------------------------------------------------------

NAMES = st.sampled_from(["none", "unknown", "let-by", "max-flow", "let-by+unknown"])


def links(weights: dict[str, float]) -> dict[str, float]:
    whole = sum(weights.values())
    return {name: weight / whole for name, weight in weights.items()}


@given(st.lists(st.dictionaries(NAMES, st.floats(0.01, 1.0), min_size=1).map(links), min_size=1, max_size=4))
def test_what_is_joined_sums_to_one_the_likeliest_first(each: list[dict[str, float]]) -> None:
    found = joint(each)
    assert sum(found.values()) == pytest.approx(1.0)
    assert all(first >= second for first, second in pairwise(found.values()))


def test_links_are_independent_and_what_is_unknown_is_named_once_and_last() -> None:
    valve, motor = {"none": 0.6, "let-by": 0.3, "unknown": 0.1}, {"none": 0.5, "wax-motor+unknown": 0.5}
    found = joint([valve, motor])
    assert found == pytest.approx(
        {
            "none": 0.3,
            "let-by": 0.15,
            "unknown": 0.05,
            "wax-motor+unknown": 0.35,
            "let-by+wax-motor+unknown": 0.15,
        }
    )
    assert joint([]) == {}


@pytest.mark.parametrize(
    ("beliefs", "groups"),
    [
        ({"none": 0.6, "let-by": 0.4}, ()),
        ({"none": 0.3, "let-by": 0.7}, ()),
        ({"none": 0.1, "let-by": 0.9}, (("let-by",),)),
        # a wrong name costs four times what silence does, and silence costs nothing only where nothing is
        ({"none": 0.22, "let-by": 0.78}, ()),
        ({"unknown": 0.22, "let-by": 0.78}, (("let-by",),)),
        ({"unknown": 0.3, "let-by": 0.7}, ()),
        ({"let-by": 0.6, "max-flow": 0.35, "stuck-open": 0.05}, (("let-by", "max-flow"),)),
        ({"let-by+max-flow": 0.9, "let-by": 0.1}, (("let-by",), ("max-flow",))),
    ],
)
def test_what_is_named_follows_from_the_probabilities(
    beliefs: dict[str, float], groups: tuple[tuple[str, ...], ...]
) -> None:
    assert Choice.of(beliefs).groups == groups


# --- when it acts ------------------------------------------------------------------------------------


def at_night(from_h: float, to_h: float) -> dict[str, float]:
    return {"flow_L_s": 20.0, "from_h": from_h, "to_h": to_h}


def of_hours(hours: int, start_h: float = 0.0) -> Record:
    return replace(plain({"air_temperature_C": np.zeros(hours)}, 3600.0), start_s=3600.0 * start_h)


@pytest.mark.parametrize(
    ("from_h", "to_h", "start_h", "spans"),
    [
        (7.0, 8.5, 0.0, [(7.0, 8.5), (31.0, 32.5)]),
        (22.0, 6.0, 0.0, [(0.0, 6.0), (22.0, 30.0), (46.0, 48.0)]),
        (7.0, 8.0, 12.0, [(19.0, 20.0), (43.0, 44.0)]),
    ],
    ids=["by day", "over midnight", "a record from noon on"],
)
def test_an_effect_of_some_hours_has_its_spans_within_the_record(
    from_h: float, to_h: float, start_h: float, spans: list[tuple[float, float]]
) -> None:
    found = when(EFFECTS["window-opening"], at_night(from_h, to_h), of_hours(48, start_h))
    assert [pytest.approx(each) for each in spans] == list(found.spans_h)
    assert found.pattern.startswith("every day from ")


def test_what_acts_always_spans_the_record() -> None:
    found = when(EFFECTS["let-by"], {"fraction": 0.1}, of_hours(30))
    assert (found.pattern, list(found.spans_h)) == ("always", [(0.0, 30.0)])


@given(st.floats(0.0, 23.9), st.floats(0.0, 23.9), st.floats(0.0, 23.0), st.integers(24, 200))
def test_spans_never_overlap_and_are_as_long_a_day_as_it_acts(
    from_h: float, to_h: float, start_h: float, hours: int
) -> None:
    spans = when(EFFECTS["window-opening"], at_night(from_h, to_h), of_hours(hours, start_h)).spans_h
    assert all(0.0 <= first < last <= hours for first, last in spans)
    assert all(one[1] <= other[0] + 1e-9 for one, other in pairwise(spans))
    whole = sum(last - first for first, last in spans)
    assert abs(whole - (to_h - from_h) % 24.0 * hours / 24.0) <= 24.0


def test_the_words_say_the_clock() -> None:
    found = when(EFFECTS["window-opening"], at_night(22.0, 6.5), of_hours(24))
    assert found.pattern == "every day from 22:00 to 06:30"
