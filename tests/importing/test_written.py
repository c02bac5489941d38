"""Claims about how cells are written: marks of thousands, states in words, dates, and zones of stamps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.cli.conftest import Entry
from tests.importing.test_bad_input import house, imported
from waxstudy.dataset.text import _titles
from waxstudy.importing.stamps import is_stamps, stamps_of
from waxstudy.importing.words import numbers_of
from waxstudy.study.problems import StudyError

MARKS = [(",", "."), (".", ","), ("'", "."), ("\u2019", "."), (" ", ","), ("\u00a0", ","), ("\u202f", ",")]
AT = pd.Timestamp("2026-01-13 16:05")
MIDNIGHT = pd.Timestamp("2026-01-14 00:00")


@given(number=st.integers(10_000, 99_999_999), marks=st.sampled_from(MARKS))
def test_a_mark_of_thousands_is_none_of_decimals(number: int, marks: tuple[str, str]) -> None:
    thousands, decimal = marks
    written = f"{number / 10.0:,.1f}".replace(",", "T").replace(".", decimal).replace("T", thousands)
    read = numbers_of(pd.Series([written, f"{written} L/h"], dtype=object))
    assert read.values.tolist() == [number / 10.0] * 2
    assert read.bad is None


@pytest.mark.parametrize(
    ("written", "value"),
    [
        ("1.051", 1.051),
        ("1,051", 1.051),
        ("21,3", 21.3),
        ("1,051,000", 1_051_000.0),
        ("-1.051,5", -1051.5),
        ("1'051", 1051.0),
        ("1\u202f051", 1051.0),
    ],
)
def test_one_mark_alone_is_one_of_decimals_and_two_of_a_kind_are_of_thousands(written: str, value: float) -> None:
    assert numbers_of(pd.Series([written], dtype=object)).values.tolist() == [value]


@pytest.mark.parametrize(("thousands", "decimal"), [(",", "."), (".", ",")])
def test_what_one_cell_tells_of_a_mark_holds_for_its_column(thousands: str, decimal: str) -> None:
    """As programmes write them that leave out zeros behind the comma."""
    column = [f"987{decimal}5", f"1{thousands}051{decimal}5", f"1{thousands}052", "12"]
    assert numbers_of(pd.Series(column, dtype=object)).values.tolist() == [987.5, 1051.5, 1052.0, 12.0]


@pytest.mark.parametrize("written", ["3.7.", "2024.01.02", "1.2.3", "12,34,56.7", "192.168.100.1"])
def test_what_is_no_number_is_none(written: str) -> None:
    read = numbers_of(pd.Series([written], dtype=object))
    assert np.isnan(read.values).all()
    assert read.bad == (0, written)


@pytest.mark.parametrize(
    ("opened", "closed"),
    [("Ouvert", "Fermé"), ("aan", "uit"), ("PÅ", "AV"), ("päällä", "pois"), ("sees", "väljas"), ("acceso", "spento"),
     ("encendido", "apagado"), ("włączone", "wyłączone"), ("вкл", "выкл"), ("tændt", "slukket"), ("WAHR", "FALSCH")],
)  # fmt: skip
def test_a_valve_is_read_in_the_words_of_its_country(entry: Entry, opened: str, closed: str) -> None:
    frame = house()
    words = frame.assign(heating_valve=np.where(frame["heating_valve"] > 0.5, opened, closed))
    done = imported(entry, words, "--yes", "--timezone", "Etc/GMT-1")
    assert done.code == 0, done.stderr
    data = pd.read_csv(Path("living") / "data.csv")
    assert data["heating_signal"].mean() == pytest.approx(frame["heating_valve"].mean(), abs=0.01)


@pytest.mark.parametrize(
    ("name", "hours"),
    [("Time (UTC)", 0.0), ("timestamp_utc", 0.0), ("UTC time", 0.0), ("Date Time, GMT+01:00", 1.0),
     ("Time [GMT-5]", -5.0), ("zeit (utc +5:30)", 5.5), ("Time (GMT + 1)", 1.0), ("UTC (+2)", 2.0),
     ("t UTC\u22123", -3.0)],
)  # fmt: skip
def test_the_zone_that_a_column_s_name_tells_is_that_of_its_stamps(name: str, hours: float) -> None:
    written = pd.Series(["2024-01-10 12:00", "2024-07-10 12:00"], name=name)
    found = stamps_of(written, None, "x.csv").tz_convert("UTC").tz_localize(None)
    assert list(found + pd.Timedelta(hours, "h")) == list(pd.to_datetime(written))


@pytest.mark.parametrize(
    "name", ["time", "Zeit", "outcutc", "time_gmtx", "time_utc-2024", "time_utc-2501", "time utc+5.5"]
)
def test_any_other_name_tells_no_zone_and_a_stamp_s_own_goes_before(name: str) -> None:
    assert stamps_of(pd.Series(["2024-01-10 12:00"], name=name), None, "x.csv").tz is None
    own = stamps_of(pd.Series(["2024-01-10 12:00+02:00"], name="Time (UTC)"), None, "x.csv")
    assert own[0] == pd.Timestamp("2024-01-10 10:00", tz="UTC")


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("Time (UTC)", "Stamps are in UTC, as the name 'Time (UTC)' says."),
        ("Time GMT+02:00", "Stamps are in UTC+02:00, as the name 'Time GMT+02:00' says."),
        ("Time", ""),
        ("time_utc-2501", ""),
    ],
)
def test_a_zone_that_is_taken_from_a_name_is_told_once(entry: Entry, name: str, told: str) -> None:
    house().rename_axis(name).to_csv("house.csv")
    done = entry("import", "house.csv", "--timezone", "Europe/Tallinn", "--out", "record")
    assert done.code == 0
    assert (done.stdout + done.stderr).count("Stamps are in ") == (1 if told else 0)
    assert told in done.stdout + done.stderr


@pytest.mark.parametrize(
    "form",
    [
        "%d.%m.%y %H:%M",
        "%m/%d/%y %I:%M:%S %p",
        "%d/%m/%y %H:%M",
        "%d-%b-%Y %H:%M:%S",
        "%d-%b-%y %H:%M",
        "%b %d, %Y %I:%M %p",
        "%B %d, %Y at %I:%M%p",
        "%b %d, %Y @ %H:%M:%S.%f",
        "%d.%m.%Y %H:%M:%S,%f",
        "%d.%m.%Y  %H:%M",
        "%d/%m/%Y\t%H:%M:%S",
        "%a %d.%m.%Y %H:%M",
        "%A, %d/%m/%Y %H:%M",
        "Mo. %Y-%m-%d %H:%M",
        "%Y%m%d%H%M",
        "%Y%m%d%H%M%S",
    ],
)
def test_a_date_is_read_as_people_and_loggers_write_it(form: str) -> None:
    times = pd.date_range(AT, periods=600, freq="5min")
    written = pd.Series(times.strftime(form), name="Time")
    column = written.astype(np.int64) if written.str.isdigit().all() else written
    assert is_stamps(column)
    assert stamps_of(column, None, "file").equals(times.as_unit("ns"))


@pytest.mark.parametrize(("zone", "hours"), [("UTC", 0), ("CET", 1), ("MESZ", 2), ("EST", -5)])
@pytest.mark.parametrize("form", ["%Y-%m-%d %H:%M:%S", "%d.%m.%Y %H:%M", "%m/%d/%y %I:%M %p", "%a, %d %b %Y %H:%M:%S"])
def test_a_zone_behind_a_stamp_is_its_own(zone: str, hours: float, form: str) -> None:
    times = pd.Series([AT, AT + pd.Timedelta(minutes=5)])
    written = times.dt.strftime(form) + f" {zone}"
    stamps = stamps_of(written.rename("Time"), None, "file")
    assert list(stamps) == list(times.dt.tz_localize("UTC") - pd.Timedelta(hours=hours))


def test_stamps_of_summer_and_of_winter_are_in_the_standard_time_of_both() -> None:
    written = pd.Series(["2026-10-25 02:55:00 CEST", "2026-10-25 02:00:00 CET"], name="Time")
    first, second = stamps_of(written, None, "file")
    assert second - first == pd.Timedelta(minutes=5)
    assert second.utcoffset() == pd.Timedelta(hours=1)


@pytest.mark.parametrize("form", ["%d.%m.%Y %H:%M", "%d.%m.%Y %H:%M:%S", "%a %d/%m/%Y %H:%M:%S", "%Y%m%d%H%M"])
def test_24_h_is_the_end_of_its_day_and_minute_24_is_none(form: str) -> None:
    times = pd.date_range(MIDNIGHT - pd.Timedelta(days=1), periods=1441, freq="min")[1:]
    written = pd.Series(times.strftime(form), name="Time")
    day_before, midnight = (MIDNIGHT - pd.Timedelta(days=1)).strftime(form), MIDNIGHT.strftime(form)
    ends = day_before.replace("00:00", "24:00", 1) if ":" in form else day_before[:8] + "2400"
    assert ends not in (day_before, midnight)
    assert stamps_of(written.replace(midnight, ends), None, "file").equals(times.as_unit("ns"))


@pytest.mark.parametrize("number", [631_152_000_000, 17_680_035_00, 17_680_035_00_123, 17_680_035_00_123_456])
def test_digits_that_are_no_date_are_an_epoch(number: int) -> None:
    column = pd.Series(number + np.arange(5) * 10 ** (len(str(number)) - 10) * 60, name="Time")
    first = pd.Timestamp("2026-01-10 00:05" if number != 631_152_000_000 else "1990-01-01", tz="UTC")
    assert stamps_of(column, None, "file")[0].floor("s") == first


@pytest.mark.parametrize("bad", ["202602301605", "202601319905"])
@pytest.mark.parametrize("kind", [str, np.int64])
def test_one_bad_date_among_digits_is_told_and_makes_no_epoch_of_the_others(bad: str, kind: type) -> None:
    column = pd.Series(["202601311605", "202601311610", bad, "202601311620"], name="Time").astype(kind)
    with pytest.raises(StudyError, match="no date and time"):
        stamps_of(column, None, "file")


@pytest.mark.parametrize("form", ["%y/%m/%d %H:%M", "%y.%m.%d %H:%M", "%d/%m/%y %H:%M", "%d.%m.%y %H:%M"])
def test_years_of_two_digits_are_those_by_which_days_follow_each_other(form: str) -> None:
    times = pd.date_range(AT, periods=30, freq="6h")
    assert stamps_of(pd.Series(times.strftime(form), name="Time"), None, "file").equals(times.as_unit("ns"))
    with pytest.raises(StudyError, match="day, month and year cannot be told apart"):
        stamps_of(pd.Series(times[:1].strftime(form), name="Time"), None, "file")


@pytest.mark.parametrize("address", ["1/1/{}", "1.1.{:02d}", "Raum 1.1.{:02d}"])
def test_addresses_of_a_bus_are_no_dates(address: str) -> None:
    assert not is_stamps(pd.Series([address.format(each) for each in range(10, 14)]))


def test_dates_that_can_be_read_in_two_ways_are_stamps_all_the_same_and_are_refused() -> None:
    column = pd.Series(["01/02/2026 10:00", "02/02/2026 10:00"], name="Date/Time")
    assert is_stamps(column)
    with pytest.raises(StudyError, match="day and month cannot be told apart"):
        stamps_of(column, None, "file")


@pytest.mark.parametrize("written", ["living room 2", "10.5 kW", "Zone 24:00", "a CET", "24:61", "Floor 3/4"])
def test_what_is_no_date_is_no_stamp(written: str) -> None:
    assert not is_stamps(pd.Series([written, written]))


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('{"time": "2026-01-10T00:05:00", "air": 21.0}\n', "it holds JSON"),
        ("temp,room=living air=21.0,out=-5.2 1768003500000000000\n", "it holds InfluxDB's line protocol"),
    ],
)
def test_what_is_no_table_is_told_what_it_is(entry: Entry, text: str, told: str) -> None:
    Path("house.txt").write_text(3 * text)
    done = entry("import", "house.txt", "--out", "record")
    assert done.code == 3
    assert told in done.stderr


def test_names_stand_below_titles_that_have_nearly_as_many_cells(entry: Entry) -> None:
    """As a maker of weather stations exports them: two lines of the place above the table."""
    table = house().to_csv(sep=";")
    Path("titled.csv").write_text('Name;long;lat;ModuleName;ModuleType\n"Home";2.3;48.8;"Outdoor";Outdoor\n\n' + table)
    Path("plain.csv").write_text(table)
    for name in ("titled", "plain"):
        assert entry("import", f"{name}.csv", "--out", name).code == 0
    assert Path("titled/data.csv").read_text() == Path("plain/data.csv").read_text()


@pytest.mark.parametrize(
    "text",
    [
        'time,entity,state\n"Jan 31, 2026 4:05 PM",temp,21.5\n"Jan 31, 2026 4:06 PM",valve,on\n',
        "Time;Valve;Pump\n31-Jan-2026 16:05;on;off;\n31-Jan-2026 16:06;off;off;\n",
        "Time;Valve;Pump\n31-Jan-2026 16:05;on\n31-Jan-2026 16:06;off;off\n31-Jan-2026 16:07;on;on\n",
    ],
)
def test_names_that_rows_are_wider_than_are_no_title(text: str) -> None:
    place, _ = _titles(text.splitlines(), None)
    assert place == 0


@pytest.mark.parametrize(("day", "clock"), [("%d-%b-%Y", "%H:%M"), ("%a %d.%m.%Y", "%H:%M"), ("%d %B %Y", "%I:%M %p")])
def test_a_day_of_any_length_stands_beside_its_time(entry: Entry, day: str, clock: str) -> None:
    table = house()
    times = pd.DatetimeIndex(table.index)
    apart = table.reset_index(drop=True)
    apart.insert(0, "Date", times.strftime(day))
    apart.insert(1, "Clock", times.strftime(clock))
    apart.to_csv("apart.csv", index=False)
    table.to_csv("plain.csv")
    for name in ("apart", "plain"):
        assert entry("import", f"{name}.csv", "--out", name).code == 0
    assert Path("apart/data.csv").read_text() == Path("plain/data.csv").read_text()
