"""The measured house: real noise and real form, with what is recorded of it altered."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.read import Dataset, read_dataset
from waxstudy.plugin import FloatArray
from waxstudy.plugin.trial import Cause, Engine, Scene, Staged
from waxstudy.results.atomic import scratch_folder
from waxstudy_trials.family import Channels
from waxstudy_trials.put import Range

DESCRIPTION = Path(__file__).parents[2] / "studies" / "measured_house" / "dataset.toml"
RECORD = "o5_2019-02-01_to_10.csv"
DATA = "WAXSTUDY_DATA"  # folder of data sets that are no part of this repository
HOUR_S = 3600.0
ROOM = ("air_C", "operative_C")

Values = Mapping[str, float]
Alter = Callable[[Channels, Values, float], dict[str, FloatArray]]


def supply(channels: Channels, v: Values, step_s: float) -> dict[str, FloatArray]:
    """The manifold's sensor shows less than the water has."""
    return {"supply_C": channels["supply_C"] - v["offset_K"]}


def sun(channels: Channels, v: Values, step_s: float) -> dict[str, FloatArray]:
    """The sun is written down as what it is over a factor."""
    return {"solar_gain_W": channels["solar_gain_W"] / v["factor"]}


def gains(channels: Channels, v: Values, step_s: float) -> dict[str, FloatArray]:
    """Gains are written down too early and too small."""
    steps = round(v["shift_h"] * HOUR_S / step_s)
    return {"internal_gain_W": _moved(channels["internal_gain_W"], -steps) / v["factor"]}


def bias(channels: Channels, v: Values, step_s: float) -> dict[str, FloatArray]:
    """All thermometers of the rooms read too warm."""
    return {name: channels[name] + v["bias_K"] for name in ROOM}


def lag(channels: Channels, v: Values, step_s: float) -> dict[str, FloatArray]:
    """All thermometers of the rooms follow as a first-order lag."""
    return {name: _lagged(channels[name], v["time_constant_s"] / step_s) for name in ROOM}


def clock(channels: Channels, v: Values, step_s: float) -> dict[str, FloatArray]:
    """The logger of the rooms is late."""
    steps = round(v["late_h"] * HOUR_S / step_s)
    return {name: _moved(channels[name], steps) for name in ROOM}


def _moved(values: FloatArray, steps: int) -> FloatArray:
    """Return values so many steps later; what comes from beyond the record is missing."""
    found = np.roll(values, steps)
    found[slice(0, steps) if steps > 0 else slice(len(found) + steps, None)] = np.nan
    return found


def _lagged(values: FloatArray, steps: float) -> FloatArray:
    found, now = np.array(values), float(values[0])
    for place, value in enumerate(values):
        now += (value - now) * (1.0 - np.exp(-1.0 / max(steps, 1e-3))) if np.isfinite(value) else 0.0
        found[place] = now if np.isfinite(value) else np.nan
    return found


ALTERED: Mapping[str, tuple[Cause, Alter, Mapping[str, Range]]] = {
    "supply-offset": (
        Cause("supply-offset", ("emitter", "room")),
        supply,
        {"offset_K": Range(0.5, 6.0, is_signed=True)},
    ),
    "solar-factor": (
        Cause("solar-factor", ("room",)),
        sun,
        {"factor": Range(0.2, 2.5, is_signed=True, is_factor=True)},
    ),
    "gain-shift": (
        Cause("gain-shift", ("room",)),
        gains,
        {"shift_h": Range(1.0, 10.0, is_signed=True), "factor": Range(0.2, 3.0, is_factor=True)},
    ),
    "sensor-bias": (Cause("sensor-bias", ("sensor",)), bias, {"bias_K": Range(0.2, 2.0, is_signed=True)}),
    "sensor-lag": (Cause("sensor-lag", ("sensor",)), lag, {"time_constant_s": Range(600.0, 7200.0)}),
    "late-clock": (
        Cause("late-clock", ("room", "emitter"), is_family=True),
        clock,
        {"late_h": Range(0.5, 8.0, is_signed=True)},
    ),
}


class MeasuredHouse(Engine):
    """Twin House O5 (Fraunhofer IBP), ten days of February 2019; nothing is believed of its controls."""

    name = "measured-house"
    is_measured = True
    interval_s = 600.0
    days = (6, 8)  # whole ones; it began in the middle of one and ends just before another

    @classmethod
    def hindrance(cls) -> str:
        if not DESCRIPTION.exists():
            return "the description of the measured house is no part of an installed waxstudy: run from its repository"
        if not record_path().exists():
            return (
                f"the record of the measured house is not there: {DATA} names the folder with measured_house/{RECORD}"
            )
        return ""

    @classmethod
    def causes(cls) -> Sequence[Cause]:
        return [cause for cause, _, _ in ALTERED.values()]

    @classmethod
    def draw(cls, random: np.random.Generator, names: Sequence[str], days: int) -> Scene:
        scene: Scene = {"days": days, "first": int(random.integers(0, cls.days[1] - days + 1))}
        causes = [
            {"name": name, "values": {key: each.drawn(random) for key, each in ALTERED[name][2].items()}}
            for name in names
        ]
        return {**scene, "causes": causes}

    @classmethod
    def make(cls, scene: Mapping[str, Any]) -> Staged:
        house = measured()
        steps = round(86_400 / house.interval_s)
        start = first_midnight(house) + scene["first"] * steps
        rows = slice(start, start + scene["days"] * steps)
        channels: Channels = {
            CHANNELS[str(name)].source: column.to_numpy(dtype=float) for name, column in house.values.items()
        }
        without: list[Channels] = []
        for each in scene["causes"]:
            changed = ALTERED[each["name"]][1](channels, each["values"], house.interval_s)
            without.append({name: channels[name][rows] for name in changed})
            channels = {**channels, **changed}
        assert house.room
        return Staged(
            channels={name: values[rows] for name, values in channels.items()},
            step_s=house.interval_s,
            first_day=house.time[rows][0].date().isoformat(),
            described={
                "dataset": {"room_tolerance": house.room_tolerance},
                "nominal": {},
                "room": house.room.described(),
            },
            effects=[None] * len(without),
            without=without,
            inputs=house.assumed,
            is_measured=True,
        )


def record_path() -> Path:
    folder = os.environ.get(DATA)
    data = Path(folder) if folder else DESCRIPTION.parents[3] / "shared" / "data"
    return data / "measured_house" / RECORD


def first_midnight(house: Dataset) -> int:
    """Return the place of the first sample whose interval began at a midnight."""
    import pandas as pd

    begins = house.time - pd.Timedelta(seconds=house.interval_s)
    return int(np.flatnonzero(begins == begins.normalize())[0])


@cache
def measured() -> Dataset:
    """Return the record as it was measured."""
    with scratch_folder("waxstudy-house-") as place:
        shutil.copy(DESCRIPTION, place)
        shutil.copy(record_path(), place)
        return read_dataset(place)
