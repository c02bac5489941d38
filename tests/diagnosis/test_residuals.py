"""Claims about judging: what counts as an error, how much, and on which days."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.diagnosis.evidences import SOUND
from tests.diagnosis.realities import PERFECT, belief, estimator, plain, record
from waxstudy.diagnosis.criteria import Question, limit
from waxstudy.diagnosis.estimate.hypothesis import Residual
from waxstudy.diagnosis.model.room_response import Predicted
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.partition import FIT, SELECT, SHRINK, parts_of
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.continuous import RIDGE, STEEP, Continuous, stands
from waxstudy.diagnosis.residuals.judge import Judge
from waxstudy.diagnosis.residuals.noise_floor import NoiseFloor
from waxstudy.diagnosis.residuals.switching import Switching, softened
from waxstudy.diagnosis.select.null import by_block
from waxstudy.plugin import Belief

pytestmark = pytest.mark.quick

DAY = 1440


def empty(days: float, interval_s: float = 60.0, cycles_per_day: int = 8) -> Record:
    count = round(days * 86_400.0 / interval_s)
    at = np.arange(count) * interval_s / 86_400.0
    return plain({"heating_signal": np.where(at * cycles_per_day % 1.0 < 0.3, 1.0, 0.0)}, interval_s)


# --- parts -----------------------------------------------------------------------------------------------


@given(st.floats(6.0, 60.0), st.sampled_from([60.0, 300.0, 900.0]), st.booleans())
@settings(max_examples=30)
def test_shrinkage_is_on_the_last_three_days_or_more_and_on_no_day_of_the_search(
    days: float, interval_s: float, days_in_turn: bool
) -> None:
    part = parts_of(empty(days, interval_s), days_in_turn)
    kept = np.flatnonzero(part == SHRINK)
    assert len(kept) * interval_s >= 3 * 86_400.0 - interval_s
    assert kept[-1] == len(part) - 1
    assert np.array_equal(kept, np.arange(kept[0], len(part)))
    for searched in (FIT, SELECT):
        assert np.mean(part == searched) > 0.15


@given(st.floats(6.0, 30.0), st.floats(0.0, 0.4), st.sampled_from([0.0, 1.0]))
@settings(max_examples=40)
def test_the_chain_is_fitted_to_its_first_cycles_and_judged_on_the_next(days: float, share: float, at: float) -> None:
    """It may rest, or be heated without end, for days before."""
    seen = empty(days)
    signal = np.where(np.arange(len(seen)) < share * len(seen), at, seen.values["heating_signal"])
    part = parts_of(plain({"heating_signal": signal}, seen.interval_s))
    assert np.flatnonzero(part == FIT)[-1] < np.flatnonzero(part == SELECT)[0]
    starts = np.flatnonzero(np.diff(signal) > 0.5) + 1
    fitted, judged = (int(np.sum(part[starts] == number)) for number in (FIT, SELECT))
    assert abs(fitted - 0.57 * (fitted + judged)) <= 2


def test_where_hardly_a_cycle_is_seen_days_are_cut_instead() -> None:
    seen = plain({"heating_signal": np.zeros(14 * DAY)}, 60.0)
    part = parts_of(seen)
    assert 0.4 < np.mean(part[part != SHRINK] == FIT) < 0.7


def test_a_room_is_fitted_and_judged_on_days_in_turn() -> None:
    part = parts_of(empty(14), days_in_turn=True)
    days = part[: 9 * DAY].reshape(9, DAY)
    assert (days == days[:, :1]).all()
    assert days[:, 0].tolist() == [FIT, SELECT] * 4 + [FIT]


@pytest.mark.parametrize("days_in_turn", [True, False])
def test_a_short_record_has_blocks_in_turn_and_keeps_none_back(days_in_turn: bool) -> None:
    seen = empty(4)
    part = parts_of(seen, days_in_turn)
    assert set(part.tolist()) == {FIT, SELECT}
    blocks = seen.day if days_in_turn else seen.cycle
    for number in np.unique(blocks):
        assert len(set(part[blocks == number].tolist())) == 1


# --- switches --------------------------------------------------------------------------------------------

SWITCH = Segment(("modulator",), "control_output", ("heating_signal",))


def switching(days: int = 8) -> tuple[Record, Judge]:
    signal = empty(days).values["heating_signal"]
    seen = plain({"control_output": signal, "heating_signal": signal, "setpoint_C": np.full(len(signal), 21.0)})
    return seen, Judge(SWITCH, seen, Belief({}))


@given(st.integers(1, 26), st.booleans())
@settings(max_examples=20)
def test_a_switch_that_comes_late_or_early_costs_its_seconds(minutes: int, is_early: bool) -> None:
    seen, judge = switching()
    shifted = np.roll(seen.values["heating_signal"], -minutes if is_early else minutes)
    (residual,) = judge.residuals(Predicted({"heating_signal": shifted}))
    assert residual.unit == "s"
    # up to half of the shortest pulse, beyond which it is nearer to another switch
    assert residual.error[residual.judged][1:-1] == pytest.approx(60.0 * minutes)
    # 8 days of 8 cycles of two switches, but for the first six hours
    assert residual.judged.sum() == pytest.approx(128 - 4, abs=2)


def test_a_prediction_that_is_the_record_misses_nothing() -> None:
    seen, judge = switching()
    (residual,) = judge.residuals(Predicted({"heating_signal": seen.values["heating_signal"]}))
    assert residual.gap() == residual.loss() == 0.0


def test_a_sample_belongs_to_the_switch_that_is_nearest_to_it() -> None:
    signal = np.zeros(DAY)
    signal[600:660] = signal[800:900] = 1.0
    seen = plain({"control_output": signal, "heating_signal": signal, "setpoint_C": np.full(DAY, 21.0)})
    late = np.zeros(DAY)
    late[603:655] = late[800:910] = 1.0
    judge = Switching("heating_signal", SWITCH, seen, np.zeros(DAY), None)
    residual = judge.residual(Predicted({"heating_signal": late}))
    # between the switches they end at 630, 730 and 850; of each the sample in the middle stands for it
    assert residual.sample.tolist() == [314, 679, 789, 1144]
    assert residual.judged.tolist() == [False, True, True, True]  # before the first, its state is unknown
    assert residual.error.tolist() == [0.0, 300.0, 0.0, 600.0]
    least_s = 60.0 / np.sqrt(12.0)  # where nothing else moves a switch: a uniform place within its interval
    assert judge.typical_s == pytest.approx(least_s)
    assert residual.whitened == pytest.approx(softened(np.array([0.0, 300.0, 0.0, 600.0]) / least_s))


def test_an_error_of_three_standard_deviations_is_halfway_to_counting_straight() -> None:
    """The pseudo-Huber loss at its own width: twice 3² times the root of two less one."""
    assert softened(np.array([3.0]))[0] ** 2 == pytest.approx(18.0 * (np.sqrt(2.0) - 1.0))


def test_a_switch_that_never_comes_costs_the_whole_pulse() -> None:
    seen, judge = switching()
    (residual,) = judge.residuals(Predicted({"heating_signal": np.zeros(len(seen))}))
    pulse_s = 0.3 * 86_400.0 / 8
    assert residual.error[residual.judged].sum() == pytest.approx(pulse_s * 8 * 7.75, rel=0.02)


@given(st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=9))
def test_a_softened_error_grows_with_the_error_and_is_it_where_it_is_small(residual: list[float]) -> None:
    ordered = np.sort(np.abs(residual))
    soft = softened(ordered)
    assert (np.diff(soft) >= 0.0).all()
    assert (soft <= ordered + 1e-7).all()
    assert softened(np.array([0.1]))[0] == pytest.approx(0.1, rel=1e-3)


def test_far_out_twice_the_error_is_twice_the_loss_and_not_four_times() -> None:
    one, two = softened(np.array([300.0, 600.0])) ** 2
    assert two / one == pytest.approx(2.0, rel=0.01)


# --- all channels ----------------------------------------------------------------------------------------


@cache
def judged(case: str = "REAL", missing: float = 0.0) -> list[tuple[Judge, Predicted, list[Residual]]]:
    """Every segment of a record that is believed rightly."""
    seen = record(case, days=6, missing=missing)
    believed = belief(case, seen)
    found = []
    for segment in segments(seen, believed):
        judge = Judge(segment, seen, believed)
        predicted = segment.predict(seen, believed, segment.conventions[0])
        found.append((judge, predicted, judge.residuals(predicted)))
    return found


@pytest.mark.parametrize("missing", [0.0, 0.2])
def test_losses_of_parts_and_of_blocks_add_up_to_the_whole(missing: float) -> None:
    for _, _, residual in judged(missing=missing):
        for each in residual:
            parts = [each.loss(part) for part in (FIT, SELECT, SHRINK)]
            assert sum(parts) == pytest.approx(each.loss())
        for part in (FIT, SELECT, SHRINK):
            for each in residual:
                chosen = each.part == part
                losses = by_block(np.array([each.whitened[chosen] ** 2]), each.block[chosen])
                assert losses.sum() == pytest.approx(each.loss(part))


@pytest.mark.parametrize("missing", [0.0, 0.2])
def test_where_nothing_is_judged_there_is_no_error(missing: float) -> None:
    for _, _, residual in judged(missing=missing):
        for each in residual:
            assert (each.error[~each.judged] == 0.0).all()
            assert (each.whitened[~each.judged] == 0.0).all()
            assert np.isfinite(each.whitened).all()
            needs_flow = each.channel in ("return_temperature_C", "supply_temperature_C")
            assert 0.3 < each.judged.mean() <= 1.0 or needs_flow


def test_what_is_lost_or_not_settled_is_not_judged() -> None:
    for judge, _, residual in judged(missing=0.2):
        seen = judge.record
        for each in residual:
            if len(each.sample) == len(seen):
                assert not (each.judged & ~np.isfinite(seen.values[each.channel])).any()
            assert seen.settled[each.sample[each.judged]].all() or each.unit == "s"


@pytest.mark.parametrize("missing", [0.0, 0.2])
def test_a_right_belief_misses_no_more_than_the_noise(missing: float) -> None:
    for judge, _, residual in judged(missing=missing):
        for each in residual:
            # what flowed in a gap is not known, and the room remembers it
            if each.unit == "s" or (missing and judge.segment.with_room):
                continue
            assert each.gap() < 2.5 * max(judge.record.noise[each.channel], 0.005), each.channel


def test_how_often_a_room_s_temperatures_are_logged_moves_its_prediction_by_no_time() -> None:
    """A right room misses as little of samples at the ends of five minutes as of those of ten seconds."""
    gaps = []
    for interval_s in (10.0, 60.0, 300.0):
        seen = record("REAL", days=4, interval_s=interval_s, **PERFECT)
        believed = belief("REAL", seen)
        (room,) = [segment for segment in segments(seen, believed) if segment.with_room]
        residual = Judge(room, seen, believed).residuals(room.predict(seen, believed, room.conventions[0]))
        gaps.append([each.gap() for each in residual if each.channel != "return_temperature_C"])
    assert np.ptp(gaps, axis=0).max() < 0.001


@pytest.mark.parametrize("interval_s", [60.0, 900.0])
def test_a_right_controller_misses_no_more_than_what_its_own_drive_s_noise_makes_of_it(interval_s: float) -> None:
    seen = record("PI", days=4, interval_s=interval_s)
    believed = belief("PI", seen)
    fitter = estimator(segments(seen, believed)[0], seen, believed)
    floor = NoiseFloor.of(fitter.problem, fitter.base)
    for each in fitter.base.residuals:
        least = limit(Question.CLAIM, "over", replace(SOUND, stage="controller", channel=each.channel))
        assert 0.7 < each.gap() / floor.plain[each.channel] < least


def test_the_gap_is_in_the_channel_s_unit() -> None:
    """A temperature that is half a kelvin off misses half a kelvin."""
    judge, predicted, _ = next(each for each in judged() if each[0].segment.with_room)
    for channel in ("air_temperature_C", "operative_temperature_C", "floor_surface_temperature_C"):
        off = Predicted({**predicted, channel: judge.ways[channel].measured + 0.5})
        (found,) = [each for each in judge.residuals(off) if each.channel == channel]
        assert found.unit == "K"
        assert found.gap() == pytest.approx(0.5)


def test_each_error_has_the_block_and_part_of_its_sample() -> None:
    for judge, _, residual in judged():
        for each in residual:
            block = judge.record.day if judge.segment.with_room else judge.record.cycle
            assert np.array_equal(each.part, judge.parts[each.sample])
            assert np.array_equal(each.block, block[each.sample])


def test_a_meter_that_shows_noise_around_zero_does_not_stand_still() -> None:
    noise = np.random.default_rng(3).normal(0.0, 1.0, 1000)
    assert not stands(noise, 120.0).any()
    assert not stands(np.clip(noise, 0.0, None), 120.0)[noise > 1.0].any()
    for full in (0.0, 120.0):
        assert stands(np.zeros(1000), full).all()


def test_a_zero_is_a_meter_that_stands_among_nine_others_of_the_thirty_around_it() -> None:
    """Up to a ten-thousandth of full flow."""
    flow = np.full(101, 60.0)
    flow[[35, *range(46, 54), 65]] = 0.01
    assert np.flatnonzero(stands(flow, 120.0)).tolist() == [50]
    assert not stands(1.5 * flow, 120.0).any()
    flow[[65, 66]] = 60.0, 0.01
    assert not stands(flow, 120.0).any()


def metered() -> tuple[Record, np.ndarray]:
    """A day in which a valve is open a third of the time, and where that is."""
    random, is_open = np.random.default_rng(4), empty(1).values["heating_signal"] == 1.0
    values = {
        "heating_signal": is_open,
        "displacement": np.where(is_open, 1.0, 0.0) + random.normal(0.0, 0.02, DAY),
        "flow_L_h": np.where(is_open, 60.0 + random.normal(0.0, 2.0, DAY), 0.0),
        "return_temperature_C": 25.0 + random.normal(0.0, 0.1, DAY),
    }
    stated = {"displacement": 0.02, "flow_L_h": 2.0, "return_temperature_C": 0.1}
    return plain(values, stated_noise=stated), is_open


def judged_of(
    channel: str, record: Record, driven_by: str = "heating_signal", perturbed: Sequence[Predicted] = ()
) -> Continuous:
    still, *moved = perturbed or (None,)
    way = Continuous(channel, Segment(("valve",), driven_by, (channel,)), record, np.zeros(len(record)), still)
    for each in moved if way.is_moved else ():
        way.see(each)
    return way


def test_noise_is_what_a_channel_shows_less_where_it_is_cut_off_and_none_where_a_meter_stands() -> None:
    seen, is_open = metered()
    assert judged_of("return_temperature_C", seen).noise == pytest.approx(0.1)
    assert judged_of("displacement", seen).noise == pytest.approx(0.02 * 0.5**0.5)
    assert judged_of("flow_L_h", seen).noise == pytest.approx(np.where(is_open, 2.0, 0.0))


def test_a_meter_that_stands_is_trusted_ten_times_as_far_and_no_other_channel() -> None:
    seen, is_open = metered()
    assert judged_of("flow_L_h", seen).scale == pytest.approx(np.where(is_open, 2.0, 0.2))
    resting = replace(seen, values={**seen.values, "displacement": np.where(is_open, 1.0, 0.0)})
    assert judged_of("displacement", resting).scale == pytest.approx(0.02)
    assert judged_of("return_temperature_C", seen).scale == pytest.approx(0.1)


def test_each_switch_is_put_where_it_fits_best() -> None:
    """Of two predictions the first is right from one switch to the next, the second after that, and so on.

    What lies between two switches is of one of them, and a sample that the other one fits better changes nothing.
    """
    seen, is_open = metered()
    stretch = np.cumsum(np.diff(is_open, prepend=is_open[0]) != 0)
    odd = np.arange(DAY) % 50 == 7
    right, flow = judged_of("flow_L_h", seen), seen.values["flow_L_h"]
    two = np.array([flow + np.where((stretch % 2 == place) ^ odd, -9.0, 1.0) for place in (1, 0)])
    error = right.residual(Predicted({"flow_L_h": flow}, {"flow_L_h": two})).error
    assert error[right.known] == pytest.approx(np.where(odd, -9.0, 1.0)[right.known])
    assert (error[~right.known] == 0.0).all()


def test_where_a_switch_fits_best_is_told_in_standard_deviations() -> None:
    """A tenth of the noise counts as one where the meter stands: ten minutes of that outdo ten of a larger error."""
    is_on = np.arange(DAY) % 180 < 60
    flow = np.where(is_on & (np.arange(DAY) % 180 >= 30), 60.0, 0.0)
    seen = plain({"heating_signal": is_on, "flow_L_h": flow}, stated_noise={"flow_L_h": 2.0})
    sign, late = np.where(np.arange(DAY) % 2, 1.0, -1.0), np.where(flow, 3.0, 0.0)
    early = np.where(is_on & (flow == 0.0), 1.0, 0.0)
    right = judged_of("flow_L_h", seen)
    error = right.residual(Predicted({"flow_L_h": flow}, {"flow_L_h": flow + sign * [early, late]})).error
    assert error == pytest.approx(np.where(right.known, sign * late, 0.0))


def test_a_flow_is_weighed_by_how_far_noise_of_the_opening_moves_it_and_by_more_while_that_moves() -> None:
    at = np.arange(float(DAY))
    opening = np.interp(at, [600.0, 620.0, 900.0, 920.0], [0.0, 1.0, 1.0, 0.0])
    flow = 60.0 * opening
    seen = plain({"displacement": opening, "flow_L_h": flow}, stated_noise={"displacement": 1e-3, "flow_L_h": 2.0})
    moved = [Predicted({"flow_L_h": flow + off}) for off in (0.0, 0.9, -2.1)]
    weighed = judged_of("flow_L_h", seen, "displacement", moved)
    off = np.sqrt((0.9**2 + 2.1**2) / 2.0)
    assert weighed.driven == pytest.approx(off)
    assert weighed.scale[700:800] == pytest.approx(np.hypot(2.0, off))
    within = 60.0 * np.hypot(0.05, 0.18 * 0.05)  # of full flow, at a step of a twentieth of the stroke
    assert weighed.scale[605:615] == pytest.approx(np.hypot(np.hypot(2.0, within), off))


@pytest.mark.parametrize(("step", "moves"), [(0.027, False), (0.033, True)])
def test_an_opening_moves_that_steps_by_more_than_thrice_its_noise(step: float, moves: bool) -> None:
    opening = np.interp(np.arange(DAY), [700, 700 + 0.6 / step], [0.2, 0.8])
    stated = {"displacement": 0.01, "flow_L_h": 0.2}
    seen = plain({"displacement": opening, "flow_L_h": 75.0 * opening}, stated_noise=stated)
    scale = judged_of("flow_L_h", seen, "displacement").scale
    assert (scale.max() > 3.0) == moves  # a twentieth of full flow


def test_full_flow_is_the_largest_that_was_seen_or_where_nothing_flowed_the_believed_one() -> None:
    dead, believed = np.zeros(DAY), [Predicted({"flow_L_h": np.full(DAY, 120.0)})] * 2
    seen = plain({"displacement": dead + 0.5, "flow_L_h": dead}, stated_noise={"flow_L_h": 0.2})
    assert judged_of("flow_L_h", seen, "displacement", believed).scale == pytest.approx(0.12)
    assert judged_of("flow_L_h", seen, "displacement").scale == pytest.approx(0.02)
    flowing = replace(seen, values={**seen.values, "flow_L_h": np.where(np.arange(DAY) < 720, 60.0, 0.0)})
    assert judged_of("flow_L_h", flowing, "displacement", believed).scale[800:] == pytest.approx(0.06)


def test_what_a_perfect_channel_misses_is_weighed_by_a_thousandth_at_least() -> None:
    output = np.tile([0.0, 0.25, 0.5], DAY // 3)
    scale = judged_of("control_output", plain({"control_output": output}), "air_temperature_C").scale
    assert scale == pytest.approx(1e-3)


@pytest.mark.parametrize(("interval_s", "around"), [(1.0, 3600), (60.0, 60), (7200.0, 1)])
def test_an_output_is_weighed_by_how_far_noise_moves_it_in_the_hour_around(interval_s: float, around: int) -> None:
    """And everywhere by what it does in the mean."""
    count, middle = 12 * max(around, 20), 6 * max(around, 20)
    output = np.where(np.arange(count) < middle, 0.2, 0.6)
    seen = plain({"control_output": output, "air_temperature_C": np.full(count, 21.0)}, interval_s)
    more = np.zeros(count)
    more[middle] = 3.0
    moved = [Predicted({"control_output": output + each * more}) for each in (0.0, 1.0, -3.0)]
    driven = judged_of("control_output", seen, "air_temperature_C", moved).driven
    at = middle + np.array([-around, 0, around])
    mean = np.sqrt(45.0 / count)
    assert driven[at] == pytest.approx([mean, np.sqrt(45.0 / around), mean])
    assert np.sum(driven > 1.01 * mean) == around


def test_noise_of_a_drive_moves_no_temperature_and_a_switch_has_none() -> None:
    seen, _ = metered()
    moved = [Predicted({name: seen.values[name] + off for name in seen.values}) for off in (0.0, 2.0)]
    for channel, driven_by in (("flow_L_h", "heating_signal"), ("return_temperature_C", "displacement")):
        still, noisy = (judged_of(channel, seen, driven_by, each).scale for each in (moved[:1], moved))
        assert np.array_equal(still, noisy)


def test_an_error_counts_in_standard_deviations_of_its_noise() -> None:
    seen, is_open = metered()
    for channel, noise in (("return_temperature_C", 0.1), ("flow_L_h", np.where(is_open, 2.0, 0.2))):
        way = judged_of(channel, seen)
        found = way.residual(Predicted({channel: way.measured + 0.3}))
        assert found.whitened == pytest.approx(np.where(way.known, 0.3 / noise, 0.0))


@pytest.mark.parametrize("channel", ["sensor_temperature_C", "control_output"])
def test_a_slow_channel_is_smoothed_and_its_noise_is_what_that_leaves(channel: str) -> None:
    noise = np.random.default_rng(5).normal(0.0, 0.1, 10 * DAY)
    way = judged_of(channel, plain({channel: 0.5 + noise}, stated_noise={channel: 0.1}))
    assert np.std(way.measured) == pytest.approx(way.noise[0], rel=0.1)
    assert len(way.noise) == 10 * DAY
    assert np.ptp(way.noise) == 0.0


# --- what nobody knows between samples ---------------------------------------------------------------------


@pytest.mark.parametrize(("jump", "is_known"), [(0.39, True), (0.41, False), (-0.41, False)])
def test_what_flowed_while_an_opening_jumped_within_a_sample_is_not_judged(jump: float, is_known: bool) -> None:
    jumps = np.arange(DAY) == 700
    opening = 0.5 + np.where(np.arange(DAY) >= 700, jump, 0.0)
    seen = plain({"displacement": opening, "flow_L_h": 60.0 * opening, "sensor_temperature_C": opening + 20.0})
    assert np.array_equal(judged_of("flow_L_h", seen, "displacement").known, seen.settled & ~(jumps & (not is_known)))
    for other in ("heating_signal", "air_temperature_C"):
        assert np.array_equal(judged_of("sensor_temperature_C", seen, other).known, seen.settled)


@pytest.mark.parametrize(("through", "share"), [(0.1, 0.2), (0.7, 0.7)])
def test_a_moving_valve_is_missed_by_a_share_of_its_travel_or_of_what_that_lets_through(
    through: float, share: float
) -> None:
    later = np.arange(DAY) >= 700
    opening = 0.1 + np.where(later, 0.2, 0.0)
    flow = Predicted({"flow_L_h": 60.0 * np.where(later, 1.0, 1.0 - through)})
    about: dict[str, Any] = {"stated_noise": {"displacement": 0.01, "flow_L_h": 0.1}}
    seen = plain({"displacement": opening, "flow_L_h": 60.0 * opening, "sensor_temperature_C": opening + 20.0}, **about)
    way = judged_of("flow_L_h", seen, "displacement", [flow])
    assert way.scale[700] == pytest.approx(np.hypot(RIDGE, STEEP * share) * 60.0 * 0.3, rel=0.01)
    assert way.scale[600] < 1.0


@pytest.mark.parametrize("driven_by", ["heating_signal", "displacement", "air_temperature_C"])
@pytest.mark.parametrize(("interval_s", "is_coarse"), [(60.0, False), (120.0, False), (300.0, True), (900.0, True)])
def test_of_coarse_samples_a_lone_one_is_not_judged_where_its_drive_switches_or_moves(
    interval_s: float, is_coarse: bool, driven_by: str
) -> None:
    """A motor is there and back between samples that are more than a minute apart."""
    signal = empty(6, interval_s).values["heating_signal"]
    rests = np.zeros(len(signal))
    values = {"heating_signal": signal, "displacement": 0.5 + rests, "air_temperature_C": 21.0 + rests}
    alone = np.flatnonzero(np.convolve(signal, np.ones(5), mode="same") == 0.0)[-20:-19]
    flow = 60.0 + rests
    flow[alone] = 20.0
    seen = plain({**values, "flow_L_h": flow}, interval_s)
    known = judged_of("flow_L_h", seen, driven_by).known
    hides = is_coarse or (driven_by == "displacement" and interval_s > 60.0)
    hidden = alone.tolist() if hides and not driven_by.startswith("air") else []
    assert np.flatnonzero(seen.settled & ~known).tolist() == hidden


def test_what_came_in_a_gap_of_its_drive_is_not_judged() -> None:
    seen, _ = metered()
    lost = np.where(np.arange(DAY) // 40 == 20, np.nan, seen.values["displacement"])
    known = judged_of("flow_L_h", replace(seen, values={**seen.values, "displacement": lost}), "displacement").known
    assert not known[800:840].any()
    assert known[700:720].all()


def test_a_sensor_is_not_judged_where_the_air_was_lost() -> None:
    seen, _ = metered()
    steady = {name: np.full(DAY, 21.0) for name in ("sensor_temperature_C", "air_temperature_C")}
    steady["air_temperature_C"][800:840] = np.nan
    whole = replace(seen, values={**seen.values, **steady})
    known = judged_of("sensor_temperature_C", whole, "sensor_temperature_C").known
    assert not known[800:840].any()
    assert known[700:720].all()
