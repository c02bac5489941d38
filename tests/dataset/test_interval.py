"""Claims about a record and its baseline that were sampled at different intervals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.dataset.test_excerpt import recorded
from waxstudy.dataset.interval import alike, coarser
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


def test_of_a_baseline_s_chain_only_what_the_record_has_is_read() -> None:
    record, before = pulsed(4, 300.0, "2024-02-01"), pulsed(5, 300.0, "2024-01-01")
    before = replace(before, values=before.values.assign(displacement=0.5, floor_surface_temperature_C=22.0))
    same, found = alike(record, before)
    assert "displacement" not in found.values
    assert "floor_surface_temperature_C" in found.values
    assert same.assumptions == ("The baseline is read without displacement, which the record lacks.",)


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
