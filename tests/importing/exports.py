"""One record as eight exports: what a house's software makes of the same week."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Callable, Mapping
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

ZONE = "Europe/Tallinn"
AHEAD = pd.Timedelta(hours=2)
CHANNELS = (
    "sensor_temperature_C",
    "setpoint_C",
    "heating_signal",
    "flow_L_h",
    "supply_temperature_C",
    "return_temperature_C",
    "outdoor_temperature_C",
)
TEMPERATURES = tuple(name for name in CHANNELS if name.endswith("_C"))
IN_HOME_ASSISTANT = {
    "sensor_temperature_C": "sensor.living_room_temperature",
    "setpoint_C": "sensor.living_room_setpoint",
    "heating_signal": "binary_sensor.living_room_valve",
    "flow_L_h": "sensor.living_room_flow_rate",
    "supply_temperature_C": "sensor.heating_supply_temperature",
    "return_temperature_C": "sensor.living_room_return_temperature",
    "outdoor_temperature_C": "sensor.outdoor_temperature",
}
BEDROOM = {"sensor_temperature_C": "sensor.bedroom_temperature", "heating_signal": "binary_sensor.bedroom_valve"}


class Export(NamedTuple):
    """What to import, and what the answers are that its files leave open."""

    source: Path
    stated: tuple[str, ...]  # options that answer the questions
    within: Mapping[str, float]  # how far a value may be off by the way of logging, by channel; 0.0051 for all others


def exports(record: pd.DataFrame, folder: Path) -> dict[str, Export]:
    """Write the exports of a record, a column per channel and an index of local standard time, into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    record = record[list(CHANNELS)]
    return {make.__name__: make(record, folder) for make in MAKERS}


# --- how things are logged ------------------------------------------------------------------------------


def on_change(values: pd.Series, least: float) -> pd.Series:
    """What a logger keeps that writes a value down when it has changed by so much."""
    kept, last = np.zeros(len(values), dtype=bool), np.inf
    for place, value in enumerate(values.to_numpy()):
        if abs(value - last) >= least:
            kept[place], last = True, value
    return values[kept]


def in_utc(times: pd.DatetimeIndex) -> pd.DatetimeIndex:
    return (times - AHEAD).tz_localize("UTC")


def on_off(values: pd.Series) -> pd.Series:
    return values.map({1.0: "on", 0.0: "off"})


# --- the eight ------------------------------------------------------------------------------------------


def home_assistant_csv(record: pd.DataFrame, folder: Path) -> Export:
    """The history that the page of Home Assistant saves: on change, in UTC, in Fahrenheit, of two rooms."""
    parts = []
    for entities in (IN_HOME_ASSISTANT, BEDROOM):
        for channel, entity in entities.items():
            values = record[channel] - (2.0 if entities is BEDROOM and channel in TEMPERATURES else 0.0)
            values = (1.8 * values + 32.0).round(1) if channel in TEMPERATURES else values
            logged = on_change(values, 1e-9)
            states = on_off(logged) if channel == "heating_signal" else logged.astype(str)
            parts.append(pd.DataFrame({"entity_id": entity, "state": states, "last_changed": in_utc(logged.index)}))
    long = pd.concat(parts).sort_values("last_changed", kind="stable")
    long["last_changed"] = long["last_changed"].dt.strftime("%Y-%m-%dT%H:%M:%S.000Z")
    path = folder / "history.csv"
    long.to_csv(path, index=False)
    return Export(path, ("--room", "living", "--timezone", ZONE), dict.fromkeys(TEMPERATURES, 0.03))


def home_assistant_database(record: pd.DataFrame, folder: Path) -> Export:
    path = folder / "home-assistant_v2.db"
    with closing(sqlite3.connect(path)) as base:
        base.executescript(
            "create table states_meta (metadata_id integer primary key, entity_id text);"
            "create table state_attributes (attributes_id integer primary key, shared_attrs text);"
            "create table states (state_id integer primary key, state text, last_updated_ts float, "
            "metadata_id integer, attributes_id integer);"
            "create table statistics_meta (id integer primary key, statistic_id text, unit_of_measurement text, "
            "has_mean integer, has_sum integer);"
            "create table statistics (id integer primary key, start_ts float, metadata_id integer, mean float);"
        )
        units = {name: "°C" for name in TEMPERATURES} | {"flow_L_h": "L/h"}
        for key, (channel, entity) in enumerate(IN_HOME_ASSISTANT.items(), 1):
            base.execute("insert into states_meta values (?, ?)", (key, entity))
            attributes = {"unit_of_measurement": units[channel]} if channel in units else {}
            base.execute("insert into state_attributes values (?, ?)", (key, json.dumps(attributes)))
            if channel == "outdoor_temperature_C":  # purged, but for the means of hours
                _statistics(base, record[channel], key, entity)
                continue
            logged = on_change(record[channel], 1e-9)
            states = on_off(logged) if channel == "heating_signal" else logged.map("{:g}".format)
            seconds = in_utc(logged.index).as_unit("ns").asi8 / 1e9
            rows = [(state, at, key, key) for state, at in zip(states, seconds, strict=True)]
            base.executemany(
                "insert into states (state, last_updated_ts, metadata_id, attributes_id) values (?, ?, ?, ?)", rows
            )
        base.commit()
    return Export(path, ("--timezone", ZONE), {"outdoor_temperature_C": 4.0})


def _statistics(base: sqlite3.Connection, values: pd.Series, key: int, entity: str) -> None:
    base.execute("insert into statistics_meta values (?, ?, '°C', 1, 0)", (key, entity))
    means = values.resample("h", closed="right").mean()
    rows = [(at, key, mean) for at, mean in zip(in_utc(means.index).as_unit("ns").asi8 / 1e9, means, strict=True)]
    base.executemany("insert into statistics (start_ts, metadata_id, mean) values (?, ?, ?)", rows)


def german_csv(record: pd.DataFrame, folder: Path) -> Export:
    names = {
        "sensor_temperature_C": "Raumtemperatur [°C]",
        "setpoint_C": "Sollwert [°C]",
        "heating_signal": "Ventil [%]",
        "flow_L_h": "Durchfluss [m³/h]",
        "supply_temperature_C": "Vorlauf [°C]",
        "return_temperature_C": "Rücklauf [°C]",
        "outdoor_temperature_C": "Außentemperatur [°C]",
    }
    wide = record.assign(heating_signal=100.0 * record["heating_signal"], flow_L_h=record["flow_L_h"] / 1000.0)
    path = folder / "Messwerte.csv"
    table = wide.rename(columns=names)
    table.insert(0, "Zeit", record.index.strftime("%d.%m.%Y %H:%M"))
    table.to_csv(path, index=False, sep=";", decimal=",", encoding="cp1252")
    return Export(path, (), {})


def workbook(record: pd.DataFrame, folder: Path) -> Export:
    units = ["", "°C", "°C", "0/1", "L/min", "°C", "°C", "°C"]
    names = ["Time", "Room temperature", "Setpoint", "Heating valve", "Flow", "Supply", "Return", "Outdoors"]
    wide = record.assign(flow_L_h=(record["flow_L_h"] / 60.0).round(6))
    rows = [["House of the example", *[""] * len(CHANNELS)], names, units]
    rows += [[time.to_pydatetime(), *values] for time, values in zip(wide.index, wide.to_numpy().tolist(), strict=True)]
    path = folder / "house.xlsx"
    pd.DataFrame(rows).to_excel(path, index=False, header=False, sheet_name="log")
    return Export(path, (), {})


def epoch_milliseconds(record: pd.DataFrame, folder: Path) -> Export:
    names = ["room_temp", "setpoint", "relay", "flow_lh", "supply_temp", "return_temp", "outdoor_temp"]
    wide = record.set_axis(names, axis="columns")
    wide.insert(0, "ts", in_utc(record.index).as_unit("ns").asi8 // 1_000_000)
    path = folder / "epoch.csv.gz"
    wide.to_csv(path, index=False)
    return Export(path, ("--timezone", ZONE), {})


def file_per_sensor(record: pd.DataFrame, folder: Path) -> Export:
    place = folder / "sensors"
    place.mkdir(exist_ok=True)
    for channel, entity in IN_HOME_ASSISTANT.items():
        values = on_off(record[channel]) if channel == "heating_signal" else record[channel]
        stamps = record.index.strftime("%Y-%m-%dT%H:%M:%S+02:00")
        pd.DataFrame({"value": values.to_numpy(), "time": stamps}).to_csv(
            place / f"{entity.partition('.')[2]}.csv", index=False
        )
    return Export(place, (), {})


def counter_of_litres(record: pd.DataFrame, folder: Path) -> Export:
    """A meter in tenths of a litre, which is read once a minute and begins anew when its battery is changed."""
    interval_h = (record.index[1] - record.index[0]) / pd.Timedelta(hours=1)
    litres = 4321.0 + (record["flow_L_h"].fillna(0.0) * interval_h).cumsum()
    anew = len(litres) // 2
    litres.iloc[anew:] -= litres.iloc[anew - 1]
    wide = record.drop(columns="flow_L_h").assign(water_meter_L=(10.0 * litres).apply(np.floor) / 10.0)
    path = folder / "meter.parquet"
    wide.rename_axis("time").reset_index().to_parquet(path, index=False)
    return Export(path, (), {"flow_L_h": 0.1 / interval_h + 1.0})


def on_change_of_a_tenth(record: pd.DataFrame, folder: Path) -> Export:
    parts = []
    for channel, entity in IN_HOME_ASSISTANT.items():
        logged = on_change(record[channel], 0.1 if channel in TEMPERATURES else 1e-9)
        stamps = logged.index.strftime("%Y-%m-%d %H:%M:%S")
        unit = "°C" if channel in TEMPERATURES else {"flow_L_h": "L/h"}.get(channel, "")
        parts.append(pd.DataFrame({"value": logged.to_numpy(), "unit": unit, "time": stamps, "sensor": entity}))
    path = folder / "on_change.csv"
    pd.concat(parts).sort_values("time", kind="stable").to_csv(path, index=False)
    return Export(path, (), dict.fromkeys(TEMPERATURES, 0.1))


MAKERS: tuple[Callable[[pd.DataFrame, Path], Export], ...] = (
    home_assistant_csv,
    home_assistant_database,
    german_csv,
    workbook,
    epoch_milliseconds,
    file_per_sensor,
    counter_of_litres,
    on_change_of_a_tenth,
)
