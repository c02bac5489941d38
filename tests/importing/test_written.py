"""Claims about how cells are written: marks of thousands, states in words, and zones in the name of a column."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.cli.conftest import Entry
from tests.importing.test_bad_input import house, imported
from waxstudy.importing.stamps import stamps_of
from waxstudy.importing.words import numbers_of

MARKS = [(",", "."), (".", ","), ("'", "."), ("\u2019", "."), (" ", ","), ("\u00a0", ","), ("\u202f", ",")]


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
