"""Claims about what is looked at of a long or fine record."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from waxstudy.dataset.excerpt import SWITCHING, excerpt
from waxstudy.dataset.limits import MOST_DAYS
from waxstudy.dataset.read import Dataset

DAY_S = 86_400


def recorded(days: int, interval_s: float = 600.0, busy: tuple[int, int] | None = None) -> Dataset:
    """A signal that comes once a day, on busy days every hour; the air is the number of its sample."""
    count = round(days * DAY_S / interval_s)
    time = pd.date_range("2024-01-01", periods=count + 1, freq=pd.Timedelta(interval_s, "s"))[1:]
    hour, day = np.arange(count) * interval_s / 3600.0 % 24.0, np.arange(count) * interval_s // DAY_S
    on = (hour >= 12.0) & (hour < 14.0)
    if busy:
        is_busy = (day >= busy[0]) & (day <= busy[1])
        on = np.where(is_busy, hour % 1.0 < 0.5, on)
    values = pd.DataFrame(
        {"heating_signal": on.astype(float), "air_temperature_C": np.arange(count, dtype=float), "flow_L_h": 60.0 * on},
        index=time,
    )
    return Dataset("x", Path("x"), interval_s, time, values, (), {}, None, None, 1.0, {}, None, (), ())


def first_and_last(dataset: Dataset) -> tuple[str, str]:
    begins = dataset.time - pd.Timedelta(dataset.interval_s, "s")
    return str(begins[0].date()), str(begins[-1].date())


@pytest.mark.parametrize("days", [3, 14, MOST_DAYS, MOST_DAYS + 1])
def test_a_record_of_a_month_is_looked_at_as_a_whole(days: int) -> None:
    dataset = recorded(days)
    assert excerpt(dataset) is dataset


def test_of_a_long_record_the_latest_days_are_taken_where_all_tell_alike() -> None:
    found = excerpt(recorded(60))
    assert first_and_last(found) == ("2024-02-02", "2024-02-29")
    assert len(found.time) == len(found.values) == MOST_DAYS * 144
    (said,) = found.warnings
    assert "Of the record's 60 days the 28 from 2024-02-02 to 2024-02-29 are judged" in said


def test_of_a_long_record_the_days_are_taken_in_which_the_valve_moves() -> None:
    first, last = first_and_last(excerpt(recorded(90, busy=(20, 40))))
    assert first <= "2024-01-24"  # a tenth less is as good, and later
    assert last >= "2024-02-10"


def test_days_of_which_much_is_missing_tell_less() -> None:
    dataset = recorded(60)
    values = dataset.values.copy()
    values.iloc[-20 * 144 :] = np.nan
    assert first_and_last(excerpt(replace(dataset, values=values)))[1] < "2024-02-14"


def test_samples_finer_than_a_controller_looks_are_taken_every_five_seconds() -> None:
    dataset = recorded(3, interval_s=1.0)
    found = excerpt(dataset)
    assert found.interval_s == 5.0
    assert len(found.time) == 3 * DAY_S / 5
    assert (found.time[0], found.time[-1]) == (dataset.time[4], dataset.time[-1])
    assert found.values["air_temperature_C"].to_list()[:2] == [4.0, 9.0]  # the last of each
    assert found.values["flow_L_h"].mean() == pytest.approx(dataset.values["flow_L_h"].mean())
    assert set(found.values["heating_signal"]) == {0.0, 1.0}
    assert "taken every 5 s" in found.assumptions[-1]


def test_what_begins_within_five_seconds_is_left_out() -> None:
    dataset = recorded(3, interval_s=2.0)
    late = replace(dataset, time=dataset.time[1:], values=dataset.values[1:])
    found = excerpt(late)
    assert found.interval_s == 6.0
    assert found.time[0] == dataset.time[5]
    assert np.isfinite(found.values.to_numpy()).all()


def test_the_valve_is_no_reason_where_nothing_of_it_was_recorded() -> None:
    dataset = recorded(60)
    (with_valve,) = excerpt(dataset).warnings
    of_rooms = dataset.values.drop(columns=dataset.values.columns.intersection(SWITCHING))
    (without,) = excerpt(replace(dataset, values=of_rooms)).warnings
    assert ("valve" in with_valve, "valve" in without) == (True, False)
    assert "least is missing" in without
