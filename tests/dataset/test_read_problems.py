"""Claims about bad datasets: each is refused with a sentence that says what is wrong, where, and what mends it."""

from __future__ import annotations

import re
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.synthetic.conftest import Simulated, written
from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.read import read_dataset
from waxstudy.study.model import Study
from waxstudy.study.problems import StudyError

Frame = Callable[[pd.DataFrame], pd.DataFrame]


def changed(**columns: Callable[[pd.Series], pd.Series]) -> Frame:
    return lambda data: data.assign(**{name: change(data[name]) for name, change in columns.items()})


def swapped(one: str, other: str) -> Frame:
    return lambda data: data.rename(columns={one: other, other: one})


def fahrenheit(x: pd.Series) -> pd.Series:
    return x * 1.8 + 32.0


def at(row: int, column: str, value: object) -> Frame:
    def change(data: pd.DataFrame) -> pd.DataFrame:
        data = data.astype({column: object})
        data.loc[row, column] = value
        return data

    return change


def stamps(change: Callable[[list[str]], list[str]]) -> Frame:
    return lambda data: data.assign(time=change(list(data["time"])))


def german(times: list[str]) -> list[str]:
    return [f"{s[8:10]}.{s[5:7]}.{s[:4]} {s[11:16]}" for s in times]


# what is done to a good data.csv -> what the message says
DATA: dict[str, tuple[Frame, str]] = {
    "no time": (lambda d: d.drop(columns="time"), r"data\.csv: time: there is no such column"),
    "time under another name": (lambda d: d.rename(columns={"time": "times"}), r"did you mean 'times'\?"),
    "one row": (lambda d: d.head(1), "at least two rows"),
    "no rows": (lambda d: d.head(0), "at least two rows"),
    "a stamp that is none": (at(4, "time", "yesterday"), r'data\.csv:6: time = "yesterday": cannot be read'),
    "a missing stamp": (at(4, "time", None), r"data\.csv:6: time.*: missing"),
    "German stamps without a format": (
        stamps(german),
        r"say \[dataset\] time_format = ",
    ),
    "a stamp of long ago": (at(0, "time", "0001-01-01T00:00:00"), "is not within the years 1900 to 2200"),
    "a stamp of another century": (at(0, "time", "1905-01-01T00:00:00"), r"there are \d+ intervals of 60 s"),
    "numbers for stamps": (lambda d: d.assign(time=range(len(d))), "is a number, not a date and time"),
    "some stamps with an offset": (
        stamps(lambda t: [t[0] + "Z", *t[1:]]),
        r"data\.csv:3: time: some stamps have an offset",
    ),
    "a stamp twice": (stamps(lambda t: [t[1], *t[1:]]), r"data\.csv:3: time: the stamp .* is there twice"),
    "summer time ends": (
        lambda d: d.head(120).assign(
            time=[f"2020-10-25T02:{m:02}" for m in range(60)] + [f"2020-10-25T02:{m:02}" for m in range(60)]
        ),
        "time goes back, from 2020-10-25 02:59:00 to 2020-10-25 02:00:00, as where summer time ends",
    ),
    "nothing but huge numbers": (
        changed(air_temperature_C=lambda x: x * 1e300),
        r"air_temperature_C = .*: 2880 of 2880 cells are no numbers of at most 1e\+12",
    ),
    "time goes back": (lambda d: d.iloc[::-1], r"data\.csv:3: time: time goes back"),
    "another interval": (lambda d: d.iloc[::10], "600 s and more from each other, but interval_s = 60"),
    "no channel": (lambda d: d[["time"]].assign(x=1.0), "has no channel"),
    "empty channels": (lambda d: d[["time"]].assign(flow_L_h=np.nan), "flow_L_h: holds no value at all"),
    "words for numbers": (
        changed(air_temperature_C=lambda x: x.astype(str).str.replace(".", ",")),
        r'data\.csv:2: air_temperature_C = "[\d,]+": .* cells are no numbers',
    ),
    "kelvins": (changed(air_temperature_C=lambda x: x + 273.15), r"looks like kelvins.*offset = -273\.15"),
    "Fahrenheit": (changed(operative_temperature_C=fahrenheit), r"looks like degrees Fahrenheit.*scale = 0\.5556"),
    "Fahrenheit of water": (changed(supply_temperature_C=fahrenheit), "supply_temperature_C: .* Fahrenheit"),
    "tenths of a degree": (changed(air_temperature_C=lambda x: x * 10.0), "tenths of a degree"),
    "hundredths of a degree": (changed(outdoor_temperature_C=lambda x: 100.0 * (x + 15.0)), "hundredths of a degree"),
    "per cent": (changed(displacement=lambda x: x * 100.0), r"displacement: .* per cent .*scale = 0\.01"),
    "millimetres": (changed(displacement=lambda x: x * 4.0), r"stroke in mm .*scale = 0\.25"),
    "volts": (changed(control_output=lambda x: x * 10.0), r"control_output: .* 0 to 10 V .*scale = 0\.1"),
    "a level far below 0": (changed(displacement=lambda x: x - 1.0), "displacement: goes down to -1"),
    "a motor that is open without current": (
        changed(heating_signal=lambda x: 1.0 - x),
        "heating_signal: is turned: displacement is low where heating_signal has long been high.*scale = -1",
    ),
    "a pin that is out when the valve is closed": (
        changed(displacement=lambda x: 1.0 - x),
        "displacement: is turned: displacement is low where heating_signal",
    ),
    "a stroke with an offset": (
        changed(displacement=lambda x: x - 0.25),
        r"displacement: reaches from -0.25 to 0.75, .*scale = 1, offset = 0.25 }",
    ),
    "a footer": (
        lambda d: pd.concat([stamps(german)(d), pd.DataFrame({"time": ["Max. Wert"]})]),
        r'time_format = "%d.%m.%Y %H:%M"',
    ),
    "a mark of thousands": (
        changed(solar_gain_W=lambda x: (x + 2000.0).map("{:,.1f}".format)),
        r'solar_gain_W = "2,\d{3}\.\d": .* without a mark of thousands',
    ),
    "American stamps": (
        stamps(lambda t: [f"{s[5:7]}/{int(s[8:10]) + 14}/{s[:4]} {s[11:16]}" for s in t]),
        r'time_format = "%m/%d/%Y %H:%M"',
    ),
    "m3/h": (changed(flow_L_h=lambda x: x / 1000.0), r"flow_L_h: .* looks like m3/h .*scale = 1000"),
    "L/min": (changed(flow_L_h=lambda x: x / 60.0), r"flow_L_h: .* looks like L/min .*scale = 60"),
    "L/s": (changed(flow_L_h=lambda x: x / 3600.0), r"flow_L_h: .* looks like L/s .*scale = 3600"),
    "negative gains": (changed(internal_gain_W=lambda x: -x), "internal_gain_W: is negative in 100 %"),
    "room for outdoors": (swapped("air_temperature_C", "outdoor_temperature_C"), "is it an outdoor temperature"),
    "the outdoor temperature twice": (
        lambda d: d.assign(air_temperature_C=d["outdoor_temperature_C"] + 12.0).assign(
            outdoor_temperature_C=d["outdoor_temperature_C"] + 12.0
        ),
        "is the same as outdoor_temperature_C",
    ),
    "supply for return": (swapped("supply_temperature_C", "return_temperature_C"), "the return is warmer while water"),
    "flow for opening": (swapped("flow_L_h", "displacement"), "displacement: goes up to .* are columns swapped"),
    "room for setpoint": (swapped("sensor_temperature_C", "setpoint_C"), "the setpoint moves all the time"),
    "room for supply": (swapped("operative_temperature_C", "supply_temperature_C"), "warmer than the water"),
    "ventilation for outdoors": (
        swapped("ventilation_supply_temperature_C", "outdoor_temperature_C"),
        "look swapped: outdoors it is warm and even",
    ),
    "room for ventilation": (
        swapped("air_temperature_C", "ventilation_supply_temperature_C"),
        "the sensor follows ventilation_supply_temperature_C and not the air",
    ),
    "signal for temperature": (
        swapped("heating_signal", "air_temperature_C"),
        "lies between 0 and 1",
    ),
    "sun for people": (swapped("solar_gain_W", "internal_gain_W"), "the first is there at night, the second never"),
    "signal for opening": (
        swapped("heating_signal", "displacement"),
        "look swapped: the opening is",
    ),
    "stamps for values": (swapped("time", "air_temperature_C"), "time = .*: is a number, not a date and time"),
}

CURVE_THAT_FALLS = (
    '[nominal.actuator]\nuse = "ideal"\n[nominal.valve]\nuse = "quick-opening"\nh_min = 0.9\nh_mid = 0.3\n'
)

# what is done to a good dataset.toml -> what the message says, with its place
DESCRIPTION: dict[str, tuple[tuple[str, str], str]] = {
    "an unknown block": (('use = "on-off"', 'use = "onoff"'), r"\[nominal\] controller.use = .*did you mean 'on-off'"),
    "a parameter out of bounds": (
        ("[nominal.controller]", '[nominal.sensor]\nuse = "delay"\ndelay_s = -5.0\n[nominal.controller]'),
        r"\[nominal\] sensor.delay_s = -5.0: must be at least 0",
    ),
    "two parameters that contradict each other": (
        ('[nominal.valve]\nuse = "linear"\n', CURVE_THAT_FALLS),
        r"\[nominal\] valve: h_min < h_mid < h_max is needed",
    ),
    "a misspelled kind": (("[nominal.controller]", "[nominal.contoller]"), "did you mean 'controller'"),
    "a setpoint beyond its bounds": (
        ("setpoint_C = 21.0", "setpoint_C = 210.0"),
        "must be at most 40",
    ),
    "an interval of nothing": (("interval_s = 60", "interval_s = 0"), r"\[dataset\] interval_s = 0: must be at least"),
    "an input that is no channel": (
        ('"solar_gain_W"', '"solar_gain"'),
        "'solar_gain' is no channel; did you mean",
    ),
    "noise that is none": (("displacement = 0.01", "displacement = -0.01"), r"\[noise\] displacement = -0.01: must be"),
    "noise of no channel": (("displacement = 0.01", "displacment = 0.01"), r"\[noise\] displacment: unknown key"),
    "a room that cannot be": (("height_m = 2.6", "height_m = 1.6"), r"\[room\]: .*are together more than height_m"),
    "a data file that is not there": (
        ("interval_s = 60", 'interval_s = 60\nfile = "no.csv"'),
        "no such file",
    ),
    "a column that is not there": (
        ("[noise]", '[columns]\nflow_L_h = "flow"\n[noise]'),
        r"flow_L_h: there is no column 'flow'; did you mean 'flow_L_h'",
    ),
    "a mapping of no channel": (("[noise]", '[columns]\nflow = "flow_L_h"\n[noise]'), r"\[columns\] flow: unknown key"),
    "a mapping of nothing": (
        ("[noise]", "[columns]\nflow_L_h = { scale = 2.0 }\n[noise]"),
        "give one of column, mean",
    ),
    "a mapping beyond all units": (
        ("[noise]", '[columns]\nflow_L_h = { column = "flow_L_h", scale = 1e300 }\n[noise]'),
        r"\[columns\] flow_L_h.scale = 1e\+300: must be at most 1",
    ),
    "a mapping to nothing": (
        ("[noise]", '[columns]\nflow_L_h = { column = "flow_L_h", scale = 0.0 }\n[noise]'),
        "a scale of 0 leaves nothing",
    ),
    "room and building": (
        ("[noise]", "[building]\nheight_m = 2.6\n[noise]"),
        "there is .room. already",
    ),
    "no TOML": (("[noise]", "[noise"), "not valid TOML"),
}


@pytest.fixture
def good(folder: Path, study: Study, simulated: Simulated) -> Path:
    return written(folder, study, simulated, "O_WM", "O_CP")


def said(folder: Path) -> str:
    with pytest.raises(StudyError) as error:
        read_dataset(folder)
    return str(error.value).replace(f"{folder}/", "")


def test_the_dataset_that_is_spoilt_below_is_good(good: Path) -> None:
    assert read_dataset(good).warnings == ()


@pytest.mark.parametrize("what", DATA)
def test_bad_data_is_refused_with_a_reason(what: str, good: Path) -> None:
    change, reason = DATA[what]
    data = change(pd.read_csv(good / "data.csv"))
    data.to_csv(good / "data.csv", index=False)
    assert re.search(reason, said(good))


@pytest.mark.parametrize("what", DESCRIPTION)
def test_a_bad_description_is_refused_at_its_line(what: str, good: Path) -> None:
    (old, new), reason = DESCRIPTION[what]
    path = good / "dataset.toml"
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    message = said(good)
    assert re.search(reason, message)
    assert re.match(r"(dataset\.toml:\d+|data\.csv)", message)


def test_signal_and_opening_that_are_swapped_are_seen_in_samples_of_five_minutes(good: Path) -> None:
    description = (good / "dataset.toml").read_text(encoding="utf-8")
    (good / "dataset.toml").write_text(description.replace("interval_s = 60", "interval_s = 300"), encoding="utf-8")
    data = swapped("heating_signal", "displacement")(pd.read_csv(good / "data.csv").iloc[4::5])
    data.to_csv(good / "data.csv", index=False)
    assert "heating_signal, displacement: look swapped" in said(good)


def test_all_problems_are_told_at_once(good: Path) -> None:
    data = pd.read_csv(good / "data.csv")
    changed(air_temperature_C=fahrenheit, displacement=lambda x: x * 100.0)(data).to_csv(good / "data.csv", index=False)
    assert len(said(good).splitlines()) == 2


def test_data_and_description_are_told_together(good: Path) -> None:
    changed(air_temperature_C=fahrenheit)(pd.read_csv(good / "data.csv")).to_csv(good / "data.csv", index=False)
    path = good / "dataset.toml"
    path.write_text(path.read_text(encoding="utf-8").replace('"on-off"', '"onoff"'), encoding="utf-8")
    message = said(good)
    assert "did you mean 'on-off'" in message
    assert "Fahrenheit" in message


CELLS = st.sampled_from(
    ["", "0", "1", "21.5", "-999", "1e9", "inf", "x", "on", "2020-01-01T00:01:00", "300", "-5", "0.5"]
)
NAMES = st.sampled_from(["time", *CHANNELS])


@settings(max_examples=150)
@given(
    header=st.lists(NAMES, min_size=1, max_size=6),
    rows=st.lists(st.lists(CELLS, min_size=6, max_size=6), max_size=30),
    has_stamps=st.booleans(),
)
def test_whatever_the_data_they_are_read_or_refused(header: list[str], rows: list[list[str]], has_stamps: bool) -> None:
    names = ["time", *(name for name in dict.fromkeys(header) if name != "time")] if has_stamps else header
    lines = [",".join(names)]
    for minute, row in enumerate(rows):
        cells = [f"2020-01-01T00:{minute:02}:00", *row] if has_stamps else row
        lines.append(",".join(cells[: len(names)]))
    with TemporaryDirectory() as place:
        (Path(place) / "data.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
        (Path(place) / "dataset.toml").write_text("[nominal]\n", encoding="utf-8")
        with suppress(StudyError):
            assert len(read_dataset(Path(place)).values.columns) > 0


def test_a_folder_without_its_files_is_refused(tmp_path: Path, good: Path) -> None:
    assert "no such file" in said(tmp_path / "nothing")
    (good / "data.csv").unlink()
    assert "there is no data.csv or data.parquet" in said(good)


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is empty"),
        (b"\x00\x01\x02", "no channel|no such column"),
        (b"time,flow_L_h\n2020-01-01T00:00,1,2\n2020-01-01T00:01,1,2\n", "more cells than the header"),
        (b"time,flow_L_h\n2020-01-01T00:00,1\n2020-01-01T00:01,1,2\n", "data.csv:3: .*no table"),
        (b"time,flow_L_h,flow_L_h\n2020-01-01T00:00,1,2\n", "data.csv:1: flow_L_h: there are two columns"),
        (b"PK\x03\x04 sheet1.xml", "data.csv: is no text: export it as CSV"),
        (b"PAR1 and then nothing", "data.csv: is no whole parquet file"),
        (b"time,flow_L_h\n2020-01-01T00:00,\x9d\n", "data.csv: is neither text in UTF-8 nor"),
    ],
)
def test_a_file_that_is_no_table_is_refused(content: bytes, reason: str, good: Path) -> None:
    (good / "data.csv").write_bytes(content)
    assert re.search(reason, said(good))
