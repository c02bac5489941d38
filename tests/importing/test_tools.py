"""Claims about what tools write that people have: each of their exports makes the record that was logged."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.cli.conftest import Entry
from tests.importing.conftest import read
from tests.importing.exports import CHANNELS
from tests.importing.test_bad_input import house, refused
from waxstudy.importing.headers import parted
from waxstudy.importing.sources import log_reader

ZONE = ("--timezone", "Europe/Tallinn")
FLOW = "flow_L_h"
TEMPERATURES = tuple(name for name in CHANNELS if name.endswith("_C"))
NAMES = ("living_temperature", "living_setpoint", "heating_valve", "flow", "supply", "return", "outdoor")
SHORT = dict(zip(CHANNELS, NAMES, strict=True))
SHORT_OF = {name: channel for channel, name in SHORT.items()}
Maker = Callable[[pd.DataFrame, Path], tuple[Path, tuple[str, ...]]]


def lines(record: pd.DataFrame) -> Iterator[tuple[pd.Timestamp, pd.Series]]:
    for place in range(len(record)):
        yield pd.Timestamp(record.index[place]), record.iloc[place]


def written(path: Path, *texts: str) -> Path:
    path.write_text("\n".join(texts) + "\n", encoding="utf-8")
    return path


def fhem(record: pd.DataFrame, folder: Path) -> tuple[Path, tuple[str, ...]]:
    """A line for each reading; readings of a thermostat, its valve and others."""
    device = {
        "sensor_temperature_C": "Living temperature",
        "setpoint_C": "Living desired-temp",
        FLOW: "Loop flow",
        "supply_temperature_C": "Loop supply",
        "return_temperature_C": "Loop return",
        "outdoor_temperature_C": "Garden outdoor",
    }
    told = [
        f"{at:%Y-%m-%d_%H:%M:%S} {name}: {row[channel]:.4f}{' °C' if channel in TEMPERATURES else ''}"
        for at, row in lines(record)
        for channel, name in device.items()
    ]
    valve = [
        f"{at:%Y-%m-%d_%H:%M:%S} LivingValve {'on' if row['heating_signal'] else 'off'}" for at, row in lines(record)
    ]
    return written(folder / "living.log", *sorted(told + valve)), ZONE


def niagara(record: pd.DataFrame, folder: Path) -> tuple[Path, tuple[str, ...]]:
    """A file for each point: titles, a status for each reading, and the zone behind its stamp."""
    for channel, name in SHORT.items():
        unit = "°C" if channel in TEMPERATURES else "L/hr" if channel == FLOW else "0-1"
        rows = [f"{at:%d-%b-%y %I:%M:%S %p} EET,{{ }},{{ok}},{row[channel]:.4f}" for at, row in lines(record)]
        written(
            folder / f"{name}.csv", f"history:/House/{name}", "", f"Timestamp,Trend Flags,Status,Value ({unit})", *rows
        )
    return folder, ZONE


def metasys(record: pd.DataFrame, folder: Path) -> tuple[Path, tuple[str, ...]]:
    """A row for each reading, with two columns of names, a unit behind the value and a word for how good it is."""
    points = dict(zip(CHANNELS, ("LIVING-T", "LIVING-SP", "VALVE", "FLOW", "HWS-T", "HWR-T", "OAT"), strict=True))
    rows = [
        f'"{at:%m/%d/%Y %I:%M:%S %p}","NAE1/FC1.{name}","{name}","{row[channel]:.4f}'
        f'{" deg C" if channel in TEMPERATURES else " L/h" if channel == FLOW else ""}","Reliable"'
        for at, row in lines(record)
        for channel, name in points.items()
    ]
    head = '"Date / Time","Name Path Reference","Object Name","Object Value","Reliability"'
    return written(folder / "trend.csv", head, *rows), (*ZONE, "--time-format", "%m/%d/%Y %I:%M:%S %p")


def iobroker(record: pd.DataFrame, folder: Path) -> tuple[Path, tuple[str, ...]]:
    """A file for each state, whose name has points; epochs in milliseconds."""
    for channel, name in SHORT.items():
        rows = [f"{(at.value // 1_000_000) - 7_200_000},{row[channel]:.4f},true,0" for at, row in lines(record)]
        written(folder / f"zigbee.0.{name}.csv", "ts,val,ack,q", *rows)
    return folder, ZONE


def emoncms(record: pd.DataFrame, folder: Path) -> tuple[Path, tuple[str, ...]]:
    """A file for each feed: an epoch and a value, and nothing above them."""
    for channel, name in SHORT.items():
        rows = [f"{(at.value // 1_000_000_000) - 7200},{row[channel]:.4f}" for at, row in lines(record)]
        written(folder / f"{name}.csv", *rows)
    return folder, ZONE


def thingsboard(record: pd.DataFrame, folder: Path) -> tuple[Path, tuple[str, ...]]:
    """A row for each device and stamp, with a column for each thing that it measures."""
    devices = {
        "Living": {"temperature": "sensor_temperature_C", "setpoint": "setpoint_C", "valve": "heating_signal"},
        "Loop": {"flow": FLOW, "supply": "supply_temperature_C", "return": "return_temperature_C"},
        "Outdoor": {"temperature": "outdoor_temperature_C"},
    }
    keys = list(dict.fromkeys(key for has in devices.values() for key in has))
    rows = [
        f"{at:%Y-%m-%d %H:%M:%S};{device};" + ";".join(f"{row[has[key]]:.4f}" if key in has else "" for key in keys)
        for at, row in lines(record)
        for device, has in devices.items()
    ]
    return written(folder / "telemetry.csv", f"Timestamp;Entity name;{';'.join(keys)}", *rows), ZONE


def hobo(record: pd.DataFrame, folder: Path) -> tuple[Path, tuple[str, ...]]:
    """Units behind a comma, and in brackets the logger, the sensor and its label."""
    units = {channel: "°C" if channel in TEMPERATURES else "L/h" if channel == FLOW else "%" for channel in CHANNELS}
    names = [
        f'"Ch{place}, {units[channel]} (LGR S/N: 12, SEN S/N: {place}, LBL: {name})"'
        for place, (channel, name) in enumerate(SHORT.items())
    ]
    rows = [
        f"{place},{at:%m/%d/%y %I:%M:%S %p},"
        + ",".join(f"{row[channel] * (100.0 if units[channel] == '%' else 1.0):.4f}" for channel in CHANNELS)
        for place, (at, row) in enumerate(lines(record), 1)
    ]
    head = f'"#","Date Time, GMT+02:00",{",".join(names)}'
    stated = (*ZONE, "--time-format", "%m/%d/%y %I:%M:%S %p")
    return written(folder / "hobo.csv", '"Plot Title: house"', head, *rows), stated


def energyplus(record: pd.DataFrame, folder: Path) -> tuple[Path, tuple[str, ...]]:
    """Days without a year, which end at 24:00:00, and a mass of water for its volume."""
    names = [
        "LIVING:Zone Air Temperature [C](TimeStep)",
        "LIVING:Zone Thermostat Heating Setpoint Temperature [C](TimeStep)",
        "VALVE:Schedule Value [](TimeStep)",
        "WATER INLET NODE:System Node Mass Flow Rate [kg/s](TimeStep)",
        "WATER INLET NODE:System Node Temperature [C](TimeStep)",
        "WATER OUTLET NODE:System Node Temperature [C](TimeStep)",
        "Environment:Site Outdoor Air Drybulb Temperature [C](TimeStep)",
    ]
    rows = []
    for at, row in lines(record):
        day = at - pd.Timedelta(minutes=1) if at == at.normalize() else at
        clock = "24:00:00" if at == at.normalize() else f"{at:%H:%M:%S}"
        values = (row[channel] / (3600.0 if channel == FLOW else 1.0) for channel in CHANNELS)
        rows.append(f" {day:%m/%d}  {clock}," + ",".join(f"{value:.8f}" for value in values))
    stated = ("--begin", f"{record.index[0]:%Y-%m-%d}", "--map", "sensor_temperature_C=LIVING:Zone Air Temperature")
    return written(folder / "eplusout.csv", "Date/Time," + ",".join(names), *rows), (
        *stated, "--map", "heating_signal=VALVE:Schedule Value"
    )  # fmt: skip


def modelica(record: pd.DataFrame, folder: Path) -> tuple[Path, tuple[str, ...]]:
    """Seconds since the simulation began."""
    begin = record.index[0] - pd.Timedelta(minutes=1)
    rows = [
        f"{(at - begin).total_seconds():g}," + ",".join(f"{row[channel]:.4f}" for channel in CHANNELS)
        for at, row in lines(record)
    ]
    head = ",".join(["time", *(f'"{name}"' for name in SHORT.values())])
    return written(folder / "room.csv", head, *rows), ("--begin", begin.isoformat())


def ida_ice(record: pd.DataFrame, folder: Path) -> tuple[Path, tuple[str, ...]]:
    """Hours since the begin, in columns that blanks part, their names behind a `#`."""
    begin = record.index[0].normalize()
    rows = [
        f"{(at - begin) / pd.Timedelta(1, 'h'):16.6f}" + "".join(f"{row[channel]:20.6f}" for channel in CHANNELS)
        for at, row in lines(record)
    ]
    head = f"#{'time':>15}" + "".join(f"{name:>20}" for name in NAMES)
    return written(folder / "room.prn", head, *rows), ("--begin", f"{begin:%Y-%m-%d}", "--time-format", "h")


def mqtt(record: pd.DataFrame, folder: Path) -> tuple[Path, tuple[str, ...]]:
    """A line for each message: an object with the readings of a thermostat, one within another, and plain values."""
    rows = []
    for at, row in lines(record):
        readings = {"Time": f"{at:%H:%M}", "Living": {"Temperature": round(row["sensor_temperature_C"], 4)}}
        thermostat = {**readings, "desired": round(row["setpoint_C"], 4), "battery_low": False, "days": [1, 2]}
        messages = {
            "house/living/thermostat": json.dumps(thermostat),
            "house/living/valve": "ON" if row["heating_signal"] else "OFF",
            "house/loop": json.dumps({name: round(row[SHORT_OF[name]], 4) for name in ("flow", "supply", "return")}),
            "house/garden/outdoor": f"{row['outdoor_temperature_C']:.4f} °C",
        }
        rows += [f"{at:%Y-%m-%dT%H:%M:%S}+0200 {topic} {message}" for topic, message in messages.items()]
    stated = ("--map", "setpoint_C=house/living/thermostat desired")
    return written(folder / "house.log", *rows), (*ZONE, *stated)


MAKERS: list[Maker] = [
    fhem, niagara, metasys, iobroker, emoncms, thingsboard, hobo, energyplus, modelica, ida_ice, mqtt
]  # fmt: skip


@pytest.mark.parametrize("make", MAKERS, ids=lambda make: make.__name__)
def test_what_a_tool_exports_is_the_record_that_it_logged(
    make: Maker, record: pd.DataFrame, entry: Entry, tmp_path: Path
) -> None:
    hours = record.iloc[: 30 * 60]
    folder = tmp_path / "export"
    folder.mkdir()
    source, stated = make(hours, folder)
    done = entry("import", source, *stated, "--yes", "--out", tmp_path / "living")
    assert done.code == 0, done.stderr
    found = read(tmp_path / "living")
    assert set(found) == set(CHANNELS), done.stdout
    assert (found.index[0], found.index[-1]) == (hours.index[0], hours.index[-1])
    for channel in CHANNELS:
        assert found[channel].sub(hours[channel]).abs().max() < 1e-3, channel
        assert found[channel].notna().all(), channel


def messages(frame: pd.DataFrame, topic: str = "house/{}") -> list[str]:
    names = {name: topic.format(name) for name in map(str, frame)}
    return [
        f"{at.timestamp():.3f} {names[name]} {value}" for at, row in frame.iterrows() for name, value in row.items()
    ]


OF_MESSAGES = ("--timezone", "UTC", "--map", "air_temperature_C=house/room_temperature", "--yes", "--out", "living")


def test_messages_may_be_stamped_in_seconds_since_1970(entry: Entry) -> None:
    frame = house()
    written(Path("house.log"), *messages(frame))
    done = entry("import", "house.log", *OF_MESSAGES)
    assert done.code == 0, done.stderr
    assert (read(Path("living"))["outdoor_temperature_C"] - frame["outdoor_temperature"]).abs().max() < 1e-3


NO_MESSAGES = (
    "17680",
    "1768003500.000 house/announce",  # a message that was cleared is empty
    "1768003500.000 house/room 2 21.5",  # of a topic with a blank, or of one without
    "1768003500.000 house/x " + '{"a":' * 5000,
    '1768003500.000 house/x {"a": 21.5',
)


@pytest.mark.parametrize("line", NO_MESSAGES, ids=range(len(NO_MESSAGES)))
def test_a_line_that_is_no_message_is_left_out_and_told(entry: Entry, line: str) -> None:
    frame = house()
    lines = messages(frame)
    written(Path("house.log"), *lines[:500], line, *lines[500:])
    done = entry("import", "house.log", *OF_MESSAGES)
    assert done.code == 0, done.stderr
    told = " ".join(done.stdout.split())
    assert f"house.log: 1 line is no message and left out, the first of them line 501: '{line[:60]}'." in told
    assert (read(Path("living"))["outdoor_temperature_C"] - frame["outdoor_temperature"]).abs().max() < 1e-3


@pytest.mark.parametrize(
    "line",
    [
        '1768003500.000 house/living/config {"name": "x", "expire_after": 3600}',
        '1768003500.000 house/living {"large": ' + 400 * "9" + ', "list": [1, 2], "none": null, "on": NaN}',
        "1768003500.000 2/light on",
        "1768003500.000 house/camera \xff\xd8\x81",
    ],
    ids=range(4),
)
def test_other_messages_change_no_reading(entry: Entry, line: str) -> None:
    """Settings of devices, large numbers, topics that begin with a digit, pictures."""
    frame = house()
    Path("house.log").write_bytes("\n".join([line, *messages(frame)]).encode("latin-1"))
    done = entry("import", "house.log", *OF_MESSAGES)
    assert done.code == 0, done.stderr
    assert (read(Path("living"))["outdoor_temperature_C"] - frame["outdoor_temperature"]).abs().max() < 1e-3


def test_names_that_never_hold_a_number_are_left_out_and_told(entry: Entry) -> None:
    boiler = '1768003500.000 house/boiler {"mode": "eco", "days": [1, 2], "water": "55.0"}'
    written(Path("house.log"), boiler, "1768003501.000 house/tune la", *messages(house()))
    done = entry("import", "house.log", *OF_MESSAGES)
    assert done.code == 0, done.stderr
    told = " ".join(done.stdout.split())
    left_out = "house/boiler mode, house/boiler days, house/tune"
    assert f"house.log: {left_out} never hold a number or a state, and are left out." in told


def test_group_addresses_are_names_although_they_begin_with_a_number(entry: Entry) -> None:
    frame = house()
    columns = dict(zip(frame, ("1/2/3", "1/2/4", "1/2/5", "1/2/6", "1/2/7"), strict=True))
    written(Path("house.log"), *messages(frame.rename(columns=columns), "{}"))
    named = {"air_temperature_C": "1/2/3", "outdoor_temperature_C": "1/2/7", "supply_temperature_C": "1/2/6"}
    stated = [word for channel, name in named.items() for word in ("--map", f"{channel}={name}")]
    done = entry("import", "house.log", "--timezone", "UTC", "--yes", "--out", "living", *stated)
    assert done.code == 0, done.stderr
    assert (read(Path("living"))["air_temperature_C"] - frame["room_temperature"]).abs().max() < 1e-3


@pytest.mark.parametrize(
    "line",
    [
        b"2026-01-10 00:00:00 n/a 20.5",
        b"2026-01-10 00:00:00 21.5 20.5",
        b"2026-01-10 00:00:00\tHouse/Temp\t20.5",
        b"2026-01-10 00:00:00 +0100;House/Temp;20.5",
        b"2026-01-10 00:00:00 UTC,House/Temp,20.5",
        b"time,name,value",
    ],
)
def test_a_table_that_begins_with_stamps_is_no_log_of_messages(line: bytes) -> None:
    assert log_reader(line + b"\n" + line) is None


def test_devices_that_report_in_turn_are_told_apart(entry: Entry) -> None:
    frame = house()
    inside = pd.DataFrame(
        {"device": "Living", "temperature": frame["room_temperature"], "battery": 90.0, "humidity": 40.0}
    )
    outside = pd.DataFrame(
        {"device": "Outdoor", "temperature": frame["outdoor_temperature"], "battery": 90.0, "humidity": 40.0}
    )
    outside.index += pd.Timedelta(minutes=2)
    rows = pd.concat([inside, outside]).sort_index().rename(columns={"device": "Location"})
    rows.to_csv("house.csv")
    done = entry("import", "house.csv", "--map", "air_temperature_C=Living temperature", "--yes", "--out", "living")
    assert done.code == 0, done.stderr
    assert (read(Path("living"))["air_temperature_C"] - frame["room_temperature"]).abs().max() < 1e-3


def test_a_word_that_changes_with_the_hours_names_no_device(entry: Entry) -> None:
    frame = house()
    frame["Wind"] = [("N", "NE", "E", "SE")[place // 3 % 4] for place in range(len(frame))]
    frame.to_csv("house.csv")
    done = entry("import", "house.csv", "--out", "living")
    assert done.code == 0, done.stderr
    assert (read(Path("living"))["outdoor_temperature_C"] - frame["outdoor_temperature"]).abs().max() < 1e-3


# --- what their columns and stamps say ----------------------------------------------------------------


@pytest.mark.parametrize(
    ("column", "name", "unit"),
    [
        ("Temp, °C (LGR S/N: 1, SEN S/N: 2, LBL: bath)", "bath Temp", "°C"),
        ("Temp, °C (LGR S/N: 1, SEN S/N: 2)", "Temp LGR S/N: 1, SEN S/N: 2", "°C"),
        ("Flow, L/min", "Flow", "L/min"),
        ("LIVING:Zone Air Temperature [C](Hourly)", "LIVING:Zone Air Temperature", "C"),
        ("Room 1, 2", "Room 1, 2", ""),
        ("Bath, upstairs", "Bath, upstairs", ""),
        ("Zone, C", "Zone, C", ""),
        ("Flat, L", "Flat, L", ""),
        ("flow, ppm", "flow, ppm", ""),
    ],
)
def test_a_unit_stands_behind_a_name_as_loggers_and_simulations_write_it(column: str, name: str, unit: str) -> None:
    assert parted(column) == (name, unit)


@pytest.mark.parametrize(("good", "bad"), [("ok", "{fault,stale}"), ("GOOD", "Bad"), ("No fault", "Sensor fault")])
def test_what_a_status_calls_bad_is_missing_and_told(entry: Entry, good: str, bad: str) -> None:
    frame = house()
    status = pd.Series(good, index=frame.index)
    status.iloc[60:72] = bad
    frame.assign(Status=status).to_csv("house.csv")
    done = entry("import", "house.csv", "--out", "living")
    assert done.code == 0, done.stderr
    assert "house.csv: 12 rows are bad by their status: what they read is missing." in done.stdout
    found = read(Path("living"))
    assert found.iloc[61:71].isna().all().all()
    assert found.iloc[:60].notna().all().all()


@pytest.mark.parametrize("words", [("Normal", "Heating disabled"), ("good", "fair", "very bad"), ("up", "down")])
def test_a_column_with_another_word_judges_no_reading(entry: Entry, words: tuple[str, ...]) -> None:
    frame = house()
    frame["Status"] = [words[place % len(words)] for place in range(len(frame))]
    frame.to_csv("house.csv")
    done = entry("import", "house.csv", "--out", "living")
    assert done.code == 0, done.stderr
    assert "by their status" not in done.stdout
    assert "Status (" in done.stderr  # readings that are unknown words
    assert read(Path("living")).notna().all().all()


def test_a_reading_that_is_bad_keeps_its_unit(entry: Entry) -> None:
    """The first row tells the unit of all."""
    frame = house()
    rows = frame.melt(ignore_index=False, var_name="name").reset_index()
    rows["unit"] = rows["name"].map(lambda name: "°F" if "temp" in name else "L/h" if "flow" in name else "1")
    is_hot = rows["unit"] == "°F"
    rows["value"] = rows["value"].where(~is_hot, 1.8 * rows["value"] + 32.0)
    rows["status"] = "ok"
    rows.loc[rows.groupby("name").head(3).index, "status"] = "bad"
    rows.sort_values("time", kind="stable").to_csv("house.csv", index=False)
    done = entry("import", "house.csv", "--out", "living")
    assert done.code == 0, done.stderr
    assert (read(Path("living"))["outdoor_temperature_C"] - frame["outdoor_temperature"]).abs().max() < 0.01


def test_what_is_said_of_a_later_file_is_said_of_the_whole(entry: Entry) -> None:
    frame, half = house().assign(Status="ok"), len(house()) // 2
    frame.iloc[half + 9 : half + 20, -1] = "fault"
    Path("export").mkdir()
    frame.iloc[:half].to_csv("export/a.2026-01.csv")
    frame.iloc[half:].to_csv("export/a.2026-02.csv")
    done = entry("import", "export", "--out", "living")
    assert done.code == 0, done.stderr
    assert "a.2026-02.csv: 11 rows are bad by their status" in done.stdout


def test_files_of_two_rooms_are_told_apart_whichever_of_their_readings_begins_first(entry: Entry) -> None:
    """What differs in one order of the files is not the same in the other."""
    living = house().drop(columns=["heating_valve", "flow", "supply_temperature"], errors="ignore")
    living["setpoint"] = 21.0
    kitchen = living.assign(room_temperature=living["room_temperature"] + 1.0)
    living.iloc[:3, list(living).index("outdoor_temperature")] = np.nan
    living.iloc[:3, list(living).index("setpoint")] = np.nan
    kitchen.iloc[:3, list(living).index("room_temperature")] = np.nan
    Path("export").mkdir()
    living.to_csv("export/living.csv")
    kitchen.to_csv("export/kitchen.csv")
    done = entry("import", "export", "--yes", "--out", "house")
    assert "tells again" not in done.stdout + done.stderr
    refused(done, "several rooms")


@pytest.mark.parametrize("is_over", [True, False])
def test_a_sensor_that_stands_still_is_one_in_files_of_its_name_and_other_days(entry: Entry, is_over: bool) -> None:
    """The last mean of an export may be of an interval that was not over."""
    frame = house()
    half = len(frame) // 2
    frame["supply_temperature"] = 30.0
    Path("export").mkdir()
    for name, column in frame.items():
        former = column.iloc[: half + 10].rename("value").copy()
        former.iloc[-1] += 0.0 if is_over else 0.7
        former.to_csv(f"export/{name}_2026-01.csv")
        column.iloc[half:].rename("value").to_csv(f"export/{name}_2026-02.csv")
    done = entry("import", "export", "--yes", "--out", "living")
    assert done.code == 0, done.stderr
    assert (read(Path("living"))["outdoor_temperature_C"] - frame["outdoor_temperature"]).abs().max() < 1e-3


def overlapping(frame: pd.DataFrame, mend: Callable[[pd.DataFrame], pd.DataFrame]) -> None:
    """Write two files that have ten readings in common, of which the second may tell otherwise."""
    half = len(frame) // 2
    Path("export").mkdir()
    frame.iloc[: half + 10].to_csv("export/house_2026-01.csv")
    mend(frame.iloc[half:].copy()).to_csv("export/house_2026-02.csv")


def test_files_that_tell_the_same_where_they_overlap_are_one_record(entry: Entry) -> None:
    frame = house()
    overlapping(frame, lambda later: later)
    done = entry("import", "export", "--yes", "--out", "living")
    assert done.code == 0, done.stderr
    assert "house_2026-02.csv tells again what export/house_2026-01.csv tells: read once." in done.stdout
    found = read(Path("living"))
    assert len(found) >= len(frame) - 1
    assert (found["outdoor_temperature_C"] - frame["outdoor_temperature"]).abs().max() < 1e-3


def test_a_later_file_may_begin_with_the_states_at_its_begin(entry: Entry) -> None:
    frame = house()
    state = frame["heating_valve"]
    frame["heating_valve"] = state.where(state.diff() != 0.0)  # logged on change

    def with_its_state(later: pd.DataFrame) -> pd.DataFrame:
        later.loc[later.index[0], "heating_valve"] = state[later.index[0]]
        return later

    overlapping(frame, with_its_state)
    done = entry("import", "export", "--yes", "--out", "living")
    assert done.code == 0, done.stderr
    assert (read(Path("living"))["heating_signal"] == state).mean() > 0.95


def other_room(later: pd.DataFrame) -> pd.DataFrame:
    return later.assign(room_temperature=later["room_temperature"] + 0.3)


def other_stamps(later: pd.DataFrame) -> pd.DataFrame:
    return later.set_axis(later.index + pd.Timedelta(seconds=90))


def stands_still(later: pd.DataFrame) -> pd.DataFrame:
    """Both files tell one value where they overlap, as those of two rooms may."""
    return later


@pytest.mark.parametrize("mend", [other_room, other_stamps, stands_still])
def test_files_that_may_tell_of_others_where_they_overlap_are_told_apart_by_their_whole_names(
    entry: Entry, mend: Callable[[pd.DataFrame], pd.DataFrame]
) -> None:
    frame = house()
    if mend is stands_still:
        half = len(frame) // 2
        frame.iloc[half : half + 10] = frame.iloc[half].to_numpy()
    overlapping(frame, mend)
    later = Path("export/house_2026-02.csv")
    if mend is stands_still:
        later = later.rename("export/house_east.csv")
    refused(entry("import", "export", "--yes", "--out", "living"), "house_2026-01/", f"{later.stem}/", "equally well")


def test_of_codes_for_how_good_a_reading_is_zero_is_good_in_any_writing(entry: Entry) -> None:
    frame = house().assign(ack=True, q="0x00")
    frame.iloc[60:72, -1] = "0x42"
    frame.iloc[80:90, -1] = None
    frame.to_csv("house.csv")
    done = entry("import", "house.csv", "--out", "living")
    assert done.code == 0, done.stderr
    assert "house.csv: 12 rows are bad by their status" in done.stdout
    assert read(Path("living")).iloc[80:90].notna().all().all()


def test_a_status_that_is_on_or_off_is_a_reading(entry: Entry) -> None:
    frame = house().rename(columns={"heating_valve": "Status"})
    frame["Status"] = frame["Status"].map({1.0: "on", 0.0: "off"})
    frame.to_csv("house.csv")
    done = entry("import", "house.csv", "--map", "heating_signal=Status", "--out", "living")
    assert done.code == 0, done.stderr
    assert set(read(Path("living"))["heating_signal"].dropna()) == {0.0, 1.0}


def test_a_file_of_each_month_is_one_sensor(entry: Entry) -> None:
    frame, half = house(), len(house()) // 2
    Path("export").mkdir()
    for name, column in frame.items():
        column.iloc[:half].rename("value").to_csv(f"export/{name}.2026-01.csv")
        column.iloc[half:].rename("value").to_csv(f"export/{name}.2026-02.csv")
    done = entry("import", "export", "--out", "living")
    assert done.code == 0, done.stderr
    assert len(read(Path("living"))) >= len(frame) - 1
    assert "2026-0" not in done.stdout.split("\n\n")[0]


@pytest.mark.parametrize("names", [("T-101", "T-102"), ("sensor_1", "sensor_2"), ("floor.1", "floor.2")])
def test_the_number_of_a_sensor_in_a_file_s_name_stays(entry: Entry, names: tuple[str, str]) -> None:
    frame = house()
    Path("export").mkdir()
    for name, channel in zip(
        (*names, "outdoor"), ("room_temperature", "supply_temperature", "outdoor_temperature"), strict=True
    ):
        frame[channel].rename("value").to_csv(f"export/{name}.csv")
    stated = ("--map", f"air_temperature_C={names[0]}", "--map", f"supply_temperature_C={names[1]}")
    done = entry("import", "export", *stated, "--out", "living")
    assert done.code == 0, done.stderr
    assert (read(Path("living"))["supply_temperature_C"] - frame["supply_temperature"]).abs().max() < 1e-3


def test_seconds_beside_stamps_are_no_time_of_a_record(entry: Entry) -> None:
    frame = house().reset_index(names="Stamp")
    frame.insert(0, "time", 300 * frame.index.to_numpy())
    frame.to_csv("house.csv", index=False)
    done = entry("import", "house.csv", "--out", "living")
    assert done.code == 0, done.stderr
    assert read(Path("living")).index[0] == house().index[0]


def test_other_logs_of_a_folder_are_passed_over_and_one_in_western_letters_is_read(entry: Entry) -> None:
    Path("export").mkdir()
    times = house().index
    logged = [f"{at:%Y-%m-%d_%H:%M:%S} Garden temperature: {-place / 100.0} °C" for place, at in enumerate(times)]
    Path("export/garden.log").write_text("\n".join(logged), encoding="cp1252")
    Path("export/export.log").write_text("export of 7 sensors begun\nexport ended\n", encoding="utf-8")
    done = entry("import", "export", "--yes", "--out", "living")
    assert done.code == 0, done.stderr
    assert read(Path("living"))["outdoor_temperature_C"].iloc[100] == pytest.approx(-1.0)


def test_a_file_without_names_may_begin_with_equal_readings(entry: Entry) -> None:
    frame = house()
    frame.iloc[0] = [20.0, 1.0, 20.0, 20.0, 20.0]
    frame.to_csv("house.csv", header=False)
    names = ("air_temperature_C", "heating_signal", "flow_L_h", "supply_temperature_C", "outdoor_temperature_C")
    stated = [word for place, name in enumerate(names, 2) for word in ("--map", f"{name}=column {place}")]
    done = entry("import", "house.csv", *stated, "--out", "living")
    assert done.code == 0, done.stderr
    assert read(Path("living"))["air_temperature_C"].iloc[0] == 20.0


def test_a_line_of_a_log_that_is_no_reading_is_told_with_its_number(entry: Entry) -> None:
    logged = [f"2026-01-10_00:{minute:02d}:00 Garden temperature: {-minute / 10.0}" for minute in range(0, 60, 5)]
    Path("house.log").write_text("\n".join([*logged[:7], "2026-01-1", *logged[7:]]), encoding="utf-8")
    refused(entry("import", "house.log", "--out", "living"), "house.log:8", "no date and time")


# --- times without a date -----------------------------------------------------------------------------


def counted(unit_s: float, name: str) -> pd.DataFrame:
    """A house whose times count from the begin of its first day."""
    frame = house()
    return frame.set_index(pd.Index((frame.index - frame.index[0].normalize()).total_seconds() / unit_s, name=name))


@pytest.mark.parametrize(
    ("unit_s", "name"), [(1.0, "time"), (60.0, "Time [min]"), (3600.0, "time [h]"), (86_400.0, "Time (d)")]
)
def test_numbers_that_count_from_a_begin_are_times_of_it(entry: Entry, unit_s: float, name: str) -> None:
    counted(unit_s, name).to_csv("room.csv")
    begin = house().index[0].normalize()
    refused(entry("import", "room.csv", "--out", "living"), "counts from a begin", "--begin 2026-01-31")
    done = entry("import", "room.csv", "--begin", f"{begin:%Y-%m-%d}", "--out", "living")
    assert done.code == 0, done.stderr
    assert read(Path("living")).index[0] == house().index[0]
    assert f"--begin {begin.isoformat()}" in Path("living", "dataset.toml").read_text(encoding="utf-8")


def test_a_record_says_from_when_it_counts_and_in_what(entry: Entry) -> None:
    counted(1.0, "time").to_csv("room.csv")
    done = entry("import", "room.csv", "--begin", "2026-01-10", "--out", "living")
    assert "time counts seconds from 2026-01-10 00:00:00, as no unit is told." in done.stdout
    counted(3600.0, "time [h]").to_csv("room.csv")
    done = entry("import", "room.csv", "--begin", "2026-01-10", "--out", "again")
    assert "time [h] counts h from 2026-01-10 00:00:00.\n" in done.stdout


def test_joules_as_large_as_epochs_are_no_stamps(entry: Entry) -> None:
    counted(1.0, "time").assign(**{"tank [J]": 2e8 + 1e5 * np.arange(len(house()))}).to_csv("room.csv")
    done = entry("import", "room.csv", "--begin", "2026-01-10", "--out", "living")
    assert done.code == 0, done.stderr
    assert read(Path("living")).index[0] == house().index[0]


@pytest.mark.parametrize(("name", "number_of_1970"), [("Time", 25_569), ("datenum", 719_529)])
def test_day_numbers_of_a_spreadsheet_and_of_matlab_are_times(entry: Entry, name: str, number_of_1970: int) -> None:
    frame = house()
    frame.to_csv("plain.csv")
    assert entry("import", "plain.csv", "--timezone", "Europe/Tallinn", "--out", "plain").code == 0
    frame.index = pd.Index(
        (frame.index - pd.Timestamp("1970-01-01")) / pd.Timedelta(1, "D") + number_of_1970, name=name
    )
    frame.to_csv("numbers.csv", float_format="%.6f")
    done = entry("import", "numbers.csv", "--timezone", "Europe/Tallinn", "--out", "living")
    assert done.code == 0, done.stderr
    assert Path("living/data.csv").read_text() == Path("plain/data.csv").read_text()
    assert f"{name} counts days as" in Path("living/dataset.toml").read_text(encoding="utf-8")


FAR = [("2026-10-01", "2026-01-10", "far from --begin"), ("2026-07-21", "2026-07-21", "go back")]


@pytest.mark.parametrize(("first", "begin", "word"), FAR)
def test_days_far_from_the_begin_or_of_several_runs_are_refused(
    entry: Entry, first: str, begin: str, word: str
) -> None:
    frame, half = house(), len(house()) // 2
    days = pd.date_range(first, periods=len(frame), freq="5min")
    if word == "go back":
        days = days[:half].append(pd.date_range("2026-01-01", periods=len(frame) - half, freq="5min"))
    frame.set_index(pd.Index(days.strftime("%m/%d  %H:%M:%S"), name="Date/Time")).to_csv("room.csv")
    refused(entry("import", "room.csv", "--begin", begin, "--out", "living"), word)


def test_hours_without_a_unit_are_not_taken_for_seconds(entry: Entry) -> None:
    counted(3600.0, "time").to_csv("room.csv")
    done = entry("import", "room.csv", "--begin", "2026-01-10", "--out", "living")
    refused(done, "counts time in steps of", "hardly seconds", "--time-format h")
    wrong = entry("import", "room.csv", "--begin", "2026-01-10", "--time-format", "weeks", "--out", "living")
    refused(wrong, "counts time in 'weeks'", "units of time: s, ")
    done = entry("import", "room.csv", "--begin", "2026-01-10", "--time-format", "h", "--out", "living")
    assert done.code == 0, done.stderr
    assert "--time-format h" in Path("living/dataset.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("comment", ["", "# house 4\n\n"])
def test_columns_may_be_parted_by_blanks(entry: Entry, comment: str) -> None:
    house().to_csv("plain.csv")
    assert entry("import", "plain.csv", "--out", "plain").code == 0
    dated = in_blanks(house()).replace("\n", "\n\n", 1)
    Path("room.txt").write_text(comment + dated)
    done = entry("import", "room.txt", "--out", "read")
    assert done.code == 0, done.stderr
    assert Path("read/data.csv").read_text() == Path("plain/data.csv").read_text()
    lines = dated.splitlines()
    for odd in (lines[80] + " 7", lines[80].rpartition(" ")[0]):
        Path("room.txt").write_text("\n".join([*lines[:80], odd, *lines[81:]]))
        refused(entry("import", "room.txt", "--out", "living"), "room.txt:81", "is no table")


def in_blanks(frame: pd.DataFrame) -> str:
    rows = frame.reset_index().astype(str).to_string(index=False)
    return rows.replace(rows.split()[0], "date clock", 1)


def test_a_word_for_missing_in_the_first_row_hides_no_table(entry: Entry) -> None:
    frame = house()
    frame.iloc[0, 0] = np.nan
    Path("room.txt").write_text(in_blanks(frame).replace("nan", "NA"))
    done = entry("import", "room.txt", "--out", "living")
    assert done.code == 0, done.stderr
    assert np.isnan(read(Path("living")).iloc[0]["sensor_temperature_C"])


@pytest.mark.parametrize("between", ["# s degC", "1 2 3 4 5 6 7"])
def test_what_stands_between_names_and_readings_is_not_taken_for_readings(entry: Entry, between: str) -> None:
    head, _, rows = in_blanks(house()).partition("\n")
    Path("room.txt").write_text(f"{head}\n{between}\n{rows}")
    done = entry("import", "room.txt", "--out", "living")
    assert done.code != 0
    assert not Path("living").exists()


def test_one_of_two_comments_is_no_line_of_names_by_chance(entry: Entry) -> None:
    head, _, rows = in_blanks(house()).partition("\n")
    names = head.split()
    Path("room.txt").write_text(f"# {' '.join(names)}\n# {' '.join('abcdefghij'[: len(names)])}\n{rows}")
    assert entry("import", "room.txt", "--out", "living").code != 0


def test_a_unit_of_counted_times_is_no_format_of_stamps_in_another_file(entry: Entry) -> None:
    counted(3600.0, "time").drop(columns="outdoor_temperature").to_csv("room.csv")
    house()[["outdoor_temperature"]].to_csv("outdoors.csv")
    begin = house().index[0].normalize()
    stated = ("--begin", f"{begin:%Y-%m-%d}", "--time-format", "h")
    done = entry("import", "room.csv", "outdoors.csv", *stated, "--out", "living")
    assert done.code == 0, done.stderr
    assert {"outdoor_temperature_C", "supply_temperature_C"} <= set(read(Path("living")))


@pytest.mark.parametrize("name", ["Time (min)", "time [h]"])
def test_numbers_whose_unit_is_told_are_no_day_numbers(entry: Entry, name: str) -> None:
    frame = house()
    frame.index = pd.Index(43_824.0 + np.arange(len(frame)) / 60.0, name=name)
    frame.to_csv("room.csv")
    assert entry("import", "room.csv", "--out", "living").code != 0
    assert not Path("living").exists()


def test_days_without_a_year_are_those_of_the_begin_and_the_next(entry: Entry) -> None:
    frame = house()
    days = pd.date_range("2025-12-31 12:00", periods=len(frame), freq="5min")
    frame.set_index(pd.Index(days.strftime("%m/%d  %H:%M:%S"), name="Date/Time")).to_csv("room.csv")
    refused(entry("import", "room.csv", "--out", "living"), "stamps tell no year", "--begin 2026-01-31")
    done = entry("import", "room.csv", "--begin", "2025-12-31", "--out", "living")
    assert done.code == 0, done.stderr
    assert list(read(Path("living")).index[[0, -1]]) == [days[0], days[-1]]


@pytest.mark.parametrize("begin", ["soon", "2026-13-01", "2026-01-31T12:00Z"])
def test_a_begin_that_is_no_day_is_refused(entry: Entry, begin: str) -> None:
    counted(1.0, "time").to_csv("room.csv")
    done = entry("import", "room.csv", "--begin", begin, "--out", "living")
    assert (done.code, "write it as 2026-01-31" in done.stderr) == (2, True)
