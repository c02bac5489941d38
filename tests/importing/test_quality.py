"""Claims about columns of quality and about rows and cells that are no readings."""

from __future__ import annotations

import csv
from datetime import date, time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.cli.conftest import Entry
from tests.importing.conftest import read
from tests.importing.test_bad_input import house, imported

ROOM = ("--map", "air_temperature_C=room_temperature")


def coded(frame: pd.DataFrame, *codes: int) -> pd.Series:
    """A column of codes, of which the first stands in two hours and the others in rows after them."""
    column = pd.Series(192, index=frame.index)
    column.iloc[60:84] = codes[0]
    for place, code in enumerate(codes[1:], 100):
        column.iloc[place] = code
    return column


def test_readings_of_a_bad_code_are_missing_and_uncertain_ones_kept(entry: Entry) -> None:
    frame = house()
    done = imported(entry, frame.assign(Quality=coded(frame, 0, 64, 216)), *ROOM)
    assert done.code == 0, done.stderr
    assert "house.csv: 24 rows are bad by their status: what they read is missing." in done.stdout
    assert "house.csv: 1 rows are uncertain by 'Quality', and kept." in done.stdout
    found = read(Path("living"))["air_temperature_C"]
    assert (found.iloc[60:84].isna().all(), found.iloc[84:].isna().any()) == (True, False)


def test_a_code_behind_each_reading_of_a_long_table_is_heard(entry: Entry) -> None:
    frame = house()
    rows = frame.melt(ignore_index=False, var_name="Name", value_name="Wert").reset_index()
    rows["Quality"] = np.where((rows["Name"] == "room_temperature") & (rows["time"] < frame.index[24]), 0, 192)
    done = imported(entry, rows.sort_values("time", kind="stable").set_index("time"), *ROOM)
    assert done.code == 0, done.stderr
    found = read(Path("living"))
    assert found["air_temperature_C"].iloc[:24].isna().all()
    assert found["outdoor_temperature_C"].notna().all()


@pytest.mark.parametrize("codes", [(1, 0), (100, 20), ("fair", "poor")])
@pytest.mark.parametrize("is_long", [False, True])
def test_a_quality_in_another_way_is_told_to_judge_nothing(
    entry: Entry, codes: tuple[object, ...], is_long: bool
) -> None:
    frame = house()
    if is_long:
        frame = frame.melt(ignore_index=False, var_name="name", value_name="value").sort_index(kind="stable")
    frame["Quality"] = [codes[place % 2] for place in range(len(frame))]
    done = imported(entry, frame, *ROOM)
    assert done.code == 0, done.stderr
    assert "'Quality' says how good readings are in a way that is not known: it judges none." in done.stdout
    assert read(Path("living")).notna().all().all()


@pytest.mark.parametrize("is_numbered", [False, True])
@pytest.mark.parametrize(("good", "bad"), [("Good", "Bad"), (192, 0)])
def test_of_several_columns_of_quality_each_judges_the_one_before(
    entry: Entry, is_numbered: bool, good: object, bad: object
) -> None:
    frame = house()
    parts = []
    for place, name in enumerate(frame.columns, 1):
        quality = pd.Series(good, index=frame.index, name=f"Quality {place}" if is_numbered else "Quality")
        if name == "outdoor_temperature":
            quality.iloc[60:84] = bad
        parts += [frame[name], quality]
    done = imported(entry, pd.concat(parts, axis="columns", sort=False), *ROOM)
    assert done.code == 0, done.stderr
    assert "24 readings of 'outdoor_temperature' are bad by the status behind it: missing." in done.stdout
    found = read(Path("living"))
    assert found["outdoor_temperature_C"].iloc[60:84].isna().all()
    assert found["air_temperature_C"].notna().all()


def test_a_status_and_a_quality_behind_each_reading_judge_that_reading(entry: Entry) -> None:
    frame = house()
    good = pd.DataFrame({"Status": "ok", "Quality": "Good"}, index=frame.index)
    bad = good.copy()
    bad.iloc[60:84, 1] = "Bad"
    parts = [part for name in frame for part in (frame[name], bad if name == "outdoor_temperature" else good)]
    done = imported(entry, pd.concat(parts, axis="columns", sort=False), *ROOM)
    assert done.code == 0, done.stderr
    found = read(Path("living"))
    assert found["outdoor_temperature_C"].iloc[60:84].isna().all()
    assert found["air_temperature_C"].notna().all()


def test_a_status_that_stands_before_its_reading_leaves_the_stamps(entry: Entry) -> None:
    frame = house()
    parts = []
    for name in frame.columns:
        status = pd.Series("ok", index=frame.index, name="Status")
        status.iloc[60:84] = "fault" if name == "outdoor_temperature" else "ok"
        parts += [status, frame[name]]
    done = imported(entry, pd.concat(parts, axis="columns", sort=False), *ROOM)
    assert done.code == 0, done.stderr
    found = read(Path("living"))["outdoor_temperature_C"]
    assert (found.iloc[60:84].isna().all(), found.iloc[84:].isna().any()) == (True, False)


def test_readings_of_what_is_called_total_are_no_sums(entry: Entry) -> None:
    frame = house().rename(columns={"room_temperature": "Total"})
    rows = frame.melt(ignore_index=False, var_name="name", value_name="value").reset_index()
    rows[["name", "time", "value"]].to_csv("house.csv", index=False)
    done = entry("import", "house.csv", "--map", "air_temperature_C=Total", "--out", "living")
    assert done.code == 0, done.stderr
    assert read(Path("living"))["air_temperature_C"].notna().all()


def test_rows_that_sum_up_a_month_are_left_out_and_named(entry: Entry) -> None:
    frame = house()
    sheet = frame.reset_index(drop=True)
    sheet.insert(0, "Datum", [at.date() for at in frame.index])
    sheet.insert(1, "Uhrzeit", [time(at.hour, at.minute) for at in frame.index])
    for place, word in enumerate(("Mittelwert", "Min", "Max:")):
        sheet.loc[len(frame) + place] = [word, None, *frame.mean()]
    assert isinstance(sheet["Datum"].iloc[0], date)
    sheet.to_excel("house.xlsx", index=False)
    done = entry("import", "house.xlsx", *ROOM, "--out", "living")
    assert done.code == 0, done.stderr
    assert "3 rows are left out, as they sum up others: 'Mittelwert', 'Min', 'Max:'" in done.stdout
    assert len(read(Path("living"))) == len(frame)


def test_a_monitor_of_a_bus_tells_its_points_by_destination(entry: Entry) -> None:
    frame = house(days=1.0)
    rows = []
    for at, readings in frame.iterrows():
        for place, (name, value) in enumerate(readings.items(), 1):
            unit = " °C" if "temp" in str(name) else ""
            told = ("$01 | On" if value else "$00 | Off") if "valve" in str(name) else f"042F | {value:.3f}{unit}"
            rows.append((len(rows) + 1, at, "from bus", "", f"1.1.1{place}", "RTR", f"1/2/{place}", name, 6, told))
    names = ["#", "Time", "Service", "Flags", "Source Address", "Source Name", "Destination Address"]
    names += ["Destination Name", "Rout", "Info"]
    pd.DataFrame(rows, columns=names).to_csv("ets.csv", index=False, quoting=csv.QUOTE_ALL)
    done = entry("import", "ets.csv", *ROOM, "--out", "living")
    assert done.code == 0, done.stderr
    found = read(Path("living"))
    assert found["air_temperature_C"].to_list() == frame["room_temperature"].to_list()
    assert found["heating_signal"].to_list() == frame["heating_valve"].to_list()


def test_units_in_brackets_behind_values_are_units(entry: Entry) -> None:
    lines = []
    for at, row in house(days=1.0).iterrows():
        stamp = f"{at:%Y-%m-%d_%H:%M:%S}"
        lines += [f"{stamp} FHT measured-temp: {row['room_temperature']} (Celsius)",
                  f"{stamp} Aussen temperature: {row['outdoor_temperature']} (Celsius)"]  # fmt: skip
    Path("fht.log").write_text("\n".join(lines))
    done = entry("import", "fht.log", "--yes", "--out", "living")
    assert done.code == 0, done.stderr
    assert read(Path("living"))["outdoor_temperature_C"].to_list() == house(days=1.0)["outdoor_temperature"].to_list()
