"""Claims about names: what people and their software call things is known, and what is something else is left alone."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from waxstudy.dataset.zones import zone_hint
from waxstudy.importing.layouts import readings_of
from waxstudy.importing.matching import matched
from waxstudy.importing.names import rooms_of
from waxstudy.importing.reading import Logged, Table
from waxstudy.importing.seen import level_unit, seen
from waxstudy.importing.units import conversion
from waxstudy.plugin import FloatArray

COUNT = 2000
MINUTE_NS = 60_000_000_000


def course(of: str) -> FloatArray:
    """Two thousand minutes of something."""
    hour, draw = np.arange(COUNT) / 60.0, np.random.default_rng(3)
    on = (np.sin(hour) > 0.3).astype(float)
    return {
        "room": 21.0 + 0.3 * np.sin(hour - 2.0) + draw.normal(0.0, 0.03, COUNT),
        "dial": 21.0 + (hour % 24.0 > 6.0),
        "valve": on,
        "share": 100.0 * np.clip(np.sin(hour), 0.0, 1.0),
        "supply": 30.0 + 5.0 * on + draw.normal(0.0, 0.05, COUNT),
        "return": 24.0 + 3.0 * on + draw.normal(0.0, 0.05, COUNT),
        "outdoors": 2.0 + 5.0 * np.sin(hour / 4.0) + draw.normal(0.0, 0.1, COUNT),
        "litres": np.cumsum(on),
        "other": 45.0 + draw.normal(0.0, 1.0, COUNT),
        "watts": 800.0 * on + 50.0,
    }[of]


# name, what it is, its unit, and the channel; "" for none
HOUSES = {
    "german": [
        ("sensor.wohnzimmer_temperatur", "room", "°C", "sensor_temperature_C"),
        ("sensor.wohnzimmer_sollwert", "dial", "°C", "setpoint_C"),
        ("binary_sensor.wohnzimmer_stellantrieb", "valve", "", "heating_signal"),
        ("sensor.vorlauftemperatur", "supply", "°C", "supply_temperature_C"),
        ("sensor.ruecklauftemperatur", "return", "°C", "return_temperature_C"),
        ("sensor.aussentemperatur", "outdoors", "°C", "outdoor_temperature_C"),
        ("sensor.waermemengenzaehler_volumen", "litres", "L", "flow_L_h"),
        ("sensor.wohnzimmer_luftfeuchtigkeit", "other", "%", ""),
    ],
    "finnish": [
        ("Olohuone huonelämpötila", "room", "°C", "sensor_temperature_C"),
        ("Olohuone asetusarvo", "dial", "°C", "setpoint_C"),
        ("Olohuone toimilaite", "valve", "", "heating_signal"),
        ("Menovesi", "supply", "°C", "supply_temperature_C"),
        ("Paluuvesi", "return", "°C", "return_temperature_C"),
        ("Ulkolämpötila", "outdoors", "°C", "outdoor_temperature_C"),
        ("Virtaus", "litres", "L", "flow_L_h"),
    ],
    "estonian": [
        ("Elutuba toatemperatuur", "room", "°C", "sensor_temperature_C"),
        ("Elutuba seadetemperatuur", "dial", "°C", "setpoint_C"),
        ("Elutuba ajam", "valve", "", "heating_signal"),
        ("Pealevoolu temperatuur", "supply", "°C", "supply_temperature_C"),
        ("Tagasivoolu temperatuur", "return", "°C", "return_temperature_C"),
        ("Välistemperatuur", "outdoors", "°C", "outdoor_temperature_C"),
        ("Põranda temperatuur", "return", "°C", "floor_surface_temperature_C"),
        ("Vooluhulk", "litres", "L", "flow_L_h"),
    ],
    "heat-pump": [
        ("climate.living_room:current_temperature", "room", "", "sensor_temperature_C"),
        ("climate.living_room:hvac_action", "valve", "", "heating_signal"),
        ("sensor.openweathermap_temperature", "outdoors", "°C", "outdoor_temperature_C"),
        ("sensor.heat_pump_flow_temperature", "supply", "°C", "supply_temperature_C"),
        ("sensor.heat_pump_power", "watts", "W", ""),
        ("sensor.living_room_battery", "other", "%", ""),
        ("sensor.solar_power", "watts", "W", "photovoltaic_power_W"),
    ],
    "building": [
        ("Zone 1 Temp", "room", "°C", "sensor_temperature_C"),
        ("Zone 1 Call", "valve", "", "heating_signal"),
        ("OAT", "outdoors", "°C", "outdoor_temperature_C"),
        ("HWS Temp", "supply", "°C", "supply_temperature_C"),
        ("HWR Temp", "return", "°C", "return_temperature_C"),
    ],
    "floor": [
        ("sensor.thermostat_temperature", "room", "°C", "sensor_temperature_C"),
        ("switch.floor_heating", "valve", "", "heating_signal"),
        ("sensor.floor_heating_valve_position", "share", "%", "displacement"),
        ("sensor.floor_temperature", "return", "°C", "floor_surface_temperature_C"),
        ("sensor.outside", "outdoors", "°C", "outdoor_temperature_C"),
    ],
}


@pytest.mark.parametrize("house", HOUSES.values(), ids=HOUSES)
def test_common_names_are_told_without_a_question(house: list[tuple[str, str, str, str]]) -> None:
    ns = np.arange(COUNT) * MINUTE_NS
    logged = [
        Logged(name, "a.csv", ns, course(of), np.arange(COUNT), unit, of == "valve", False)
        for name, of, unit, _ in house
    ]
    found = matched(seen(logged, {}), {}, "")
    assert {match.seen.entity: channel for channel, match in found.items()} == {
        name: channel for name, _, _, channel in house if channel
    }
    assert [channel for channel, match in found.items() if not match.is_sure] == []


def test_rooms_are_told_by_common_words_by_numbers_and_by_what_differs_twice() -> None:
    assert set(rooms_of(["sensor.kitchen_temperature", "sensor.hall_temperature", "sensor.outdoor"]).values()) == {
        "kitchen",
        "hall",
    }
    assert set(rooms_of(["Zone 1 Temp", "Zone 2 Temp"]).values()) == {"zone 1", "zone 2"}
    names = [f"{room}_{what}" for room in ("anna", "berta") for what in ("temperature", "setpoint")]
    assert rooms_of(names) == {name: name.partition("_")[0] for name in names}
    assert rooms_of(["supply_temperature", "return_temperature", "supply_flow", "return_flow"]) == {}


@pytest.mark.parametrize(
    ("unit", "quantity", "one"),
    [
        ("degF", "indoor", -17.2222),
        ("K", "water", -272.15),
        ("m³/h", "flow", 1000.0),
        ("L/min", "flow", 60.0),
        ("gpm", "flow", 227.1247),
        ("kW", "gain", 1000.0),
        ("BTU/h", "gain", 0.2931),
        ("%", "level", 0.01),
        ("0-10 V", "level", 0.1),
        ("0-255", "level", 1.0 / 255.0),
        ("10 L", "flow", 10.0),
        ("kWh", "gain", 1000.0),
    ],
)
def test_units_become_those_of_channels(unit: str, quantity: str, one: float) -> None:
    how = conversion(unit, quantity)  # type: ignore[arg-type]
    assert how is not None
    assert how.scale + how.offset == pytest.approx(one, rel=1e-4)
    assert how.is_counter is (unit in ("10 L", "kWh"))


@pytest.mark.parametrize(
    ("name", "unit"),
    [("V l/min", "l/min"), ("Regler %", "%"), ("Vorlauf °C", "°C"), ("Wand W", ""), ("Zone C", ""), ("%", "")],
)
def test_a_unit_may_stand_behind_a_blank_unless_it_is_one_letter(name: str, unit: str) -> None:
    ns, values = np.arange(COUNT) * MINUTE_NS, course("share")
    (found,) = seen([Logged(name, "a.csv", ns, values, np.arange(COUNT), "", False, False)], {})
    assert (found.unit, found.entity) == (unit, name)


@pytest.mark.parametrize(("name", "channel"), [("Regler %", "control_output"), ("X %", "heating_signal")])
def test_a_switch_in_per_cent_is_the_output_where_its_name_says_controller(name: str, channel: str) -> None:
    ns, values = np.arange(COUNT) * MINUTE_NS, 100.0 * course("valve")
    found = matched(seen([Logged(name, "a.csv", ns, values, np.arange(COUNT), "", False, False)], {}), {}, "")
    assert list(found) == [channel]
    assert found[channel].is_sure is (channel == "control_output")


def test_a_valve_that_rests_for_a_day_before_it_moves_is_seen_as_what_it_is() -> None:
    count = 150_000
    position = np.where(np.arange(count) < 110_000, 0.0, (np.arange(count) % 600) / 600.0)
    rows = np.arange(count)
    logged = Logged("valve position", "house.csv", rows * 1_000_000_000, position, rows, "", False, False)
    (found,) = seen([logged], {})
    assert not found.is_binary
    assert found.distinct == 600


@pytest.mark.parametrize(
    ("largest", "step", "channels"), [(255, 1.0, ["displacement"]), (251, 1.0, []), (255, 0.5, []), (400, 1.0, [])]
)
def test_a_level_in_whole_numbers_up_to_255_is_a_byte_and_others_beyond_100_are_not_taken(
    largest: int, step: float, channels: list[str]
) -> None:
    ns, values = np.arange(COUNT) * MINUTE_NS, np.resize(np.arange(largest, -1, -step), COUNT)
    (one,) = seen([Logged("Living valve", "a.csv", ns, values, np.arange(COUNT), "", False, False)], {})
    assert level_unit(one) == ("0-255" if channels else "")
    assert list(matched([one], {}, "")) == channels


def test_names_that_begin_as_a_number_goes_on_are_names() -> None:
    """Of T1 and E2 all letters may be in a stamp or a number."""
    frame = pd.DataFrame({"time": pd.date_range("2026-01-01", periods=6, freq="min"), "name": ["T1", "E2"] * 3})
    found = readings_of(Table("a.csv", frame.assign(value=[21.0, 1.0] * 3).astype({"time": str})), Path("a.csv"), None)
    assert {each.entity for each in found} == {"T1", "E2"}


@pytest.mark.parametrize(
    ("word", "near"),
    [
        ("istambul", "Europe/Istanbul"),
        ("Asia/Istambul", "Asia/Istanbul"),
        ("Europa/Istanbul", "Europe/Istanbul"),
        ("Asia/Berlin", "Europe/Berlin"),  # the city tells more than the region: not Asia/Bahrain
        ("singapur", "Asia/Singapore"),
    ],
)
def test_of_zones_with_one_city_the_one_of_the_region_is_meant(
    word: str, near: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    zones = ["Asia/Singapore", "Singapore", "Europe/Istanbul", "Asia/Istanbul", "Asia/Bahrain", "Europe/Berlin"]
    for order in (zones, zones[::-1]):  # they come as a set
        monkeypatch.setattr("waxstudy.dataset.zones.available_timezones", lambda names=order: names)
        assert zone_hint(word) == f"; did you mean '{near}'?"
