"""Claims about sources that hold several in one: units, clocks, sensors, rooms, sheets; none of them is merged."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.cli.conftest import Ended, Entry
from tests.importing.conftest import read
from tests.importing.test_bad_input import house, refused
from waxstudy.importing.names import is_of_room, rooms_of

AIR = ("--map", "air_temperature_C=room_temperature", "--yes")


@pytest.fixture
def frame() -> pd.DataFrame:
    return house(days=1.0, minutes=15.0)


def imported(entry: Entry, frame: pd.DataFrame, *options: str) -> Ended:
    frame.to_csv("house.csv", index=False)
    return entry("import", "house.csv", *options, "--out", "living")


def as_long(frame: pd.DataFrame, names: list[str]) -> pd.DataFrame:
    """A row for each reading, of a stamp all in turn."""
    parts = [pd.DataFrame({"time": frame.index, "name": name, "value": frame[name].to_numpy()}) for name in names]
    return pd.concat(parts).sort_values("time", kind="stable").reset_index(drop=True)


# --- units


def test_readings_with_several_units_behind_them_are_refused(entry: Entry, frame: pd.DataFrame) -> None:
    flow = frame.pop("flow_L_h")
    written = np.where(flow > 0.0, (flow / 1000.0).astype(str) + " m³/h", flow.astype(str) + " L/min")
    done = imported(entry, frame.assign(flow=written).reset_index(), *AIR)
    refused(done, "flow has readings in L/min, m³/h", "without units behind them")


def test_a_column_of_units_that_changes_within_a_sensor_is_refused(entry: Entry, frame: pd.DataFrame) -> None:
    table = as_long(frame, ["room_temperature", "outdoor_temperature", "flow_L_h"])
    table["unit"] = np.where(table["name"] == "flow_L_h", np.where(table.index % 2, "L/h", "L/min"), "°C")
    refused(imported(entry, table, *AIR), "flow_L_h has readings in L/h, L/min")


def test_several_ways_to_write_one_unit_are_one(entry: Entry, frame: pd.DataFrame) -> None:
    table = as_long(frame, ["room_temperature", "outdoor_temperature"])
    table["unit"] = np.where(table.index % 2, "°C", "C")
    assert imported(entry, table, *AIR).code == 0
    assert read(Path("living"))["air_temperature_C"].to_list() == frame["room_temperature"].to_list()


def test_a_comma_between_thousands_of_whole_numbers_is_none_of_decimals(entry: Entry, frame: pd.DataFrame) -> None:
    flow = np.resize([990, 1010, 0, 950, 1234], len(frame))
    done = imported(entry, frame.assign(flow_L_h=[f"{one:,}" for one in flow]).reset_index(), *AIR)
    assert done.code == 0
    assert read(Path("living"))["flow_L_h"].to_list() == flow.tolist()


def test_a_comma_before_three_decimals_stays_one_of_decimals(entry: Entry, frame: pd.DataFrame) -> None:
    flow = np.resize([0.99, 1.01, 0.95, 1.234], len(frame))
    written = [f"{one:.3f}".replace(".", ",") for one in flow]
    done = imported(entry, frame.assign(flow_L_h=written).reset_index(), *AIR, "--unit", "flow_L_h=m3/h")
    assert done.code == 0
    assert read(Path("living"))["flow_L_h"].to_list() == (1000.0 * flow).tolist()


def test_a_minus_as_typesetters_write_it_is_a_minus(entry: Entry, frame: pd.DataFrame) -> None:
    outdoors = [f"{one}".replace("-", "\u2212") for one in frame["outdoor_temperature"]]
    assert imported(entry, frame.assign(outdoor_temperature=outdoors).reset_index(), *AIR).code == 0
    assert read(Path("living"))["outdoor_temperature_C"].to_list() == frame["outdoor_temperature"].to_list()
    assert frame["outdoor_temperature"].min() < 0.0


def test_words_among_temperatures_are_missing_and_among_levels_are_shut_and_open(
    entry: Entry, frame: pd.DataFrame
) -> None:
    setpoint = np.where(frame.index.hour < 6, "Off", "21.0 °C")
    position = np.where(frame.index.hour < 6, "closed", np.where(frame.index.hour < 8, "open", "35 %"))
    table = frame.drop(columns="heating_valve").assign(setpoint=setpoint, valve_position=position)
    done = imported(entry, table.reset_index(), *AIR)
    assert done.code == 0
    assert "setpoint: 24 readings are words among numbers: missing" in done.stderr
    found = read(Path("living"))
    assert found["setpoint_C"].isna().sum() == 24
    assert found["displacement"].iloc[[0, 7 * 4, -1]].to_list() == [0.0, 1.0, 0.35]


@pytest.mark.parametrize(("column", "name"), [("Temperatur (aussen)", "Temperatur (aussen)"), ("T (EG)", "T (EG)")])
def test_what_is_no_unit_between_brackets_belongs_to_the_name(
    entry: Entry, frame: pd.DataFrame, column: str, name: str
) -> None:
    done = imported(
        entry,
        frame.rename(columns={"outdoor_temperature": column}).reset_index(),
        *AIR,
        "--map",
        f"outdoor_temperature_C={name}",
    )
    assert done.code == 0, done.stderr
    assert read(Path("living"))["outdoor_temperature_C"].to_list() == frame["outdoor_temperature"].to_list()


# --- sensors


def test_a_room_and_a_sensor_in_two_columns_make_one_name(entry: Entry, frame: pd.DataFrame) -> None:
    parts = [
        ("living", "temperature", frame["room_temperature"]),
        ("bath", "temperature", frame["room_temperature"] + 3),
    ]
    parts.append(("house", "outdoor", frame["outdoor_temperature"]))
    rows = [pd.DataFrame({"time": frame.index, "room": a, "sensor": b, "value": of.to_numpy()}) for a, b, of in parts]
    table = pd.concat(rows).sort_values("time", kind="stable")
    done = imported(entry, table, "--room", "living", "--map", "air_temperature_C=living temperature")
    assert done.code == 0, done.stderr
    assert read(Path("living"))["air_temperature_C"].to_list() == frame["room_temperature"].to_list()


def test_sensors_that_have_numbers_for_names_are_told_apart(entry: Entry, frame: pd.DataFrame) -> None:
    table = as_long(frame, ["room_temperature", "outdoor_temperature"])
    table = table.rename(columns={"name": "sensor_id"}).replace({"room_temperature": 7, "outdoor_temperature": 9})
    stated = ("--map", "air_temperature_C=7", "--map", "outdoor_temperature_C=9")
    assert imported(entry, table.astype({"sensor_id": int}), *stated).code == 0
    found = read(Path("living"))
    for channel, name in (("air_temperature_C", "room_temperature"), ("outdoor_temperature_C", "outdoor_temperature")):
        assert found[channel].to_list() == frame[name].to_list()


def test_a_column_of_remarks_names_no_sensors(entry: Entry, frame: pd.DataFrame) -> None:
    table = frame[["room_temperature", "outdoor_temperature"]].assign(remark=None)
    table.iloc[[5, 50], 2] = ["aired", "guests"]
    assert imported(entry, table.reset_index(), *AIR).code == 0
    assert len(read(Path("living"))) == len(frame)


@pytest.mark.parametrize(
    ("entity", "room", "is_of_it"),
    [("Room 1 valve", "room 1", True), ("Room 10 valve", "room 1", False), ("bedroom 2 valve", "bedroom", False)],
)
def test_a_number_behind_a_room_belongs_to_it(entity: str, room: str, is_of_it: bool) -> None:
    assert is_of_room(entity, room) is is_of_it
    assert rooms_of([entity])[entity] == entity.lower().removesuffix(" valve")


def test_a_name_with_a_word_that_may_be_of_another_room_is_asked_for(entry: Entry, frame: pd.DataFrame) -> None:
    table = frame.rename(columns={"room_temperature": "living temperature", "heating_valve": "pavilion valve"})
    stated = ("--room", "living", "--map", "air_temperature_C=living temperature")
    refused(imported(entry, table.reset_index(), *stated), "Is pavilion valve heating_signal?")
    plain = table.rename(columns={"pavilion valve": "valve"}).reset_index()
    assert imported(entry, plain, *stated).code == 0


def test_flow_beside_return_is_proposed_as_the_temperature_that_it_may_be(entry: Entry, frame: pd.DataFrame) -> None:
    table = frame.drop(columns="flow_L_h").rename(columns={"supply_temperature": "Flow"})
    table["Return"] = table["Flow"] - 3.0
    refused(imported(entry, table.reset_index(), *AIR[:2]), "Is Flow supply_temperature_C?")
    assert imported(entry, table.reset_index(), *AIR).code == 0
    assert read(Path("living"))["supply_temperature_C"].to_list() == frame["supply_temperature"].to_list()


# --- clocks


def test_each_of_several_trends_side_by_side_has_its_own_clock(entry: Entry, frame: pd.DataFrame) -> None:
    slow, fast = frame.iloc[::2], frame.iloc[: len(frame) // 2]
    beside = {
        "outdoor Time": slow.index.to_list(),
        "outdoor_temperature": slow["outdoor_temperature"].to_list(),
        "room Time": fast.index.to_list(),
        "room_temperature": fast["room_temperature"].to_list(),
    }
    assert imported(entry, pd.DataFrame(beside), *AIR).code == 0
    found = read(Path("living"))
    assert found.loc[fast.index, "air_temperature_C"].to_list() == fast["room_temperature"].to_list()
    assert found.loc[fast.index[::2], "outdoor_temperature_C"].to_list() == fast["outdoor_temperature"].to_list()[::2]


def test_a_meter_in_joules_is_no_clock(entry: Entry, frame: pd.DataFrame) -> None:
    table = frame.reset_index()
    table.insert(2, "meter_J", 3_600_000 * (1000 + np.arange(len(table))))
    assert imported(entry, table, *AIR).code == 0
    assert read(Path("living"))["outdoor_temperature_C"].to_list() == frame["outdoor_temperature"].to_list()


@pytest.mark.parametrize("first", [0, 1])
def test_an_hour_in_a_column_of_its_own_belongs_to_the_day(entry: Entry, first: int) -> None:
    hourly = house(days=3.0, minutes=60.0)
    ends = hourly.index + pd.Timedelta(hours=first)
    days, hours = (hourly.index if first else ends).strftime("%Y-%m-%d"), hourly.index.hour + first
    assert imported(entry, hourly.assign(Date=days, Hour=hours)[["Date", "Hour", *hourly.columns]], *AIR).code == 0
    assert read(Path("living")).index.to_list() == ends.to_list()


def test_many_rows_of_one_day_without_a_time_of_day_are_refused(entry: Entry, frame: pd.DataFrame) -> None:
    table = frame.assign(time=frame.index.strftime("%Y-%m-%d"))
    refused(imported(entry, table, *AIR), "many rows have the stamp 2026-01-10, which tells no time of day")


def test_many_rows_of_one_stamp_are_told(entry: Entry, frame: pd.DataFrame) -> None:
    done = imported(entry, frame.assign(time=frame.index.floor("h")), *AIR)
    assert done.code == 0
    assert "house.csv: 75% of the rows have the stamp of another one: the last counts." in done.stdout


@pytest.mark.parametrize("minutes", [15.0, 60.0])
@pytest.mark.parametrize(("more_K", "told"), [(2.0, True), (0.0, False)])
def test_a_few_rows_that_contradict_others_of_their_stamp_are_told(
    entry: Entry, minutes: float, more_K: float, told: bool
) -> None:
    frame = house(days=4.0, minutes=minutes)
    again = frame.iloc[40:60] + more_K
    done = imported(entry, pd.concat([frame, again]).rename_axis("time").reset_index(), *AIR)
    assert done.code == 0
    assert ("house.csv: 20 stamps have rows that contradict each other: the last counts." in done.stdout) == told


def test_rows_that_complete_each_other_or_write_a_number_otherwise_contradict_nothing(
    entry: Entry, frame: pd.DataFrame
) -> None:
    half, rest = frame.columns[:2], frame.columns[2:]
    odd = frame.iloc[40:60].copy()
    otherwise = odd.map(lambda value: f"{value:.3f}0")
    parts = [frame.drop(index=odd.index).astype(object), odd[half], odd[rest], otherwise]
    done = imported(entry, pd.concat(parts).rename_axis("time").reset_index(), *AIR)
    assert done.code == 0
    assert "contradict" not in done.stdout


def test_an_hour_that_the_end_of_summer_time_repeats_contradicts_nothing(entry: Entry) -> None:
    utc = house("2026-10-24", days=2.0, minutes=15.0)
    local = utc.set_axis(utc.index.tz_localize("UTC").tz_convert("Europe/Tallinn").tz_localize(None)).rename_axis(
        "time"
    )
    assert local.index.duplicated().any()
    done = imported(entry, local.reset_index(), *AIR, "--timezone", "Europe/Tallinn")
    assert done.code == 0
    assert "contradict" not in done.stdout


def test_a_clock_that_is_put_forward_is_refused_without_its_zone(entry: Entry) -> None:
    utc = house("2026-03-28", days=2.0, minutes=15.0)
    wall = utc.index.tz_localize("UTC").tz_convert("Europe/Tallinn").tz_localize(None)  # type: ignore[attr-defined]
    table = utc.assign(time=wall)
    refused(imported(entry, table, *AIR), "an hour is missing after 2026-03-29 02:45:00", "--timezone")
    assert imported(entry, table, *AIR, "--timezone", "Europe/Tallinn").code == 0
    assert len(read(Path("living")).dropna()) == len(utc)


def test_readings_of_a_clock_that_nobody_has_set_yet_are_left_out(entry: Entry, frame: pd.DataFrame) -> None:
    table = frame.reset_index()
    early = table.iloc[[0]].assign(time=pd.Timestamp("1970-01-01 00:00:12"))
    done = imported(entry, pd.concat([early, table]), *AIR)
    assert done.code == 0
    assert done.stdout.count("house.csv: what was read on 1970-01-01 is left out") == 1
    assert read(Path("living")).index[0] == frame.index[0]


@pytest.mark.parametrize("form", [(), ("--time-format", "%d-%b-%Y %H:%M")], ids=["", "stated"])
def test_months_may_be_in_another_language(entry: Entry, form: tuple[str, ...]) -> None:
    frame = house("2026-02-27", minutes=15.0)
    times = frame.index.strftime("%d-%b-%Y %H:%M").str.replace("Mar", "Mär")
    assert imported(entry, frame.assign(time=times), *AIR, *form).code == 0
    assert read(Path("living")).index.equals(frame.index)


# --- sheets


def test_a_sheet_without_stamps_beside_one_with_readings_is_left_out(entry: Entry, frame: pd.DataFrame) -> None:
    with pd.ExcelWriter("house.xlsx") as book:
        frame.reset_index().to_excel(book, sheet_name="Data", index=False)
        legend = pd.DataFrame({"Name": ["a", "b", "c"], "Meaning": ["air", "bath", "cold"]})
        legend.to_excel(book, sheet_name="Legend", index=False)
    done = entry("import", "house.xlsx", *AIR, "--out", "living")
    assert done.code == 0, done.stderr
    assert "house.xlsx, sheet 'Legend' is left out: it has no column of stamps." in done.stdout
    legend.to_csv("legend.csv", index=False)
    refused_alone = entry("import", "legend.csv", *AIR, "--out", "other")
    assert "no column holds stamps" in refused_alone.stderr


# --- tables below each other


@pytest.mark.parametrize("field", ["value", ""], ids=["one field", "two fields"])
def test_tables_of_annotated_csv_below_each_other_are_one(entry: Entry, frame: pd.DataFrame, field: str) -> None:
    """InfluxDB begins another one where the type of values changes."""
    written = ""
    for name in frame:
        words = name == "heating_valve"
        values = frame[name].map({0.0: "off", 1.0: "on"}) if words else frame[name]
        rows = pd.DataFrame({"result": "", "table": 0, "_time": frame.index.strftime("%Y-%m-%dT%H:%M:%SZ")})
        rows = rows.assign(_value=values.to_numpy(), _field=field or ("state" if words else "value"), entity_id=name)
        kind = "string" if words else "double"
        written += f"#group,false,false,false,false,true,true\n#datatype,string,long,dateTime,{kind},string,string\n"
        written += "#default,_result,,,,,\n" + rows.to_csv() + "\n"
    Path("influx.csv").write_text(written)
    done = entry("import", "influx.csv", "--timezone", "UTC", "--yes", "--out", "living")
    assert done.code == 0, done.stderr
    found = read(Path("living"))
    assert found["heating_signal"].to_list() == frame["heating_valve"].to_list()
    assert found["outdoor_temperature_C"].to_list() == frame["outdoor_temperature"].to_list()


def test_a_row_of_annotated_csv_that_is_no_reading_is_told_with_its_line(entry: Entry) -> None:
    text = "#group,false,false,true\n#datatype,string,dateTime,double\n,result,_time,outdoor_temperature\n"
    rows = "".join(f",,2026-01-01T{hour:02}:00:00Z,{hour}.5\n" for hour in range(12))
    Path("influx.csv").write_text(text + rows + "\n" + text + rows.replace("01-01", "01-02") + ",,soon,1.0\n")
    refused(entry("import", "influx.csv", "--out", "living"), "influx.csv:32", "soon")
    Path("influx.csv").write_text(text + rows + "\n" + text + rows + "1,2,3,4,5,6\n")
    refused(entry("import", "influx.csv", "--out", "living"), "annotated CSV of InfluxDB")
    Path("influx.csv").write_text("#group,false,false,true\n#datatype,string,dateTime,double\n")
    refused(entry("import", "influx.csv", "--out", "living"), "annotated CSV of InfluxDB without a table")


# --- names of groups above names


@pytest.mark.parametrize("names", [True, False], ids=["", "a nameless column"])
def test_names_of_groups_above_those_of_columns_of_a_sheet_are_passed_over(
    entry: Entry, frame: pd.DataFrame, names: bool
) -> None:
    head = [["Protocol of the house"], ["by", "K. H."], [], ["", "Room", "", "Circuit", "", ""]] if names else []
    columns = ["time", *frame] if names else ["time", "room_temperature", "", "", "", "outdoor_temperature"]
    rows = [
        [time.to_pydatetime(), *values] for time, values in zip(frame.index, frame.to_numpy().tolist(), strict=True)
    ]
    padded = [[*row, *[""] * (len(columns) - len(row))] for row in (*head, columns, *rows)]
    pd.DataFrame(padded).to_excel("house.xlsx", index=False, header=False)
    done = entry("import", "house.xlsx", *AIR, "--out", "living")
    assert done.code == 0, done.stderr
    found = read(Path("living"))
    assert found["air_temperature_C"].to_list() == frame["room_temperature"].to_list()
    assert ("supply_temperature_C" in found) is names
