"""Claims about a record and its baseline that were sampled or rounded differently, or have different clocks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.dataset.test_excerpt import recorded
from waxstudy.dataset.alike import alike
from waxstudy.dataset.interval import coarser
from waxstudy.dataset.read import Dataset


def pulsed(days: int, interval_s: float, first: str) -> Dataset:
    """A signal that is on for 25 minutes of every hour."""
    dataset = recorded(days, interval_s)
    minute = np.arange(len(dataset.time)) * interval_s / 60.0 % 60.0
    time = pd.date_range(first, periods=len(dataset.time) + 1, freq=pd.Timedelta(interval_s, "s"))[1:]
    values = dataset.values.assign(heating_signal=np.where(minute < 25.0, 1.0, 0.0)).set_axis(time)
    return replace(dataset, time=time, values=values)


@pytest.mark.parametrize("are_means", [False, True])
def test_a_record_is_read_as_its_baseline_was_sampled(are_means: bool) -> None:
    record, before = pulsed(4, 300.0, "2024-02-01"), pulsed(5, 300.0, "2024-01-01")
    baseline = coarser(before, 3600.0, are_means)
    found, same = alike(record, baseline)
    assert same is baseline
    assert (found.interval_s, len(found.time)) == (3600.0, 4 * 24)
    assert found.values["heating_signal"].unique() == pytest.approx([5.0 / 12.0 if are_means else 0.0])
    (said,) = found.warnings
    kind = "means" if are_means else "instants at the end"
    assert said.startswith(f"The baseline has a sample every 60 min, so the record is read as {kind} of 60 min: ")


def test_a_baseline_is_read_as_its_record_was_sampled() -> None:
    record, before = coarser(pulsed(4, 300.0, "2024-02-01"), 3600.0, are_means=True), pulsed(5, 60.0, "2024-01-01")
    same, found = alike(record, before)
    assert same.values is record.values
    assert found.values["heating_signal"].unique() == pytest.approx([25.0 / 60.0])
    assert same.warnings == ()
    assert same.assumptions == ("The baseline is read as means of 60 min, as the record seems to hold.",)


def with_more(dataset: Dataset, **more: float) -> Dataset:
    return replace(dataset, values=dataset.values.assign(**more))


def test_of_a_baseline_s_chain_only_what_the_record_has_is_read() -> None:
    record, before = pulsed(4, 300.0, "2024-02-01"), pulsed(5, 300.0, "2024-01-01")
    chain = {"sensor_temperature_C": 21.0, "setpoint_C": 20.0, "displacement": 0.5}
    same, found = alike(record, with_more(before, floor_surface_temperature_C=22.0, **chain))
    assert not chain.keys() & set(found.values)
    assert "floor_surface_temperature_C" in found.values
    lacking = "sensor_temperature_C, setpoint_C, displacement"
    assert same.assumptions == (f"The baseline is read without {lacking}, which the record lacks.",)
    assert same.warnings == ()


def test_of_a_record_only_what_its_baseline_has_is_read() -> None:
    """Whether the rest changed nobody can tell: what was always so would be named as a change."""
    record, before = pulsed(4, 300.0, "2024-02-01"), pulsed(5, 300.0, "2024-01-01")
    more = {"displacement": 0.5, "floor_surface_temperature_C": 22.0, "solar_gain_W": 90.0}
    blank = {"displacement": float("nan")}
    found, _ = alike(with_more(record, **more), with_more(before, **blank))
    assert not more.keys() & set(found.values)
    (said,) = found.warnings
    lacking = "displacement, floor_surface_temperature_C, solar_gain_W"
    assert said.startswith(f"The record is read without {lacking}, which the baseline lacks: ")
    assert found.assumptions == ()
    light = with_more(before, global_irradiance_W_m2=300.0)
    assert "solar_gain_W" in alike(with_more(record, solar_gain_W=90.0), light)[0].values  # light tells the sun


def test_where_signals_were_put_right_already_or_nothing_switches_means_are_taken() -> None:
    """A loop that switches every few hours: of its hourly means few lie between off and on, and none after reading."""
    record, before = recorded(4, 300.0), recorded(9, 300.0)
    slow = coarser(before, 3600.0, are_means=True)
    slow = replace(slow, values=slow.values.assign(heating_signal=slow.values["heating_signal"].round()))
    for baseline in (slow, replace(slow, values=slow.values[["air_temperature_C"]])):
        found, _ = alike(record, baseline)
        assert found.values["air_temperature_C"].iloc[0] == pytest.approx(5.5)  # of samples 0 to 11


@pytest.mark.parametrize("are_means", [False, True])
def test_a_gap_stays_a_gap_and_a_channel_that_is_logged_seldom_is_kept(are_means: bool) -> None:
    whole = recorded(3, 300.0)
    place = np.arange(len(whole.time))
    values = whole.values.assign(
        air_temperature_C=whole.values["air_temperature_C"].where((place < 12) | (place > 21)),
        outdoor_temperature_C=np.where(place % 6 == 5, 1.0, np.nan),
    )
    found = coarser(replace(whole, values=values), 3600.0, are_means).values
    assert np.flatnonzero(found["air_temperature_C"].isna()).tolist() == [1]
    assert found["outdoor_temperature_C"].notna().all()


@pytest.mark.parametrize("interval_s", [240.0, 300.0, 400.0])
def test_of_about_the_same_interval_nothing_is_changed(interval_s: float) -> None:
    record, before = pulsed(4, 300.0, "2024-02-01"), pulsed(4, interval_s, "2024-01-01")
    assert alike(record, before) == (record, before)


@given(st.integers(2, 24), st.booleans(), st.integers(0, 30))
def test_a_longer_interval_keeps_what_flowed_and_never_makes_up_an_interval(
    factor: int, are_means: bool, lost: int
) -> None:
    whole = pulsed(3, 300.0, "2024-01-01")
    cut = replace(whole, time=whole.time[lost:], values=whole.values.iloc[lost:])
    found = coarser(cut, factor * 300.0, are_means)
    assert found.time.isin(whole.time).all()
    for end, flow_L_h in found.values["flow_L_h"].items():
        within = (cut.time > end - pd.Timedelta(factor * 300.0, "s")) & (cut.time <= end)
        assert within.sum() == factor
        assert flow_L_h == pytest.approx(cut.values["flow_L_h"][within].mean())


# --- rounding ----------------------------------------------------------------------------------------


def drawn(first: str, step_K: float, seed: int) -> Dataset:
    """A room whose air wanders, rounded to a step."""
    dataset = pulsed(6, 600.0, first)
    wander = 21.0 + np.cumsum(np.random.default_rng(seed).normal(0.0, 0.05, len(dataset.time)))
    return replace(dataset, values=dataset.values.assign(air_temperature_C=np.round(wander / step_K) * step_K))


@pytest.mark.parametrize(("step_K", "shown"), [(0.5, 2), (5.0 / 9.0, 2)], ids=["half a kelvin", "whole fahrenheit"])
@pytest.mark.parametrize("is_record_coarse", [True, False])
def test_the_finer_of_two_is_rounded_as_the_coarser(is_record_coarse: bool, step_K: float, shown: int) -> None:
    steps = (step_K, 0.01) if is_record_coarse else (0.01, step_K)
    pair = drawn("2024-02-01", steps[0], 1), drawn("2024-01-01", steps[1], 2)
    pair = tuple(replace(each, values=each.values.round(shown)) for each in pair)
    both = alike(*pair)
    for before, after, step in zip(pair, both, steps, strict=True):
        moved = (after.values["air_temperature_C"] - before.values["air_temperature_C"]).abs()
        assert moved.max() <= (0.55 * step_K if step < step_K else 0.0)
        assert moved.max() >= (0.4 * step_K if step < step_K else 0.0)
        places = after.values["air_temperature_C"].diff().dropna() / step_K
        assert (places - places.round()).abs().max() < 0.05
    (said,) = both[0].warnings
    here, there = ("0.01 K" if each < step_K else f"{each:.2g}"[:3] for each in steps)
    assert said.startswith(f"rounded to {here}")
    assert f"in the record and to {there}" in said
    assert "air_temperature_C; both are read with the coarser" in said


def test_a_room_that_is_held_within_two_values_is_rounded_too() -> None:
    record, before = drawn("2024-02-01", 0.01, 1), drawn("2024-01-01", 0.5, 2)
    held = before.values["air_temperature_C"].gt(21.0).map({True: 21.5, False: 21.0})
    found, _ = alike(record, replace(before, values=before.values.assign(air_temperature_C=held)))
    assert set(2.0 * found.values["air_temperature_C"] % 1.0) == {0.0}


@pytest.mark.parametrize(("here_K", "there_K"), [(0.1, 0.1), (0.05, 0.01), (0.5, 0.5)])
def test_two_of_the_same_rounding_or_finer_than_a_tenth_stay(here_K: float, there_K: float) -> None:
    pair = drawn("2024-02-01", here_K, 1), drawn("2024-01-01", there_K, 2)
    record, baseline = alike(*pair)
    assert (record, baseline) == pair
    assert record.warnings == ()


def test_a_temperature_that_lies_on_no_grid_is_left_as_it_is() -> None:
    record, before = drawn("2024-02-01", 0.01, 1), drawn("2024-01-01", 0.5, 2)
    odd = before.values["air_temperature_C"].where(np.arange(len(before.time)) % 7 != 0, 21.0 + 0.2)
    strange = replace(before, values=before.values.assign(air_temperature_C=odd))
    assert alike(record, strange)[0].values is record.values


# --- clocks ------------------------------------------------------------------------------------------


def sunny(first: str, late_h: float) -> Dataset:
    """Days of the sun at 60 degrees north, by its height, as a clock shows it that is so late."""
    from pvlib.solarposition import get_solarposition

    dataset = pulsed(10, 600.0, first)
    true = dataset.time - pd.Timedelta(late_h, "h")
    height = get_solarposition(true.tz_localize("Etc/GMT-2"), 60.0, 30.0)["apparent_elevation"].to_numpy()
    sun = 300.0 * np.maximum(0.0, np.sin(np.radians(height)))
    return replace(dataset, values=dataset.values.assign(solar_gain_W=sun))


@pytest.mark.parametrize("first", ["2024-02-10", "2024-04-10", "2023-11-20"])
@pytest.mark.parametrize("late_h", [-1.0, 0.0, 1.0, 2.0])
def test_a_sun_of_another_clock_than_the_baseline_s_is_told_whatever_the_season(first: str, late_h: float) -> None:
    """From November to February noon itself moves by half an hour."""
    record, _ = alike(sunny(first, late_h), sunny("2024-01-10", 0.0))
    said = [each for each in record.warnings if each.startswith("solar_gain_W is ")]
    how = f"solar_gain_W is {abs(late_h):.1f} h {'later' if late_h > 0.0 else 'earlier'} than in the baseline"
    assert [each.split(",")[0] for each in said] == ([how] if late_h else [])


def test_a_sun_that_was_lost_is_not_known_and_one_that_never_was_stays_dark() -> None:
    """A windowless room is dark in both; of a record whose sun was lost a heater would be named."""
    lit, lost = sunny("2024-01-10", 0.0), sunny("2024-02-10", 0.0)
    dark = [replace(each, values=each.values.assign(solar_gain_W=0.0)) for each in (lost, lit)]
    record, baseline = alike(dark[0], lit)
    assert "solar_gain_W" not in record.values
    assert "solar_gain_W" in baseline.values
    assert record.warnings == ("solar_gain_W: 0 throughout, though the baseline has sun; taken as not recorded",)
    assert "solar_gain_W" in alike(*dark)[0].values
    assert alike(*dark)[0].warnings == ()
    record, baseline = alike(lost, dark[1])
    assert "solar_gain_W" not in record.values  # beside a room that was learned without it a sun would be a change
    assert "solar_gain_W" not in baseline.values
    said = "solar_gain_W: 0 throughout in the baseline, though the record has sun; taken as not recorded"
    assert said in record.warnings


COURSE = np.sin(np.arange(5 * 288) / 50.0)


def two(**of_record: object) -> tuple[Dataset, Dataset]:
    """A record with some channels, and a baseline without them."""
    record, before = pulsed(4, 300.0, "2024-02-01"), pulsed(5, 300.0, "2024-01-01")
    return replace(record, values=record.values.assign(**of_record)), before


def having(dataset: Dataset, **more: object) -> Dataset:
    return replace(dataset, values=dataset.values.assign(**more))


@pytest.mark.parametrize("name", ["outdoor_temperature_C", "supply_temperature_C", "air_temperature_C"])
def test_a_thermometer_that_never_moves_where_it_did_in_the_other_record_is_dead(name: str) -> None:
    record, before = two(**{name: 5.0})
    found, _ = alike(record, having(before, **{name: COURSE}))
    assert name not in found.values
    said = f"{name}: 5 C throughout, though it moves in the baseline; taken as not recorded ("
    assert any(each.startswith(said) for each in found.warnings)
    record, before = two(**{name: COURSE[: 4 * 288]})
    found, same = alike(record, having(before, **{name: 5.0}))
    assert name not in same.values
    assert name not in found.values
    said = f"{name}: 5 C throughout in the baseline, though it moves in the record; taken as not recorded ("
    assert any(each.startswith(said) for each in found.warnings)


@pytest.mark.parametrize("name", ["outdoor_temperature_C", "supply_temperature_C"])
def test_a_thermometer_that_stands_still_in_both_or_is_assumed_is_no_dead_one(name: str) -> None:
    record, before = two(**{name: 5.0})
    moves, steady = having(before, **{name: COURSE}), having(before, **{name: 5.0})
    for one, other in (
        (record, steady),
        (replace(record, assumed=(name,)), moves),
        (record, replace(moves, assumed=(name,))),
    ):
        found, same = alike(one, other)
        assert name in found.values
        assert name in same.values
        assert found.warnings == ()


def test_a_channel_that_is_empty_in_one_of_the_two_is_not_called_dead() -> None:
    empty = {"solar_gain_W": float("nan"), "outdoor_temperature_C": float("nan")}
    record, before = two(solar_gain_W=90.0 + COURSE[: 4 * 288], outdoor_temperature_C=5.0)
    found, _ = alike(record, having(before, **empty))
    assert not [each for each in found.warnings if "throughout" in each]
    record, before = two(**empty)
    found, _ = alike(record, having(before, solar_gain_W=90.0, outdoor_temperature_C=COURSE))
    assert not [each for each in found.warnings if "throughout" in each]


# --- setpoints ---------------------------------------------------------------------------------------

NIGHT_C = np.where(np.arange(5 * 288) % 288 < 72, 18.0, 21.0)


def test_a_setpoint_may_stand_still_in_one_of_the_two_records() -> None:
    record, before = two(setpoint_C=21.0)
    found, same = alike(record, having(before, setpoint_C=NIGHT_C))
    assert "setpoint_C" in found.values
    assert "setpoint_C" in same.values
    assert found.warnings == ()


def test_hours_of_another_setpoint_that_one_of_the_two_recorded_are_of_both() -> None:
    """Read in one of them alone they would be a change."""
    record, before = two(setpoint_C=NIGHT_C[: 4 * 288])
    found, same = alike(replace(record, setpoint_C=None), replace(before, setpoint_C=21.0))
    assert "setpoint_C" not in found.values
    assert found.setpoint_C == 21.0
    record, before = two()
    found, same = alike(replace(record, setpoint_C=21.0), replace(having(before, setpoint_C=NIGHT_C), setpoint_C=None))
    assert "setpoint_C" not in same.values
    assert same.setpoint_C == 21.0


def test_a_recorded_setpoint_that_never_changes_is_known_as_well_as_one_that_is_stated() -> None:
    record, before = two(setpoint_C=19.0)
    assert "setpoint_C" in alike(record, replace(before, setpoint_C=21.0))[0].values
    assert "setpoint_C" not in alike(record, replace(before, setpoint_C=None))[0].values


def test_a_channel_of_a_few_samples_counts_as_not_recorded() -> None:
    record, before = two(displacement=0.5)
    few = having(before, displacement=[0.5] * 5 + [float("nan")] * (5 * 288 - 5))
    assert "displacement" not in alike(record, few)[0].values


def test_light_that_never_goes_out_tells_no_clock() -> None:
    record = sunny("2024-02-10", 2.0)
    offset = replace(record, values=record.values.assign(solar_gain_W=record.values["solar_gain_W"] + 5.0))
    assert alike(offset, sunny("2024-01-10", 0.0))[0].warnings == ()


def test_two_days_of_sun_tell_no_clock() -> None:
    record = sunny("2024-02-10", 2.0)
    sun = record.values["solar_gain_W"].where(np.arange(len(record.time)) < 2 * 144, 0.0)
    short = replace(record, values=record.values.assign(solar_gain_W=sun))
    assert alike(short, sunny("2024-01-10", 0.0))[0].warnings == ()
