"""Claims about what looks like something else: it is taken for what it is, asked for, or left out with a reason."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.cli.conftest import Entry
from tests.importing.conftest import read
from tests.importing.test_bad_input import house, imported, refused
from tests.importing.test_names import COUNT, MINUTE_NS, course
from waxstudy.importing.matching import matched
from waxstudy.importing.reading import Logged
from waxstudy.importing.seen import level_unit, seen
from waxstudy.plugin import FloatArray

AIR = ("--map", "air_temperature_C=room_temperature")
MAPPED = (*AIR, "--map", "supply_temperature_C=supply_temperature")


@pytest.fixture
def frame() -> pd.DataFrame:
    return house(days=1.0, minutes=15.0)


# --- degrees Fahrenheit


@pytest.mark.parametrize(
    "name", ["Room 3 blind position", "Raum 3 Stellgröße", "room floor flow", "Zimmer Stellgröße Soll", "room air"]
)
def test_a_number_of_a_room_that_is_no_temperature_makes_no_degrees_fahrenheit(
    name: str, frame: pd.DataFrame, entry: Entry
) -> None:
    other = pd.Series(np.resize([80.0, 71.5, 92.0], len(frame)), frame.index)
    done = imported(entry, frame.assign(**{name: other}), "--yes", *AIR)
    assert "degF" not in done.stdout + done.stderr
    if done.code == 0:
        assert read(Path("living"))["outdoor_temperature_C"].to_list() == frame["outdoor_temperature"].to_list()


def test_a_source_that_writes_celsius_has_no_fahrenheit(frame: pd.DataFrame, entry: Entry) -> None:
    warm = frame.assign(room_temperature=70.0).rename(columns={"supply_temperature": "supply_temperature [°C]"})
    done = imported(entry, warm, *AIR)
    refused(done, "room_temperature in 'C' as air_temperature_C", "say its unit: --unit 'room_temperature=degF'")


def test_the_unit_that_made_a_misfit_is_not_its_way_out(frame: pd.DataFrame, entry: Entry) -> None:
    done = imported(entry, frame, *AIR, "--unit", "room_temperature=degF")
    refused(done, "room_temperature in 'degF' as air_temperature_C", "say its unit: --unit 'room_temperature=degC'")


# --- names of other things


def channels_of(*entities: tuple[str, str, FloatArray]) -> dict[str, str]:
    """The channel of each entity (name, unit, values) that may become one; behind a ? where it is asked for."""
    ns, rows = np.arange(COUNT) * MINUTE_NS, np.arange(COUNT)
    logged = [Logged(name, "a.csv", ns, values, rows, unit, False, False) for name, unit, values in entities]
    found = matched(seen(logged, {}), {}, "")
    return {each.seen.entity: ("" if each.is_sure else "?") + channel for channel, each in found.items()}


@pytest.mark.parametrize(
    "name",
    [
        "Living air humidity", "sensor.outdoor_humidity", "Luftfeuchte außen", "Raumluftfeuchtigkeit", "air quality",
        "Luftdruck", "outdoor pressure", "sensor.outdoor_dew_point", "Taupunkttemperatur außen", "target humidity",
        "room CO2", "CPU temperature", "outdoor feels like temperature",
    ],
)  # fmt: skip
def test_humidity_and_its_like_are_no_temperatures(name: str) -> None:
    for low in (0.0, 20.0):
        assert channels_of((name, "", low + course("outdoors"))) == {}
        assert channels_of((name, "", np.full(COUNT, low))) == {}


def test_a_hub_s_thermometer_is_asked_for() -> None:
    assert all(
        told.startswith("?") for told in channels_of(("sensor.zigbee_hub_temperature", "", course("outdoors"))).values()
    )


@pytest.mark.parametrize(
    ("name", "channel"),
    [
        ("Luft Fenster", "air_temperature_C"),
        ("Vorlauf Lift", "supply_temperature_C"),
        ("Außen Wind", "outdoor_temperature_C"),
    ],
)
def test_words_of_other_things_do_not_stand_against_degrees(name: str, channel: str) -> None:
    warm = {"air_temperature_C": 20.0, "supply_temperature_C": 30.0}.get(channel, 0.0)
    found = channels_of((name, "°C", warm + 0.2 * course("outdoors")))
    assert found.get(name, "").removeprefix("?") == channel
    assert channels_of((name, "%", warm + 0.2 * course("outdoors"))).get(name) != channel


def test_an_output_that_is_0_or_half_is_no_state() -> None:
    half = np.where(np.arange(COUNT) % 40 < 20, 50.0, 0.0)
    (output,) = seen(
        [Logged("Stellgröße", "a.csv", np.arange(COUNT) * MINUTE_NS, half, np.arange(COUNT), "", False, False)], {}
    )
    assert not output.is_two_state
    assert level_unit(output) == "%"


@pytest.mark.parametrize(
    ("name", "channel"),
    [("Energy meter supply temperature", "supply_temperature_C"), ("Außenluft Temperatur", "outdoor_temperature_C"),
     ("air temperature", "air_temperature_C"), ("sensor.outdoor_weather_wind_temperature", "outdoor_temperature_C")],
)  # fmt: skip
def test_a_temperature_stays_one_beside_the_word_of_another_quantity(name: str, channel: str) -> None:
    of = {"supply_temperature_C": "supply", "outdoor_temperature_C": "outdoors"}.get(channel, "room")
    assert channels_of((name, "", course(of))) == {name: channel}


@pytest.mark.parametrize("unit", ["", "%"])
@pytest.mark.parametrize(
    "name",
    ["cover.living_room_blind_position", "Rollladen Wohnzimmer Position", "Jalousie Stellung", "window opening",
     "Fenster Wohnzimmer", "front door", "Living room shutter position", "roller_blinds lift"],
)  # fmt: skip
def test_blinds_and_windows_are_no_valves(name: str, unit: str) -> None:
    assert channels_of((name, unit, course("share"))) == {}
    assert channels_of((name, unit, 100.0 * course("valve"))) == {}


@pytest.mark.parametrize("unit", ["", "%"])
@pytest.mark.parametrize(
    ("name", "channel"),
    [("Living room position", "?displacement"), ("opening", "?displacement"), ("Hub", "?displacement"),
     ("valve lift", "displacement"), ("Öffnung Ventil", "displacement"), ("Ventilhub", "displacement"),
     ("trv kitchen position", "displacement"), ("displacement", "displacement")],
)  # fmt: skip
def test_a_position_is_a_valve_s_only_where_its_name_says_so(name: str, unit: str, channel: str) -> None:
    assert channels_of((name, unit, course("share"))) == {name: channel}


# --- modes, words, units


def test_the_mode_of_a_thermostat_is_no_signal(frame: pd.DataFrame, entry: Entry) -> None:
    """It stands at heat all day, whether or not it heats."""
    mode = np.where(np.arange(len(frame)) < 60, "heat", "off")
    wide = frame.drop(columns=["heating_valve", "flow_L_h"]).assign(**{"climate.floor_heating": mode})
    long = wide.reset_index().melt("time", var_name="entity_id", value_name="state")
    long.to_csv("history.csv", index=False)
    for source in ("history.csv", "wide.csv"):
        wide.to_csv("wide.csv")
        done = entry("import", source, *AIR, "--yes", "--out", source.partition(".")[0])
        assert done.code == 0, done.stderr
        assert "a thermostat's state is its mode" in done.stderr
        assert ": climate.floor_heating\n" in done.stderr
        assert "heating_signal" not in read(Path(source.partition(".")[0]))
    stated = ("--map", "heating_signal=climate.floor_heating")
    assert entry("import", "history.csv", *AIR, *stated, "--out", "stated").code == 0
    assert read(Path("stated"))["heating_signal"].mean() == pytest.approx(60 / 96)


def test_a_source_of_modes_alone_is_refused(frame: pd.DataFrame, entry: Entry) -> None:
    modes = pd.DataFrame({"climate.living_room": "heat"}, index=frame.index)
    refused(imported(entry, modes, "--room", "living"), "no outdoor temperature was found")


@pytest.mark.parametrize("unit", ["Ein/Aus", "offen/zu", "AUF/ZU", "Status", "°C"])
def test_of_words_that_are_understood_no_unit_matters(unit: str, frame: pd.DataFrame, entry: Entry) -> None:
    words = frame["heating_valve"].map({0.0: "Aus", 1.0: "Ein"})
    units = pd.DataFrame([{"heating_valve": unit, "room_temperature": "°C"}], index=[""])
    pd.concat([units, frame.assign(heating_valve=words).astype(object)]).rename_axis("time").to_csv("house.csv")
    done = entry("import", "house.csv", *AIR, "--out", "living")
    assert done.code == 0, done.stderr
    assert read(Path("living"))["heating_signal"].to_list() == frame["heating_valve"].to_list()


@pytest.mark.parametrize(("unit", "is_used"), [("Ein/Aus", True), ("off/on", True), ("Status", False)])
def test_a_unit_of_two_states_is_that_of_0_and_1_and_one_that_nobody_knows_is_told(
    unit: str, is_used: bool, frame: pd.DataFrame, entry: Entry
) -> None:
    units = pd.DataFrame([{"heating_valve": unit, "room_temperature": "°C"}], index=[""])
    pd.concat([units, frame.astype(object)]).rename_axis("time").to_csv("house.csv")
    done = entry("import", "house.csv", *AIR, "--out", "living")
    assert done.code == 0, done.stderr
    assert ("heating_signal" in read(Path("living"))) is is_used
    told = "the unit is none that is known: heating_valve ('Status'); to use one, say --unit NAME=UNIT"
    assert (told in done.stderr) is not is_used


# --- tenths of a degree


@pytest.mark.parametrize("has_siblings", [True, False])
def test_water_in_tenths_is_not_told_to_be_in_kelvins_alone(
    has_siblings: bool, frame: pd.DataFrame, entry: Entry
) -> None:
    """Of 24 to 33.5 °C, tenths are as large as kelvins."""
    tenths = ["room_temperature", "supply_temperature"] if has_siblings else ["supply_temperature"]
    odd = 0.5 if has_siblings else 0.0  # what is not whole is told by others
    frame["supply_temperature"] += 4.0
    done = imported(entry, frame.assign(**{name: (10.0 * frame[name]).round() + odd for name in tenths}), *MAPPED)
    refused(done, "it looks like tenths of a degree or kelvins")
    refused(done, "--unit 'supply_temperature=0.1degC' or --unit 'supply_temperature=K'")
    units = [word for name in tenths for word in ("--unit", f"{name}=0.1degC")]
    assert entry("import", "house.csv", *MAPPED, *units, "--out", "living").code == 0


def test_water_in_kelvins_is_told_to_be_in_these(frame: pd.DataFrame, entry: Entry) -> None:
    done = imported(entry, frame.assign(supply_temperature=frame["supply_temperature"] + 273.15), *MAPPED)
    refused(done, "it looks like kelvins", "say its unit: --unit 'supply_temperature=K' or what it is")


# --- numbers that are states


@pytest.mark.parametrize(("off", "on"), [(0, 255), (0, 10), (0, 3), (0, 100)])
def test_two_numbers_are_off_and_on_where_one_is_0(off: int, on: int, frame: pd.DataFrame, entry: Entry) -> None:
    done = imported(entry, frame.assign(heating_valve=frame["heating_valve"].map({0.0: off, 1.0: on})), *AIR)
    assert done.code == 0, done.stderr
    assert read(Path("living"))["heating_signal"].to_list() == frame["heating_valve"].to_list()


@pytest.mark.parametrize("name", ["heating_valve", "Valve position"])
@pytest.mark.parametrize(("off", "on"), [(1, 2), (2, 1), (3, 1)])
def test_of_two_numbers_without_0_it_is_asked_which_is_on(
    off: int, on: int, name: str, frame: pd.DataFrame, entry: Entry
) -> None:
    low, high = sorted((off, on))
    valve = frame.pop("heating_valve")
    done = imported(entry, frame.assign(**{name: valve.map({0.0: off, 1.0: on})}), *AIR, "--yes")
    refused(done, f"{name} is {low} or {high}. Which is on: {high}, as {low}/{high}, or {low}, as {high}/{low}?")
    refused(done, f"say --unit {name}=..." if name == "heating_valve" else f"say --unit '{name}=...'")
    signal = ("--map", f"heating_signal={name}", "--unit", f"{name}={off}/{on}")
    assert entry("import", "house.csv", *AIR, *signal, "--out", "living").code == 0
    assert read(Path("living"))["heating_signal"].to_list() == valve.to_list()


def test_two_numbers_with_a_unit_are_no_states(frame: pd.DataFrame, entry: Entry) -> None:
    position = frame["heating_valve"].map({0.0: 20.0, 1.0: 60.0})
    frame = frame.drop(columns="heating_valve").assign(**{"valve position [%]": position})
    done = imported(entry, frame, *AIR)
    assert done.code == 0, done.stderr
    assert read(Path("living"))["displacement"].to_list() == (position / 100.0).to_list()


def test_a_setpoint_of_two_whole_numbers_is_a_temperature(frame: pd.DataFrame, entry: Entry) -> None:
    dial = pd.Series(np.where(frame.index.hour < 7, 18, 21), frame.index)
    assert imported(entry, frame.assign(setpoint=dial), *AIR).code == 0
    assert read(Path("living"))["setpoint_C"].to_list() == dial.to_list()


# --- numbers of rows


@pytest.mark.parametrize("name", ["Nr", "Sequence", "index", ""])
@pytest.mark.parametrize("step", [1, -1])
def test_a_number_of_the_row_is_no_meter(name: str, step: int, frame: pd.DataFrame, entry: Entry) -> None:
    Path("house").mkdir()
    for column in frame:
        table = frame[column].rename("Wert").reset_index()[::step]
        table.insert(0, name, np.arange(7, 7 + len(table))[::step])
        table.to_csv(f"house/{column}.csv", index=False)
    done = entry("import", "house", *AIR, "--out", "living")
    assert done.code == 0, done.stderr
    assert read(Path("living"))["flow_L_h"].to_list() == frame["flow_L_h"].to_list()
    assert f"Left out, as it numbers the rows: {name}".strip() in done.stdout
    assert "not used" not in done.stdout


def test_a_meter_whose_every_pulse_is_a_row_is_a_meter(frame: pd.DataFrame, entry: Entry) -> None:
    for name in ("water meter", "pulses"):
        meter = frame.drop(columns="flow_L_h").assign(**{name: np.arange(len(frame))})
        done = imported(entry, meter, *AIR, "--unit", f"{name}=10 L", "--replace", "--yes")
        assert done.code == 0, done.stderr
        assert read(Path("living"))["flow_L_h"].iloc[-1] == pytest.approx(40.0), done.stderr
    lone = frame.drop(columns="flow_L_h")
    Path("house").mkdir()
    lone.to_csv("house/room.csv")
    pd.DataFrame({"time": frame.index, "value": np.arange(len(frame))}).to_csv("house/water meter.csv", index=False)
    done = entry("import", "house", *AIR, "--unit", "water meter=10 L", "--yes", "--out", "lone")
    assert read(Path("lone"))["flow_L_h"].iloc[-1] == pytest.approx(40.0), done.stderr


# --- one reading


def per_sensor(frame: pd.DataFrame) -> None:
    Path("house").mkdir()
    for name in frame:
        frame[[name]].dropna().set_axis(["value"], axis="columns").to_csv(f"house/{name}.csv")


@pytest.mark.parametrize("name", ["room_setpoint", "Sollwert"])
def test_a_setpoint_that_was_logged_once_is_held_from_then_on(name: str, frame: pd.DataFrame, entry: Entry) -> None:
    per_sensor(frame.assign(**{name: pd.Series([21.5], frame.index[4:5])}))
    done = entry("import", "house", *AIR, "--out", "living")
    assert done.code == 0, done.stderr
    setpoint = read(Path("living"))["setpoint_C"]
    assert setpoint[:4].isna().all()
    assert (setpoint[4:] == 21.5).all()


def test_the_day_of_a_lone_reading_is_told_by_those_of_others(entry: Entry) -> None:
    frame = house("2026-01-10", days=5.0, minutes=15.0)
    frame.index = frame.index.strftime("%m/%d/%Y %H:%M").rename("time")
    per_sensor(frame.assign(setpoint=pd.Series([21.5], frame.index[96:97])))
    done = entry("import", "house", *AIR, "--out", "living")
    assert done.code == 0, done.stderr
    assert "setpoint.csv: its stamp is taken as %m/%d/%Y %H:%M, as the other files" in " ".join(done.stdout.split())
    setpoint = read(Path("living"))["setpoint_C"].dropna()
    assert setpoint.index[0] == pd.Timestamp("2026-01-11")
    shutil.rmtree("living")
    Path("house/setpoint.csv").write_text("time,value\n03/02/2026 00:00,21.5\n")
    refused(entry("import", "house", *AIR, "--out", "living"), "setpoint.csv", "day and month cannot be told apart")


@pytest.mark.parametrize("state", [0, "off"])
def test_a_state_that_was_logged_once_is_held_while_the_house_logs(
    state: object, frame: pd.DataFrame, entry: Entry
) -> None:
    once = pd.Series([state], frame.index[:1], dtype=object)
    per_sensor(frame.drop(columns="flow_L_h").assign(heating_valve=once))
    done = entry("import", "house", *AIR, "--out", "living")
    assert done.code == 0, done.stderr
    assert (read(Path("living"))["heating_signal"] == 0.0).all()


def test_another_lone_reading_is_left_out_and_named(frame: pd.DataFrame, entry: Entry) -> None:
    once = pd.Series([24.0], frame.index[:1])
    per_sensor(frame.assign(return_temperature=once))
    done = entry("import", "house", *AIR, "--out", "living")
    assert done.code == 0, done.stderr
    told = "one reading and no more: return_temperature in house/return_temperature.csv"
    assert told in " ".join(done.stderr.split())
    assert "return_temperature_C" not in read(Path("living"))


def test_a_source_of_one_row_is_refused(frame: pd.DataFrame, entry: Entry) -> None:
    refused(imported(entry, frame[:1]), "house.csv", "holds less than two rows of readings")
    refused(imported(entry, frame[:0]), "house.csv", "holds less than two rows of readings")
