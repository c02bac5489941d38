"""Claims about clocks: where the sun stands, and what stamps with an offset from UTC are."""

from __future__ import annotations

from datetime import timedelta
from pathlib import Path
from zoneinfo import ZoneInfo

import numpy as np
import pandas as pd
import pytest

from waxstudy import Dataset
from waxstudy.dataset.read import read_dataset
from waxstudy.dataset.sunlight import _sky
from waxstudy.dataset.zones import standard_ahead

HEAD = '[dataset]\ninterval_s = 300\n{about}\n[nominal]\n[site]\n{site}\n'  # fmt: skip
ROWS = 5 * 288


def record(folder: Path, times: pd.DatetimeIndex | list[str], site: str, about: str = "") -> Path:
    """Write a record of a room's air whose stamps are written as they are given."""
    air_C = 21.0 + np.random.default_rng(1).normal(0.0, 0.1, len(times))
    (folder / "dataset.toml").write_text(HEAD.format(about=about, site=site))
    pd.DataFrame({"time": times, "air_temperature_C": air_C}).to_csv(folder / "data.csv", index=False)
    return folder


def every_5_min(begin: str, zone: str | None = None) -> pd.DatetimeIndex:
    return pd.date_range(begin, periods=ROWS, freq="5min", tz=zone)


def noon_h(read: Dataset) -> float:
    """The hour of the day, by the record's clock, at which the sun of its first whole day is highest."""
    assert read.site
    sky = _sky(read.time, read.interval_s, read.site)
    day = np.flatnonzero(read.time.normalize() == read.time[0].normalize() + pd.Timedelta(days=1))
    highest = read.time[day[np.argmax(sky.global_W_m2[day])]]
    return float((highest - highest.normalize()) / pd.Timedelta(hours=1))


def solar_noon_h(longitude: float, ahead_h: float) -> float:
    """Noon of the mean sun; the true one is up to 16 minutes off."""
    return 12.0 + ahead_h - longitude / 15.0


@pytest.mark.parametrize(
    ("zone", "at", "ahead_h"),
    [
        ("Europe/Tallinn", "2024-07-01", 2.0),
        ("Europe/Istanbul", "2024-07-01", 3.0),  # until 2016 it was 2
        ("Europe/Istanbul", "2010-07-01", 2.0),
        ("Europe/Minsk", "2024-01-10", 3.0),
        ("Europe/Dublin", "2024-01-10", 0.0),  # where summer is said to be the standard
        ("Europe/Dublin", "2024-07-01", 0.0),
        ("Asia/Kolkata", "2024-07-01", 5.5),
    ],
)
def test_standard_time_is_that_of_the_record_s_year(zone: str, at: str, ahead_h: float) -> None:
    assert standard_ahead(ZoneInfo(zone), pd.Timestamp(at).to_pydatetime()) == timedelta(hours=ahead_h)


def test_the_sun_goes_by_the_zone_of_the_record_s_year(tmp_path: Path) -> None:
    site = 'latitude = 41.0\nlongitude = 29.0\ntimezone = "Europe/Istanbul"'
    read = read_dataset(record(tmp_path, every_5_min("2024-01-10 00:05", "Etc/GMT-3"), site))
    assert noon_h(read) == pytest.approx(solar_noon_h(29.0, 3.0), abs=0.3)


def test_the_sun_goes_by_the_offset_of_stamps_where_no_zone_is_stated(tmp_path: Path) -> None:
    read = read_dataset(
        record(tmp_path, every_5_min("2024-01-10 00:05", "Europe/Madrid"), "latitude = 40.4\nlongitude = -3.7")
    )
    assert read.time[0] == pd.Timestamp("2024-01-10 00:05")
    assert noon_h(read) == pytest.approx(solar_noon_h(-3.7, 1.0), abs=0.3)


def test_a_record_in_summer_time_alone_is_kept_in_the_standard_time_of_its_zone(tmp_path: Path) -> None:
    site = 'latitude = 59.4\nlongitude = 24.7\ntimezone = "Europe/Tallinn"'
    read = read_dataset(record(tmp_path, every_5_min("2024-09-10 00:05", "Europe/Tallinn"), site))
    assert read.time[0] == pd.Timestamp("2024-09-09 23:05")
    assert "standard time of Europe/Tallinn, UTC+2 h" in " ".join(read.assumptions)
    assert noon_h(read) == pytest.approx(solar_noon_h(24.7, 2.0), abs=0.3)


def test_a_parquet_file_in_utc_is_kept_in_the_standard_time_of_the_site(tmp_path: Path) -> None:
    site = 'latitude = 59.4\nlongitude = 24.7\ntimezone = "Europe/Tallinn"'
    times = every_5_min("2024-07-10 00:05", "UTC")
    record(tmp_path, times, site)
    (tmp_path / "data.csv").unlink()
    pd.DataFrame({"time": times, "air_temperature_C": np.linspace(20.0, 22.0, ROWS)}).to_parquet(
        tmp_path / "data.parquet"
    )
    assert read_dataset(tmp_path).time[0] == pd.Timestamp("2024-07-10 02:05")


def test_a_date_at_the_end_of_a_stamp_is_no_offset(tmp_path: Path) -> None:
    times = every_5_min("2024-01-10 00:05")
    folder = record(tmp_path, list(times.strftime("%H:%M %d-%m-%Y")), "latitude = 50", 'time_format = "%H:%M %d-%m-%Y"')
    read = read_dataset(folder)
    assert read.time[0] == times[0]
    assert not any("UTC" in each for each in read.assumptions)


@pytest.mark.parametrize(("end", "form"), [("Z", "Z"), ("+02:00", "+02:00"), ("+0200", "%z")])
def test_an_offset_that_a_format_states_counts(tmp_path: Path, end: str, form: str) -> None:
    stamps = list(every_5_min("2024-01-10 00:05").strftime("%d.%m.%Y %H:%M:%S") + end)
    site = 'latitude = 59.4\nlongitude = 24.7\ntimezone = "Europe/Tallinn"'
    read = read_dataset(record(tmp_path, stamps, site, f'time_format = "%d.%m.%Y %H:%M:%S{form}"'))
    assert read.time[0] == pd.Timestamp("2024-01-10 02:05" if end == "Z" else "2024-01-10 00:05")


def test_a_frame_in_summer_time_alone_is_kept_in_the_standard_time_of_its_site() -> None:
    times = pd.date_range("2024-09-10 00:05", periods=ROWS, freq="5min", tz="UTC")
    site = {"latitude": 59.4, "longitude": 24.7, "timezone": "Europe/Tallinn"}
    for zone in ("Etc/GMT-3", "UTC"):
        frame = pd.DataFrame({"air_temperature_C": np.linspace(20.0, 22.0, ROWS)}, index=times.tz_convert(zone))
        assert Dataset.from_frame(frame, believed={}, site=site).time[0] == pd.Timestamp("2024-09-10 02:05")


def test_a_frame_s_zone_is_that_of_its_site() -> None:
    times = every_5_min("2024-01-10 00:05", "Europe/Paris")
    frame = pd.DataFrame({"air_temperature_C": np.linspace(20.0, 22.0, ROWS)}, index=times)
    read = Dataset.from_frame(frame, believed={}, site={"latitude": 48.9, "longitude": 2.3})
    assert noon_h(read) == pytest.approx(solar_noon_h(2.3, 1.0), abs=0.3)
