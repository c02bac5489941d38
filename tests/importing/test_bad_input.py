"""Claims about what cannot be imported, or only in part: it is said what was seen, where, and what to type next."""

from __future__ import annotations

import gzip
import sqlite3
from contextlib import closing
from pathlib import Path
from zipfile import ZipFile

import numpy as np
import pandas as pd
import pytest

from tests.cli.conftest import Ended, Entry
from tests.importing.conftest import read
from waxstudy.dataset.read import read_dataset

USAGE, INVALID = 2, 3
ENCRYPTED = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(1024) + "EncryptedPackage".encode("utf-16-le") + bytes(512)


def house(start: str = "2026-01-10", days: float = 3.0, minutes: float = 5.0) -> pd.DataFrame:
    """Readings of a heated room by the clock, as plain as can be."""
    time = pd.date_range(start, periods=round(days * 1440 / minutes), freq=pd.Timedelta(minutes=minutes), name="time")
    hour = np.arange(len(time)) * minutes / 60.0
    noise = np.random.default_rng(7).normal(0.0, 0.02, (4, len(time)))
    on = (np.sin(hour) > 0.3).astype(float)
    return pd.DataFrame(
        {
            "room_temperature": 21.0 + 0.3 * np.sin(hour - 1.0) + noise[0],
            "heating_valve": on,
            "flow_L_h": 60.0 * on,
            "supply_temperature": 25.0 + 8.0 * on + noise[1],
            "outdoor_temperature": 2.0 + 4.0 * np.sin(hour / 4.0) + noise[2],
        },
        index=time,
    ).round(3)


def imported(entry: Entry, frame: pd.DataFrame, *options: str, name: str = "house.csv") -> Ended:
    frame.to_csv(name)
    return entry("import", name, *options, "--out", "living")


def refused(done: Ended, *words: str) -> None:
    """It is refused with these words, and nothing is written."""
    assert done.code == INVALID, done.stderr
    assert [word for word in words if word not in done.stderr] == []
    assert not Path("living").exists()
    assert "Traceback" not in done.stderr


# --- what a name is -----------------------------------------------------------------------------------


@pytest.mark.parametrize("options", [(), ("--yes",)], ids=["", "--yes"])
def test_of_two_names_that_fit_equally_well_none_is_taken(entry: Entry, options: tuple[str, ...]) -> None:
    frame = house().rename(columns={"room_temperature": "temperature_1"})
    done = imported(entry, frame.assign(temperature_2=frame["temperature_1"] + 0.4), *options)
    refused(done, "house.csv", "temperature_1, temperature_2 fit sensor_temperature_C equally well")
    refused(done, "--map sensor_temperature_C=")
    done = entry("import", "house.csv", "--map", "sensor_temperature_C=temperature_2", "--yes", "--out", "living")
    assert done.code == 0, done.stderr
    assert read(Path("living"))["sensor_temperature_C"].mean() == pytest.approx(21.4, abs=0.1)


def test_a_doubtful_name_is_asked_for_and_taken_with_yes(entry: Entry) -> None:
    frame = house().rename(columns={"outdoor_temperature": "garden"})
    refused(imported(entry, frame), "Is garden outdoor_temperature_C? Sure by 6", "--map outdoor_temperature_C=garden")
    assert imported(entry, frame, "--yes").code == 0


def test_a_record_without_an_outdoor_temperature_says_what_else_there_is(entry: Entry) -> None:
    frame = house().rename(columns={"outdoor_temperature": "north_wall"})
    done = imported(entry, frame, "--map", "supply_temperature_C=supply_temperature", "--map", "outdoor_temperature_C=")
    assert done.code == 0, done.stderr
    frame["north_wall"] += 16.0
    done = entry("import", imported_file(frame), "--out", "other")
    assert (done.code, "no outdoor temperature was found" in done.stderr) == (INVALID, True)
    assert "may it be north_wall? then say --map outdoor_temperature_C=NAME" in done.stderr
    assert "history of a weather service" in done.stderr


def test_only_what_may_be_a_temperature_is_proposed_as_one(entry: Entry) -> None:
    frame = house().rename(columns={"outdoor_temperature": "north_wall"})
    frame["north_wall"] += 16.0
    level = 15.0 + 10.0 * np.sin(np.arange(len(frame)) / 9.0)
    others = {"Y %": level, "humidity": level + 10.0, "share": (level - 5.0) / 20.0}
    done = imported(entry, frame.assign(**others), "--yes")
    refused(done, "may it be north_wall? then say")


def test_what_is_no_channel_is_told_and_of_many_names_the_first(entry: Entry) -> None:
    done = imported(entry, house().assign(**{"Sonne W": 100.0}), "--map", "outdoor_temperature_C=outdoor_temperature")
    assert "not used: Sonne W (to use it, say --map 'CHANNEL=Sonne W')\n" in done.stdout
    done = imported(entry, house().assign(**{f"extra {each}": 1000.0 + each for each in range(9)}), "--yes")
    told = "extra 0, extra 1, extra 2, extra 3, extra 4 and 4 more, listed in dataset.toml (to use one, say --map"
    assert f"not used: {told} CHANNEL=NAME)\n" in done.stdout
    assert "not used" not in imported(entry, house(), "--replace").stdout


def test_a_lone_thermometer_is_told_to_show_no_room_unless_it_is_named_so(entry: Entry) -> None:
    done = imported(entry, house())
    assert "a room is judged by air_temperature_C: room_temperature became sensor_temperature_C" in done.stderr
    assert "say --map air_temperature_C=room_temperature" in done.stderr
    done = imported(entry, house(), "--map", "air_temperature_C=room_temperature")
    assert "a room is judged by" not in done.stderr
    assert "sensor_temperature_C" not in read(Path("living"))


def test_a_house_without_a_room_thermometer_is_told_what_judges_a_room(entry: Entry) -> None:
    done = imported(entry, house().drop(columns=["room_temperature"]))
    said = (
        "no thermometer of the room was found, as air_temperature_C: if one is there, say --map air_temperature_C=NAME"
    )
    assert said in " ".join(done.stderr.split())
    odd = house().rename(columns={"room_temperature": "t110"})
    done = imported(entry, odd.assign(t170=odd["t110"] + 0.3), "--replace", "--yes")
    assert "as air_temperature_C: may it be t110, t170? then say --map" in " ".join(done.stderr.split())
    none = imported(entry, house().drop(columns=["room_temperature"]), "--map", "air_temperature_C=", "--replace")
    assert "no thermometer of the room" not in none.stderr
    assert "no thermometer of the room" not in imported(entry, house(), "--replace").stderr


def imported_file(frame: pd.DataFrame) -> str:
    frame.to_csv("again.csv")
    return "again.csv"


def test_a_name_that_is_not_there_is_answered_with_the_nearest(entry: Entry) -> None:
    done = imported(entry, house(), "--map", "sensor_temperature_C=room_temprature")
    refused(done, "room_temprature", "did you mean 'room_temperature'")
    done = entry("import", "house.csv", "--map", "sensor_temperatur_C=room_temperature", "--out", "living")
    assert (done.code, "did you mean 'sensor_temperature_C'" in done.stderr) == (USAGE, True)


def test_blanks_beside_a_channel_and_a_name_do_not_count(entry: Entry) -> None:
    imported(entry, house(), "--map", " air_temperature_C = room_temperature ")
    assert "air_temperature_C" in read(Path("living"))


def test_blanks_around_a_name_of_a_long_table_make_no_other_name(entry: Entry) -> None:
    plain = house().melt(ignore_index=False, var_name="entity").reset_index()
    blank = plain.assign(entity=plain["entity"].where(plain.index % 2 == 0, plain["entity"] + " "))
    tables = []
    for frame, folder in ((plain, "plain"), (blank, "blank")):
        frame.to_csv("long.csv", index=False)
        done = entry("import", "long.csv", "--map", "air_temperature_C=room_temperature", "--out", folder)
        assert done.code == 0, done.stderr
        tables.append(Path(folder, "data.csv").read_bytes())
    assert tables[0] == tables[1]


def test_of_several_rooms_none_is_taken(entry: Entry) -> None:
    frame = house().rename(columns={"room_temperature": "kitchen_temperature"})
    done = imported(entry, frame.assign(bedroom_temperature=19.0 + frame["heating_valve"]), "--yes")
    refused(done, "Readings of several rooms", "--room ... (bedroom, kitchen), or answer")
    done = entry("import", "house.csv", "--room", "kitchn", "--out", "living")
    refused(done, "did you mean 'kitchen'", "rooms: bedroom, kitchen")


# --- units and values ---------------------------------------------------------------------------------


def test_a_unit_that_does_not_fit_its_values_is_refused_and_can_be_stated(entry: Entry) -> None:
    frame = house().rename(columns={"room_temperature": "room_temperature [°C]"})
    frame["room_temperature [°C]"] = 1.8 * frame["room_temperature [°C]"] + 32.0
    done = imported(entry, frame, "--yes")
    refused(done, "room_temperature in '°C' as sensor_temperature_C", "median of 69", "degrees Fahrenheit")
    refused(done, "--unit 'room_temperature=degF'")
    done = entry("import", "house.csv", "--yes", "--unit", "room_temperature=degF", "--out", "living")
    assert done.code == 0, done.stderr
    assert read(Path("living"))["sensor_temperature_C"].mean() == pytest.approx(21.0, abs=0.2)


def test_temperatures_outdoors_in_tenths_are_told_by_how_far_they_reach(entry: Entry) -> None:
    """Their median is near 0 in any unit."""
    frame = house(days=6.0)
    frame = frame.assign(outdoor_temperature=(10.0 * (frame["outdoor_temperature"] - 2.0) * 2.0).round())
    assert abs(frame["outdoor_temperature"].median()) < 40.0
    refused(imported(entry, frame, "--yes"), "looks like tenths of a degree", "'outdoor_temperature=0.1degC'")
    assert imported(entry, frame, "--yes", "--unit", "outdoor_temperature=0.1degC").code == 0
    assert read(Path("living"))["outdoor_temperature_C"].max() == pytest.approx(8.0, abs=0.2)


def test_a_stated_unit_that_is_none_is_refused(entry: Entry) -> None:
    done = imported(entry, house(), "--yes", "--unit", "flow_L_h=banana")
    refused(done, "--unit flow_L_h: 'banana' is no unit that is known", "such as degC")


def test_a_column_of_unknown_words_is_told(entry: Entry) -> None:
    done = imported(entry, house().assign(zone_mode="Htg"), "--yes")
    assert done.code == 0, done.stderr
    assert "not used, because the readings are unknown words: zone_mode ('Htg')" in done.stderr


def test_pulses_and_units_that_are_none_are_refused(entry: Entry) -> None:
    litres = (house()["flow_L_h"] / 12.0).cumsum()
    frame = house().drop(columns="flow_L_h").assign(**{"water_meter [imp]": (litres / 10.0).round()})
    done = imported(entry, frame, "--map", "flow_L_h=water_meter")
    refused(done, "'imp' are pulses", "--unit 'water_meter=10 L'")
    done = entry(
        "import", "house.csv", "--map", "flow_L_h=water_meter", "--unit", "water_meter=9**9**9", "--out", "living"
    )
    refused(done, "'9**9**9' is no unit that is known")
    done = entry(
        "import", "house.csv", "--map", "flow_L_h=water_meter", "--unit", "water_meter=10 L", "--out", "living"
    )
    assert done.code == 0, done.stderr
    assert read(Path("living"))["flow_L_h"].mean() == pytest.approx(house()["flow_L_h"].mean(), rel=0.03)


def test_a_counter_that_jumps_is_told_and_says_nothing_there(entry: Entry) -> None:
    meter = 812.0 + (house()["flow_L_h"] / 12.0).cumsum()
    meter.iloc[400:] += 50_000.0
    meter.iloc[600:] -= meter.iloc[599]
    done = imported(entry, house().drop(columns="flow_L_h").assign(**{"water_meter [L]": meter}))
    assert done.code == 0, done.stderr
    assert "water_meter jumps, as no meter does once, first at 2026-01-11 09:20 (row 402): missing there" in done.stderr
    assert "water_meter begins anew once, first at 2026-01-12 02:00 (row 602)" in done.stderr
    flow = read(Path("living"))["flow_L_h"]
    assert flow.isna().sum() == 2  # before the first reading, and at the jump
    assert flow.max() == pytest.approx(60.0, abs=0.5)


def test_cells_that_are_no_values_are_counted_and_missing(entry: Entry) -> None:
    frame = house().astype(object)
    frame.iloc[10:13, 0] = ["unavailable", "??", "??"]
    done = imported(entry, frame)
    assert done.code == 0, done.stderr
    assert "room_temperature: 2 readings are no values (the first is '??' in row 13): missing" in done.stderr
    assert read(Path("living"))["sensor_temperature_C"].isna().sum() == 3


# --- time ---------------------------------------------------------------------------------------------


def test_hours_of_silence_are_told_and_not_filled(entry: Entry) -> None:
    frame = house(minutes=1.0)
    parts = []
    for name, values in frame.items():
        kept = values[values.diff().abs().fillna(1.0) > 0.0]
        kept = kept[(kept.index < "2026-01-11 06:00") | (kept.index > "2026-01-11 20:00")]
        kept = kept.sample(frac=0.5, random_state=3).sort_index()
        parts.append(pd.DataFrame({"entity": name, "time": kept.index, "value": kept.to_numpy()}))
    done = imported(entry, pd.concat(parts).set_index("entity"))
    assert done.code == 0, done.stderr
    assert "room_temperature: nothing for over 6 h once, at most for 14." in done.stderr
    assert "--hold '15 h'" in done.stderr
    silent = read(Path("living")).loc["2026-01-11 12:02":"2026-01-11 19:58", "sensor_temperature_C"]  # type: ignore[misc]
    assert silent.isna().all()
    done = entry("import", "house.csv", "--hold", "20 h", "--out", "living")
    assert (done.code, "nothing for over" in done.stderr) == (0, False)
    assert read(Path("living"))["sensor_temperature_C"].notna().mean() > 0.99


@pytest.mark.parametrize(("minutes", "is_told"), [(5.0, False), (60.0, True)])
def test_how_stamps_of_long_intervals_are_taken_is_told(entry: Entry, minutes: float, is_told: bool) -> None:
    done = imported(entry, house(minutes=minutes))
    assert done.code == 0, done.stderr
    assert ("A row every 60 min is taken as of its stamp" in done.stdout) == is_told
    about = Path("living/dataset.toml")
    text = about.read_text()
    about.write_text(text.replace("[dataset]\n", '[dataset]\nstamps = "start"\n'))
    entry("import", "house.csv", "--out", "living")
    assert 'stamps = "start"' in about.read_text()


def on_the_wall(utc: pd.DataFrame) -> pd.DataFrame:
    """The same with stamps of a clock in Tallinn that is put forward and back."""
    wall = utc.index.tz_localize("UTC").tz_convert("Europe/Tallinn").tz_localize(None)  # type: ignore[attr-defined]
    return utc.set_index(wall.rename("time"))


@pytest.mark.parametrize("start", ["2026-03-27", "2026-10-23"])
def test_a_clock_that_is_put_forward_or_back_makes_no_gap_and_no_overlap(entry: Entry, start: str) -> None:
    utc = house(start, days=4.0)
    done = imported(entry, on_the_wall(utc), "--timezone", "Europe/Tallinn")
    assert done.code == 0, done.stderr
    found = read(Path("living"))
    assert found.index[0] == utc.index[0] + pd.Timedelta(hours=2)  # standard time
    assert found["sensor_temperature_C"].to_list() == utc["room_temperature"].to_list()
    assert "standard time of Europe/Tallinn, UTC+2 h, all year" in done.stdout
    assert ("24 stamps lie in the hour that is there twice on 2026-10-25" in done.stdout) is (start == "2026-10-23")


def test_of_a_clock_that_is_not_put_back_the_zone_of_winter_time_is_told(entry: Entry) -> None:
    frame = house("2026-10-23", days=4.0)
    done = imported(entry, frame, "--timezone", "Europe/Tallinn")
    said = "taken as summer time (of a logger whose clock is not put back, say --timezone Etc/GMT-2)"
    assert said in done.stdout
    done = imported(entry, frame, "--timezone", "Etc/GMT-2")
    assert (done.code, said in done.stdout) == (0, False)
    assert read(Path("living")).index[0] == frame.index[0]


def test_an_offset_for_a_zone_is_answered_with_the_zone_of_that_offset(entry: Entry) -> None:
    done = imported(entry, house(), "--timezone", "UTC+2")
    assert (done.code, Path("living").exists()) == (USAGE, False)
    assert "--timezone UTC+2: no such time zone; did you mean 'Etc/GMT-2'?" in done.stderr


def test_a_clock_that_is_put_back_is_refused_without_its_zone(entry: Entry) -> None:
    done = imported(entry, on_the_wall(house("2026-10-23", days=4.0)))
    refused(
        done, "time goes back from 2026-10-25 03:55:00 to 2026-10-25 03:00:00", "--timezone, such as Europe/Tallinn"
    )


def test_a_clock_that_is_not_put_forward_is_told_from_its_zone(entry: Entry) -> None:
    done = imported(entry, house("2026-03-27", days=4.0), "--timezone", "Europe/Tallinn")
    refused(done, "house.csv:614", "2026-03-29 03:00:00 is not there in Europe/Tallinn", "--timezone Etc/GMT-2")
    assert entry("import", "house.csv", "--timezone", "Etc/GMT-2", "--out", "living").code == 0


def test_a_zone_that_stamps_do_not_tell_is_asked_for(entry: Entry) -> None:
    frame = house()
    frame.index = frame.index.strftime("%Y-%m-%dT%H:%M:%SZ").rename("time")
    refused(imported(entry, frame, "--yes"), "In which time zone is the room", "--timezone ...")


@pytest.mark.parametrize("written", ["tallinn", "Tallin", "Europ/Tallinn"])
def test_a_zone_is_found_by_its_city(entry: Entry, written: str) -> None:
    done = imported(entry, house(days=2.0), "--timezone", written)
    assert (done.code, "did you mean 'Europe/Tallinn'?" in done.stderr) == (USAGE, True)


def test_days_that_may_be_months_are_refused(entry: Entry) -> None:
    frame = house(days=2.0)
    frame.index = frame.index.strftime("%m/%d/%Y %H:%M").str.replace("/10/", "/01/").str.replace("/11/", "/02/")
    refused(imported(entry, frame.rename_axis("time")), "day and month cannot be told apart", "--time-format '%d/%m/%Y")
    assert entry("import", "house.csv", "--time-format", "%m/%d/%Y %H:%M", "--out", "living").code == 0
    assert read(Path("living")).index[-1].month == 1


# --- files --------------------------------------------------------------------------------------------


def day_and_clock(start: str) -> pd.DataFrame:
    frame = house(start)
    time = pd.DatetimeIndex(frame.index)
    return frame.assign(Time=time.strftime("%H:%M")).set_index(time.strftime("%d/%m/%Y").rename("Date"))


def test_a_day_and_a_clock_in_columns_of_their_own_are_one_stamp(entry: Entry) -> None:
    done = imported(entry, day_and_clock("2026-01-15"), "--yes")
    assert done.code == 0, done.stderr
    assert str(read(Path("living")).index[-1]) == "2026-01-17 23:55:00"


def test_where_such_days_may_be_months_the_format_of_both_tells(entry: Entry) -> None:
    frame = day_and_clock("2026-01-02")
    refused(imported(entry, frame, "--yes"), "day and month cannot be told apart", "--time-format")
    refused(imported(entry, frame, "--yes", "--time-format", "%H:%M"), "'%H:%M' has no date")
    assert imported(entry, frame, "--yes", "--time-format", "%d/%m/%Y %H:%M").code == 0
    assert str(read(Path("living")).index[-1]) == "2026-01-04 23:55:00"


@pytest.mark.parametrize("tags", [{}, {"_measurement": "heating"}, {"_measurement": "heating", "room": "living"}])
def test_fields_of_an_annotated_table_are_names(entry: Entry, tags: dict[str, str]) -> None:
    rows = house().reset_index(names="_time").melt("_time", var_name="_field", value_name="_value")
    rows.assign(result="_result", table=0, **tags).to_csv("influx.csv", index=False)
    done = entry("import", "influx.csv", "--yes", "--out", "living")
    assert done.code == 0, done.stderr
    assert read(Path("living"))["flow_L_h"].max() == 60.0


@pytest.mark.parametrize("stamp", ["start", "start_ts"])
def test_statistics_that_are_stamped_at_their_starts_end_an_hour_later(entry: Entry, stamp: str) -> None:
    hours = house(minutes=60.0)
    rows = hours.reset_index(names=stamp).melt(stamp, var_name="statistic_id", value_name="mean")
    rows.assign(min=rows["mean"], max=rows["mean"]).to_csv("statistics.csv", index=False)
    done = entry("import", "statistics.csv", "--yes", "--out", "living")
    assert done.code == 0, done.stderr
    room = read(Path("living"))["sensor_temperature_C"]
    assert room["2026-01-10 01:00"] == pytest.approx(hours["room_temperature"].iloc[0], abs=0.01)


def test_fields_of_several_sensors_stay_apart(entry: Entry) -> None:
    indoors = house()[["room_temperature", "heating_valve"]].rename(columns={"room_temperature": "temperature"})
    outdoors = house()[["outdoor_temperature"]].rename(columns={"outdoor_temperature": "temperature"})
    both = [
        frame.reset_index(names="_time").melt("_time", var_name="_field", value_name="_value").assign(device=device)
        for device, frame in (("living", indoors), ("outdoor", outdoors))
    ]
    pd.concat([*both, both[0].iloc[:1].assign(_field=None, device=None)]).to_csv("influx.csv", index=False)
    done = entry("import", "influx.csv", "--map", "sensor_temperature_C=living temperature", "--yes", "--out", "living")
    assert done.code == 0, done.stderr
    assert (
        read(Path("living"))["sensor_temperature_C"].min() > 20.0 > read(Path("living"))["outdoor_temperature_C"].max()
    )


def test_a_workbook_with_a_password_or_damage_is_refused(entry: Entry) -> None:
    Path("locked.xlsx").write_bytes(ENCRYPTED)
    refused(entry("import", "locked.xlsx", "--out", "living"), "locked.xlsx: this workbook has a password", "export")
    house().to_excel("whole.xlsx")
    Path("cut.xlsx").write_bytes(Path("whole.xlsx").read_bytes()[:5000])
    refused(entry("import", "cut.xlsx", "--out", "living"), "cut.xlsx: is no whole workbook", "save it again")


def test_an_archive_that_is_no_workbook_is_to_be_unpacked(entry: Entry) -> None:
    with ZipFile("house.zip", "w") as packed:
        packed.writestr("house.csv", house().to_csv())
    wrong = "house.zip: is an archive, and no workbook: it holds house.csv"
    refused(entry("import", "house.zip", "--out", "living"), wrong, "unpack it")


def test_whole_days_as_a_spreadsheet_counts_them_are_to_be_written_as_dates(entry: Entry) -> None:
    frame = house().iloc[:9]
    frame.index = pd.Index(range(46_000, 46_009), name="Time")
    frame.to_csv("serial.csv")
    done = entry("import", "serial.csv", "--out", "living")
    refused(done, "serial.csv: no column holds stamps: 'Time' has numbers, such as", "write them as 2024-01-31 12:00")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_titles_above_the_names_of_columns_are_passed_over(entry: Entry, encoding: str) -> None:
    house().to_csv("plain.csv")
    assert entry("import", "plain.csv", "--out", "plain").code == 0
    titled = "House 4, ground floor\nexport;of 2026-02-01;;\n\n" + house().to_csv(sep=";", decimal=",")
    Path("titled.csv").write_bytes(titled.encode(encoding))
    done = entry("import", "titled.csv", "--out", "titled")
    assert done.code == 0, done.stderr
    assert Path("titled/data.csv").read_text() == Path("plain/data.csv").read_text()
    cut = titled.splitlines()
    cut[9] = cut[9].replace("2026", "never")
    Path("cut.csv").write_bytes("\n".join(cut).encode(encoding))
    assert "cut.csv:10" in entry("import", "cut.csv", "--out", "cut").stderr


def test_a_thermometer_that_has_not_measured_yet_neither_hides_its_name_nor_warms_the_water(entry: Entry) -> None:
    frame = house(days=2.0)
    for name in frame.columns:
        if "supply" in name or "outdoor" in name:
            frame.loc[frame.index[100:140], name] = 85.0
    done = imported(entry, frame)
    assert done.code == 0, done.stderr
    said = "40 samples are what a 1-Wire thermometer shows until it has measured (the first is 85): set to missing"
    assert f"supply_temperature_C: {said}" in " ".join(done.stderr.split())
    found = read_dataset(Path("living")).values
    assert found["supply_temperature_C"].isna().sum() == found["outdoor_temperature_C"].isna().sum() == 40


def test_what_is_always_85_is_no_error(entry: Entry) -> None:
    done = imported(entry, house().assign(battery=85.0))
    assert (done.code, "Traceback" in done.stderr) == (0, False)


def test_a_locked_or_damaged_database_is_refused(entry: Entry) -> None:
    with closing(sqlite3.connect("history.db")) as base:
        house().reset_index().astype({"time": str}).to_sql("log", base, index=False)
        base.execute("begin exclusive")
        refused(entry("import", "history.db", "--out", "living"), "locked by another program", ".backup copy.db")
        base.rollback()
    assert entry("import", "history.db", "--out", "living").code == 0
    data = Path("history.db").read_bytes()
    Path("cut.db").write_bytes(data[: len(data) // 2])
    done = entry("import", "cut.db", "--out", "other")
    assert (done.code, "cut.db: is no whole database" in done.stderr) == (INVALID, True)


def test_a_database_that_is_being_written_is_read_and_left_alone(entry: Entry) -> None:
    with closing(sqlite3.connect("history.db")) as base:
        base.execute("pragma journal_mode = wal")
        house().reset_index().astype({"time": str}).to_sql("log", base, index=False)
        base.commit()
        before = {path.name: path.read_bytes() for path in Path().iterdir() if path.is_file()}
        assert entry("import", "history.db", "--out", "living").code == 0
        assert {path.name: path.read_bytes() for path in Path().iterdir() if path.is_file()} == before
    assert len(read(Path("living"))) == len(house())


def test_a_file_that_is_cut_off_or_empty_or_a_folder_without_records_is_refused(entry: Entry) -> None:
    house().to_csv("whole.csv")
    Path("cut.csv.gz").write_bytes(gzip.compress(Path("whole.csv").read_bytes())[:2000])
    refused(entry("import", "cut.csv.gz", "--out", "living"), "cut.csv.gz: is no whole gzip file")
    Path("empty.csv").write_text("")
    refused(entry("import", "empty.csv", "--out", "living"), "empty.csv: is empty")
    Path("blank.csv").write_text(";;\n;;\n;;\n")
    refused(entry("import", "blank.csv", "--out", "living"), "blank.csv: ")
    Path("none").mkdir()
    refused(entry("import", "none", "--out", "living"), "none: this folder holds no record", ".parquet")


def test_a_million_rows_in_the_wrong_layout_are_refused(entry: Entry) -> None:
    count = 1_000_000
    time = pd.date_range("2025-01-01", periods=count, freq="30s")
    names = pd.Series(np.arange(count)).astype(str).radd("reading ")
    pd.DataFrame({"time": time, "entity": names, "value": 21.0}).to_parquet("long.parquet")
    refused(entry("import", "long.parquet", "--out", "living"), "1000000 names in 1000000 rows", "expected is a column")
    names = pd.Series(np.arange(count) % 5000).astype(str).radd("e")
    pd.DataFrame({"time": time, "name": names, "value": 21.0}).to_parquet("short.parquet")
    refused(entry("import", "short.parquet", "--out", "living"), "column 'name' has 5000 names in 1000000 rows")
    turned = house(days=0.5).reset_index().astype({"time": str}).set_index("time").T
    turned.to_csv("turned.csv", index_label="sensor")
    refused(entry("import", "turned.csv", "--out", "living"), "a row for each sensor", "turn it round")
    house().reset_index(drop=True).to_csv("timeless.csv", index=False)
    refused(entry("import", "timeless.csv", "--out", "living"), "no column holds stamps", "room_temperature")
