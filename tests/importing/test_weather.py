"""Claims about what drives a room and was not recorded: weather files, light, panels; from import to diagnosis."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.cli.conftest import Ended, Entry
from tests.importing.conftest import read
from tests.importing.test_bad_input import house, imported, refused
from waxstudy.dataset.channels import DIFFUSE, GLOBAL, PANELS
from waxstudy.dataset.read import read_dataset
from waxstudy.dataset.stand_ins import GAINS, SUN
from waxstudy.diagnosis.diagnose import record_of

ZONE = ("--timezone", "Europe/Tallinn")
BELIEVE = ("--set", "floor_area_m2=18", "--set", "outer_walls=south,west", "--set", "year=2012", "--yes")


def weather_file(
    start: str = "2026-01-01",
    days: int = 20,
    source: str = "SRC-TMYx",
    year: int | None = None,
    folder: Path = Path(),
) -> str:
    """Write hours of a plain winter as an EPW file; return its name."""
    ends = pd.date_range(start, periods=24 * days, freq="h")
    hour = ends.hour.to_numpy()
    light = np.clip(400.0 * np.sin(np.pi * (hour - 8.0) / 8.0), 0.0, None)
    head = [f"LOCATION,Tallinn,-,EST,{source},260380,59.41,24.83,2.0,34.0", *(f"{n}" for n in range(4))]
    lines = [*head, "COMMENTS 1,measured", "COMMENTS 2,", "DATA PERIODS,1,1,Data"]
    for n, end in enumerate(ends):
        values = [9999] * 30
        values[0:5] = [year or end.year, end.month, end.day, end.hour + 1, 60]
        values[6], values[13], values[15] = round(-3.0 - n / 100.0, 1), round(light[n]), round(0.4 * light[n])
        lines.append(",".join(map(str, values)))
    (folder / "tallinn.epw").write_text("\n".join(lines) + "\n")
    return "tallinn.epw"


def with_weather(entry: Entry, weather: str, *options: str) -> Ended:
    house().drop(columns="outdoor_temperature").to_csv("house.csv")
    return entry("import", "house.csv", weather, *ZONE, *options, "--out", "living")


def test_measured_weather_of_those_days_gives_the_outdoor_temperature_and_the_light(entry: Entry) -> None:
    done = with_weather(entry, weather_file(source="Actual"))
    assert done.code == 0, done.stderr
    found = read(Path("living"))
    assert {"outdoor_temperature_C", GLOBAL, DIFFUSE} < set(found)
    # the tenth day, from 11 to 12 h: the mean of the hour that ends there, in every sample of it
    noon = found.loc["2026-01-11 11:05":"2026-01-11 12:00", GLOBAL]  # type: ignore[misc]
    assert set(noon) == {round(400.0 * np.sin(np.pi * 3.0 / 8.0))}
    about = tomllib.loads(Path("living/dataset.toml").read_text())
    assert about["site"] == {"latitude": 59.41, "longitude": 24.83, "altitude": 34.0, "timezone": "Europe/Tallinn"}
    assert about["dataset"]["inputs"] == {GAINS: 0.7, SUN: 0.12}


def test_weather_of_later_days_makes_no_record_longer(entry: Entry) -> None:
    """The valve is logged when it changes: it rests as long as the house logs anything, not as its weather goes on."""
    frame = house()
    readings = frame.drop(columns=["outdoor_temperature", "flow_L_h"]).stack().rename_axis(["time", "name"])
    long = readings.rename("value").reset_index()
    changes = long["name"].ne("heating_valve") | long.groupby("name")["value"].diff().ne(0.0)
    long[changes].to_csv("house.csv", index=False)
    assert entry("import", "house.csv", weather_file(source="Actual"), *ZONE, "--out", "living").code == 0
    assert read(Path("living")).index[-1] == frame.index[-1]


def test_a_repeated_import_keeps_the_site_that_somebody_wrote(entry: Entry) -> None:
    assert with_weather(entry, weather_file(source="Actual")).code == 0
    path = Path("living/dataset.toml")
    path.write_text(path.read_text().replace("24.83", "25.5"))
    assert with_weather(entry, "tallinn.epw").code == 0
    assert tomllib.loads(path.read_text())["site"]["longitude"] == 25.5
    assert path.read_text().count("[site]") == 1


def test_the_house_s_own_outdoor_temperature_is_taken_before_that_of_a_weather_station(entry: Entry) -> None:
    house().to_csv("house.csv")
    assert entry("import", "house.csv", weather_file(source="Actual"), *ZONE, "--out", "living").code == 0
    channels = tomllib.loads(Path("living/dataset.toml").read_text())["import"]["channels"]
    assert channels["outdoor_temperature_C"]["entity"] == "outdoor_temperature"
    assert channels[GLOBAL]["source"] == "tallinn.epw"


@pytest.mark.parametrize(
    ("of", "words"),
    [
        ({"source": "SRC-TMYx"}, ("tallinn.epw:1", "'TMYx'", "a typical year is not the weather", "measured weather")),
        ({"source": "IWEC Data"}, ("'IWEC'", "a typical year is not the weather")),
        ({"source": "Actual", "start": "2019-01-01"}, ("weather of 2019-01-01 to 2019-01-21", "2026-01-10")),
        # months of several years, which do not follow each other
        ({"source": "?", "start": "2025-12-20", "year": 2026}, ("a typical year is not the weather",)),
    ],
)
def test_weather_that_the_record_did_not_have_is_refused_with_the_reason(
    entry: Entry, of: dict[str, str], words: tuple[str, ...]
) -> None:
    refused(with_weather(entry, weather_file(**of)), *words)  # type: ignore[arg-type]


def test_a_weather_file_that_is_cut_off_is_refused(entry: Entry) -> None:
    whole = Path(weather_file(source="Actual"))
    whole.write_text(whole.read_text()[:-120])
    refused(with_weather(entry, "tallinn.epw"), "tallinn.epw", "no whole weather file")


def test_a_thermometer_that_never_had_a_value_is_told(entry: Entry) -> None:
    lost = house().assign(outdoor_temperature="unavailable")
    refused(imported(entry, lost), "no outdoor temperature", "no reading of outdoor_temperature is a value")
    done = imported(entry, lost, "--map", "outdoor_temperature_C=")
    assert "not used, because no reading is a value: outdoor_temperature" in done.stderr


def test_a_record_without_outdoor_temperature_is_told_of_weather_files(entry: Entry) -> None:
    refused(
        imported(entry, house().drop(columns="outdoor_temperature")), "no outdoor temperature", "weather file (EPW)"
    )


@pytest.mark.parametrize(("column", "channel", "spread"), [("ghi [W/m2]", GLOBAL, 0.2), ("pv_power [kW]", PANELS, 0.3)])
def test_light_becomes_the_sun_of_the_believed_room_and_stays_uncertain(
    entry: Entry, column: str, channel: str, spread: float
) -> None:
    frame = house()
    hour = frame.index.hour.to_numpy()
    day = np.clip(np.sin(np.pi * (hour - 8.0) / 8.0), 0.0, None)
    frame[column] = (day if "kW" in column else 300.0 * day).round(3)
    assert imported(entry, frame).code == 0
    assert tomllib.loads(Path("living/dataset.toml").read_text())["dataset"]["inputs"] == {GAINS: 0.7, SUN: spread}
    told = entry("believe", "living", *BELIEVE)
    assert "panels_peak_W" in told.stderr or "latitude and longitude" in told.stderr
    done = entry("believe", "living", "--set", "place=59.4, 24.8", "--set", "panels=5000, 35, 180", *BELIEVE[-1:])
    if channel == GLOBAL:  # nobody is asked for panels that are not there
        assert done.code != 0
        done = entry("believe", "living", "--set", "place=59.4, 24.8", *BELIEVE[-1:])
    assert done.code == 0, done.stderr
    assert "is not used" not in done.stderr
    found = record_of(read_dataset(Path("living"))).stand_ins
    assert found[SUN].factor_sd == spread
    assert 20.0 < found[SUN].values.max() < 2000.0
    assert set(found) == {SUN, GAINS}
