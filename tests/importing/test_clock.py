"""Claims about clocks: which zone and which end of an interval a stamp is of, and what is said of one set back."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.cli.conftest import Entry
from tests.importing.conftest import read
from tests.importing.test_bad_input import house, imported, refused
from waxstudy.importing.stamps import stamps_of


@pytest.mark.parametrize(
    ("name", "hours"),
    [("Time (CET)", 1), ("Zeit (MEZ)", 1), ("time_cest", 2), ("Zeit [MESZ]", 2), ("CET (UTC+1)", 1), ("Time EST", -5)],
)
def test_a_zone_of_any_name_above_stamps_is_theirs_all_year(name: str, hours: int) -> None:
    written = pd.Series(["2026-01-10 12:00", "2026-07-10 12:00"], name=name)
    found = stamps_of(written, None, "x.csv").tz_convert("UTC").tz_localize(None)
    assert list(found + pd.Timedelta(hours, "h")) == list(pd.to_datetime(written))


@pytest.mark.parametrize("name", ["Zeit (MEZ/MESZ)", "Time CET or CEST", "heure est", "Wet bulb time", "Zeit West"])
def test_two_zones_or_a_word_above_stamps_are_no_zone(name: str) -> None:
    assert stamps_of(pd.Series(["2026-01-10 12:00"], name=name), None, "x.csv").tz is None


def test_a_record_in_summer_is_not_moved_where_its_clock_stays_in_winter_time(entry: Entry) -> None:
    frame = house("2026-04-05").rename_axis("Zeit (MEZ)")
    done = imported(entry, frame, "--timezone", "Europe/Berlin")
    assert done.code == 0, done.stderr
    assert read(Path("living")).index[0] == frame.index[0]
    assert "Stamps are in UTC+01:00, as the name 'Zeit (MEZ)' says." in done.stdout


@pytest.mark.parametrize(("behind", "hours"), [(" UTC+02:00", 2), (" GMT+2", 2), (" UTC-0530", -5.5), (" UTC", 0)])
def test_an_offset_behind_a_zone_is_that_of_the_stamp(behind: str, hours: float) -> None:
    written = pd.Series(["2026-04-05 01:05:00", "2026-04-05 01:10:00"])
    found = stamps_of((written + behind).rename("Zeit"), None, "x.csv").tz_convert("UTC").tz_localize(None)
    assert list(found + pd.Timedelta(hours, "h")) == list(pd.to_datetime(written))


@pytest.mark.parametrize("form", ["%d/%m/%Y %I:%M:%S", "%Y-%m-%d %I:%M:%S", "%Y/%m/%d %I:%M"])
@pytest.mark.parametrize("half", ["a. m.", "a.m.", "AM", "a.\u00a0m."])
@pytest.mark.parametrize("is_stated", [False, True])
def test_a_clock_of_twelve_hours_is_read_as_it_is_written(form: str, half: str, is_stated: bool) -> None:
    times = pd.date_range("2026-01-13 00:05", periods=240, freq="5min")
    halves = [half if at.hour < 12 else half.replace("a", "p").replace("A", "P") for at in times]
    written = pd.Series([f"{at} {each}" for at, each in zip(times.strftime(form), halves, strict=True)], name="Zeit")
    assert stamps_of(written, f"{form} %p" if is_stated else None, "x.csv").equals(times.as_unit("ns"))


def test_blanks_around_stamps_and_their_name_do_not_count(entry: Entry) -> None:
    """As a database's shell pads its columns."""
    frame = house()
    frame.index = pd.Index([f" {at:%Y-%m-%d %H:%M:%S}+01 " for at in frame.index], name="time ")
    done = imported(entry, frame, "--timezone", "Europe/Berlin")
    assert done.code == 0, done.stderr
    assert read(Path("living")).index[0] == house().index[0]


@pytest.mark.parametrize(
    ("begin", "end"), [("Von", "Bis"), ("from", "to"), ("Start", "Ende"), ("period_start", "period_end")]
)
def test_an_interval_is_stamped_at_its_end(entry: Entry, begin: str, end: str) -> None:
    frame = house()
    frame.insert(0, end, frame.index + pd.Timedelta("5min"))
    done = imported(entry, frame.rename_axis(begin))
    assert done.code == 0, done.stderr
    assert read(Path("living")).index[0] == house().index[0] + pd.Timedelta("5min")
    assert "Bis" not in done.stderr


@pytest.mark.parametrize("zone", [(), ("--timezone", "Europe/Berlin")])
@pytest.mark.parametrize("hours", [10.0 / 60.0, 3.0])
def test_a_clock_that_is_set_back_in_winter_is_told_with_its_row(
    entry: Entry, hours: float, zone: tuple[str, ...]
) -> None:
    frame = house()
    late = np.arange(len(frame)) >= 400
    frame.index = frame.index - pd.to_timedelta(np.where(late, hours, 0.0), unit="h")
    done = imported(entry, frame.rename_axis("time"), *zone)
    assert done.code == 0, done.stderr
    assert done.stdout.count("house.csv, row 402: time goes back from 2026-01-11 ") == 1


def test_rows_in_any_order_are_no_clock_that_is_set_back(entry: Entry) -> None:
    done = imported(entry, house().sample(frac=1.0, random_state=3))
    assert (done.code, "goes back" in done.stdout) == (0, False)


def test_where_words_stand_among_setpoints_the_last_one_is_said_to_hold(entry: Entry) -> None:
    frame = house()
    dial = pd.Series("21.0", frame.index)
    dial.iloc[:200], dial.iloc[200:224] = "20.5", "OFF"
    done = imported(entry, frame.assign(setpoint=dial))
    assert done.code == 0, done.stderr
    assert "setpoint: 24 readings are words among numbers: missing, and the last setpoint holds there" in " ".join(
        done.stderr.split()
    )


def test_json_is_told_at_once_however_long_its_line(entry: Entry) -> None:
    Path("q.json").write_text('{"data": [' + ", ".join(f'[{place}, "21.4"]' for place in range(200_000)) + "]}")
    refused(entry("import", "q.json", "--out", "living"), "is no table: it holds JSON")
