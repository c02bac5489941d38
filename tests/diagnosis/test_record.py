"""Claims about a record made ready: what is noise, what rests, what a gap may hide, and what is one cycle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from tests.diagnosis.realities import plain, record, rows
from waxstudy.diagnosis.observations.noise import snapped
from waxstudy.diagnosis.observations.record import AFTER_GAP_S, Memory, Record
from waxstudy.plugin import FloatArray

DAY = 1440  # minutes


def wave(days: int = 4) -> FloatArray:
    """A room's temperature: a daily swing and a cycle of two hours."""
    at = np.arange(days * DAY) / DAY
    return 21.0 + np.sin(2 * np.pi * at) + 0.4 * np.sin(2 * np.pi * 12 * at)


def on_for(count: int, *spans: tuple[int, int]) -> FloatArray:
    values = np.zeros(count)
    for first, end in spans:
        values[first:end] = 1.0
    return values


# --- noise -----------------------------------------------------------------------------------------------


@given(st.floats(0.005, 0.5), st.integers(0, 99))
def test_the_noise_of_a_temperature_is_found_whatever_its_size(sd: float, seed: int) -> None:
    noisy = wave() + np.random.default_rng(seed).normal(0.0, sd, 4 * DAY)
    assert plain({"air_temperature_C": noisy}).noise["air_temperature_C"] == pytest.approx(sd, rel=0.1)


@pytest.mark.parametrize("step", [0.1, 0.5])
def test_rounding_is_noise_too(step: float) -> None:
    rounded = np.round(wave() / step) * step
    assert plain({"air_temperature_C": rounded}).noise["air_temperature_C"] >= step / np.sqrt(12.0) * 0.999


@pytest.mark.parametrize("band", [3.0, 6.0])
def test_a_flow_that_is_written_on_change_is_known_no_better_than_its_band(band: float) -> None:
    true = rows("REAL", days=4)["flow_L_h"].to_numpy()
    written = [true[0]]
    for flow in true[1:]:
        written.append(flow if abs(flow - written[-1]) >= band else written[-1])
    seen = plain({"flow_L_h": written})
    assert seen.noise["flow_L_h"] == pytest.approx(band * 3.0**-0.5, rel=0.15)
    assert float(np.std(np.array(written) - true)) < 1.2 * seen.noise["flow_L_h"]
    assert plain({"flow_L_h": true}).noise["flow_L_h"] < 1.2  # what the meter itself scatters


def test_what_is_stated_of_the_noise_wins() -> None:
    stated = plain({"air_temperature_C": wave()}, stated_noise={"air_temperature_C": 0.2})
    assert stated.noise["air_temperature_C"] == 0.2


@pytest.mark.parametrize(
    ("channel", "sd"),
    [
        ("sensor_temperature_C", 0.03),
        ("air_temperature_C", 0.03),
        ("displacement", 0.01),
        ("flow_L_h", 1.0),
        ("supply_temperature_C", 0.05),
        ("return_temperature_C", 0.05),
    ],
)
def test_the_noise_of_measured_channels_is_what_the_instruments_have(channel: str, sd: float) -> None:
    assert record("REAL").noise[channel] == pytest.approx(sd, rel=0.15)


@pytest.mark.parametrize("channel", ["control_output", "heating_signal", "setpoint_C", "solar_gain_W"])
def test_what_is_known_rather_than_measured_has_no_noise(channel: str) -> None:
    assert record("REAL").noise[channel] == 0.0


def test_gaps_do_not_change_what_is_noise() -> None:
    whole, torn = record("REAL"), record("REAL", missing=0.2)
    for channel in ("air_temperature_C", "flow_L_h", "displacement"):
        assert torn.noise[channel] == pytest.approx(whole.noise[channel], rel=0.1)


# --- what rests ------------------------------------------------------------------------------------------


def probe(opening: FloatArray, sd: float = 0.01, seed: int = 2) -> FloatArray:
    """What a displacement probe shows: noise cut off at its ends."""
    return np.clip(opening + np.random.default_rng(seed).normal(0.0, sd, len(opening)), 0.0, 1.0)


@given(st.integers(0, 99))
def test_a_displacement_at_rest_is_put_back_to_its_end(seed: int) -> None:
    opening = on_for(1200, (300, 600), (900, 1200))
    assert np.mean(snapped(probe(opening, seed=seed), 0.01) == opening) > 0.98


def test_the_first_sample_behind_a_move_rests_where_noise_alone_keeps_it_from_its_end() -> None:
    shown = probe(on_for(1200, (300, 600)))
    shown[299:303] = 0.4, 0.982, 1.0, 1.0
    shown[600:603] = 0.37, 0.018, 0.0
    np.testing.assert_array_equal(snapped(shown, 0.01)[[299, 300, 600, 601]], [0.4, 1.0, 0.37, 0.0])
    shown[601] = 0.06  # which noise does not reach
    assert snapped(shown, 0.01)[601] == 0.06


@pytest.mark.parametrize("rest", [0.06, 0.5, 0.93])
def test_a_displacement_that_rests_elsewhere_stays_there(rest: float) -> None:
    shown = probe(np.full(1200, rest))
    assert np.array_equal(snapped(shown, 0.01), shown)


def test_a_displacement_that_moves_is_left_as_it_was_shown() -> None:
    opening = np.concatenate((np.zeros(200), np.linspace(0.0, 1.0, 300), np.ones(200)))
    shown = probe(opening)
    done = snapped(shown, 0.01)
    moving = (opening > 0.08) & (opening < 0.92)
    assert np.array_equal(done[moving], shown[moving])
    assert (done[:190] == 0.0).all()
    assert (done[-190:] == 1.0).all()


# --- gaps ------------------------------------------------------------------------------------------------


def signal(lost: tuple[int, int]) -> Record:
    """On from 100 to 200, with samples lost."""
    values = on_for(600, (100, 200))
    values[lost[0] : lost[1]] = np.nan
    return plain({"heating_signal": values})


@given(st.integers(1, 90), st.integers(1, 60))
def test_a_gap_that_hides_a_switch_is_not_judged_for_a_while_after_it(before: int, behind: int) -> None:
    gap = signal((100 - before, 100 + behind)).is_gap("heating_signal")
    after = round(AFTER_GAP_S / 60.0)
    assert gap[100 - before : 100 + behind + after].all()
    assert not gap[: 100 - before - 1].any()
    assert not gap[100 + behind + after + 1 :].any()


@pytest.mark.parametrize("lost", [(120, 180), (300, 400), (0, 50), (550, 600)])
def test_a_gap_between_equal_samples_is_only_missing_itself(lost: tuple[int, int]) -> None:
    gap = signal(lost).is_gap("heating_signal")
    assert np.array_equal(np.flatnonzero(gap), np.arange(*lost))


@given(st.lists(st.sampled_from([0.0, 1.0, float("nan")]), min_size=30, max_size=300))
@settings(max_examples=50)
def test_what_switches_is_held_over_a_gap_and_never_in_between(samples: list[float]) -> None:
    values = np.array([0.0, 1.0] * 6 + samples)
    seen = plain({"heating_signal": values})
    filled = seen.filled("heating_signal")
    assert set(filled) <= {0.0, 1.0}
    assert np.array_equal(filled[np.isfinite(values)], values[np.isfinite(values)])
    lost = np.flatnonzero(~np.isfinite(values))
    assert np.array_equal(filled[lost], filled[lost - 1])


def test_what_runs_on_is_drawn_straight_through_a_gap() -> None:
    values = wave()
    values[500:560] = np.nan
    filled = plain({"air_temperature_C": values}).filled("air_temperature_C")
    assert filled[500:560] == pytest.approx(np.linspace(values[499], values[560], 62)[1:-1])


def test_a_channel_of_a_few_samples_is_not_there() -> None:
    few = np.full(1000, np.nan)
    few[:10] = 21.0
    assert not plain({"air_temperature_C": few}).has("air_temperature_C")


# --- smoothing -------------------------------------------------------------------------------------------


def test_smoothing_takes_noise_away_and_leaves_the_room() -> None:
    noise = np.random.default_rng(1).normal(0.0, 0.03, 4 * DAY)
    seen = plain({"air_temperature_C": wave() + noise})
    error = (seen.drive("air_temperature_C") - wave())[30:-30]
    assert np.std(error) < 0.5 * 0.03


@given(st.floats(-1.0, 1.0), st.floats(-0.01, 0.01), st.floats(-1e-5, 1e-5))
def test_smoothing_leaves_a_parabola_as_it_is(level: float, slope: float, bend: float) -> None:
    at = np.arange(400.0)
    parabola = level + slope * at + bend * at**2
    assert plain({"a": parabola}).smooth(parabola) == pytest.approx(parabola, abs=1e-9)


def test_where_samples_are_rare_nothing_is_smoothed() -> None:
    rare = wave()[::15]
    assert plain({"air_temperature_C": rare}, interval_s=900.0).smooth(rare) is rare


# --- time ------------------------------------------------------------------------------------------------


@example([(5, 10)] * 8)
@given(st.lists(st.tuples(st.integers(5, 200), st.integers(2, 200)), min_size=7, max_size=30))
def test_each_heating_is_in_one_cycle_with_the_pause_around_it(spans: list[tuple[int, int]]) -> None:
    values = np.concatenate([np.concatenate((np.zeros(off), np.ones(on))) for off, on in spans] + [np.zeros(20)])
    cycle = plain({"heating_signal": values}).cycle
    starts = np.flatnonzero(np.diff(values) > 0) + 1
    ends = np.flatnonzero(np.diff(values) < 0)
    assert np.array_equal(cycle[starts], cycle[ends])
    assert len(set(cycle[starts].tolist())) == len(starts)
    assert (np.diff(cycle) >= 0).all()


def test_where_nothing_switches_a_block_is_a_day() -> None:
    still = plain({"air_temperature_C": wave()})
    assert np.array_equal(still.cycle, still.day)
    assert still.day.tolist() == np.repeat(np.arange(4), DAY).tolist()


def test_the_first_six_hours_are_not_judged_and_of_a_short_record_a_tenth() -> None:
    assert np.flatnonzero(plain({"a": wave()}).settled)[0] == 360
    assert np.flatnonzero(plain({"a": wave(1)}).settled)[0] == 144


@pytest.mark.parametrize("channel", ["outdoor_temperature_C", "supply_temperature_C"])
def test_what_drives_a_room_is_named_where_it_is_missing(channel: str) -> None:
    seen = record("REAL", without=[channel])
    assert not seen.has_inputs
    with pytest.raises(KeyError, match=channel):
        _ = seen.inputs


# --- what is remembered ----------------------------------------------------------------------------------


@given(st.integers(1, 5), st.lists(st.integers(0, 7), max_size=40))
def test_what_is_remembered_is_what_would_be_made_and_the_last_are_not_made_again(most: int, keys: list[int]) -> None:
    memory, made = Memory(most), list[int]()

    def make(key: int) -> str:
        made.append(key)
        return str(key)

    for place, key in enumerate(keys):
        lately = list(dict.fromkeys(reversed(keys[:place])))[:most]
        before = len(made)
        assert memory.get(key, lambda key=key: make(key)) == str(key)  # type: ignore[misc]
        assert len(made) - before == (key not in lately)


def hourly_flow(flow_L_h: Sequence[float], **more: Sequence[float]) -> Record:
    channels = {"flow_L_h": flow_L_h, "return_temperature_C": np.full(len(flow_L_h), 25.0), **more}
    return plain({name: np.tile(values, 100) for name, values in channels.items()}, 3600.0)


def test_by_the_hour_a_return_counts_where_water_flowed_throughout() -> None:
    seen = hourly_flow([0.0, 60.0, 100.0, 98.0])
    assert seen.flowing[:4].tolist() == [False, False, True, True]
    assert seen.has_return
    every_minute = replace(seen, interval_s=60.0)
    assert every_minute.flowing[:4].tolist() == [False, True, True, True]


def test_a_sample_of_a_larger_flow_leaves_the_returns_of_the_usual_one() -> None:
    seen = hourly_flow([0.0, 60.0, 100.0, 98.0])
    flow = seen.values["flow_L_h"].copy()
    flow[30] = 150.0
    flushed = replace(seen, values={**seen.values, "flow_L_h": flow})
    assert flushed.flowing.sum() == seen.flowing.sum() == 200


def test_a_valve_that_was_half_open_for_every_hour_shows_no_return() -> None:
    pulsed = hourly_flow([0.0, 50.0, 50.0, 49.0], heating_signal=[0.0, 0.5, 0.5, 0.5])
    assert not pulsed.flowing.any()
    assert not pulsed.has_return
    throttled = hourly_flow([0.0, 50.0, 50.0, 49.0], heating_signal=[0.0, 1.0, 1.0, 1.0])
    assert throttled.flowing.sum() == 300


@pytest.mark.parametrize("channel", ["outdoor_temperature_C", "supply_temperature_C", "flow_L_h"])
@pytest.mark.parametrize(("lost", "is_long"), [(30, False), (36, False), (40, True)])
def test_a_room_is_not_judged_where_its_drive_is_lost_for_over_six_hours(
    channel: str, lost: int, is_long: bool
) -> None:
    values = np.full(600, 20.0)
    values[200 : 200 + lost] = np.nan
    seen = plain({channel: values, "air_temperature_C": np.full(600, 21.0)}, 600.0)
    missing = np.flatnonzero(~seen.driven)
    assert missing.tolist() == (list(range(200, 200 + lost + 36)) if is_long else [])


@pytest.mark.parametrize("channel", ["solar_gain_W", "internal_gain_W"])
def test_lost_heat_is_that_of_other_days_and_the_room_is_not_judged_there(channel: str) -> None:
    """A straight line would hold a noon through three nights."""
    hour = np.arange(7 * 144) / 6.0 % 24.0
    heat_W = np.clip(np.sin((hour - 6.0) / 12.0 * np.pi), 0.0, None) * 500.0
    values = heat_W.copy()
    values[2 * 144 + 72 : 5 * 144 + 72] = np.nan
    seen = plain({channel: values, "air_temperature_C": np.full(len(hour), 21.0)}, 600.0)
    assert seen.filled(channel) == pytest.approx(heat_W, abs=1e-9)
    assert np.flatnonzero(~seen.driven).tolist() == list(range(2 * 144 + 72, 5 * 144 + 72 + 36))


def test_a_sun_that_is_blank_at_night_is_not_lost() -> None:
    hour = np.arange(7 * 144) / 6.0 % 24.0
    sun_W = np.clip(np.sin((hour - 6.0) / 12.0 * np.pi), 0.0, None) * 500.0
    blank = plain({"solar_gain_W": np.where(sun_W > 0.0, sun_W, np.nan), "air_temperature_C": hour}, 600.0)
    assert blank.driven.all()
    assert blank.filled("solar_gain_W").max() == sun_W.max()


def test_a_lost_room_temperature_loses_nothing_else() -> None:
    air = np.where(np.arange(600) < 300, np.nan, 21.0)
    seen = plain({"air_temperature_C": air, "outdoor_temperature_C": np.full(600, 0.0)}, 600.0)
    assert seen.driven.all()
