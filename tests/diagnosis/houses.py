"""Houses with several rooms, made for tests: two stores each, one weather, a thermostat and a day of their own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

STEP_S = 600
BEGIN = pd.Timestamp("2021-01-11")  # a Monday


@dataclass(frozen=True)
class Event:
    """What happens in a room: heat [W], or air from outside [W/K], or a thermometer's step [K], in spans of hours."""

    room: int
    spans_h: Sequence[tuple[float, float]]
    heat_W: float = 0.0
    outside_W_K: float = 0.0
    sensor_K: float = 0.0
    setback_K: float = 0.0

    def acts(self, hour: float) -> bool:
        return any(begin <= hour < end for begin, end in self.spans_h)


def made(seed: int, days: int = 12, rooms: int = 5, events: Sequence[Event] = ()) -> pd.DataFrame:
    """Return a record by time: outdoors, sun, and of each room its air [C] and own heat [W], as measured."""
    rng = np.random.default_rng(seed)
    count = days * 86_400 // STEP_S
    hour = np.arange(count) * STEP_S / 3600.0
    outdoor_C = 2.0 + 4.0 * np.sin(2 * np.pi * (hour - 9.0) / 24.0) + _wandering(rng, count, 3.0, 40.0)
    cloud = rng.uniform(0.1, 1.0, days)[(hour // 24).astype(int)]
    sun = np.maximum(0.0, np.sin(2 * np.pi * (hour - 6.0) / 24.0)) * 600.0 * cloud
    columns = {"outdoor_temperature_C": outdoor_C + rng.normal(0.0, 0.1, count), "sun": sun}
    airs, gains = _rooms(rng, hour, outdoor_C, sun, rooms, events)
    for room in range(rooms):
        steps = sum(each.sensor_K * np.array([each.acts(h) for h in hour]) for each in events if each.room == room)
        columns[f"room{room}"] = np.round(airs[room] + steps + rng.normal(0.0, 0.05, count), 1)
        columns[f"gain{room}"] = np.round(gains[room])
    time = BEGIN + pd.to_timedelta((np.arange(count) + 1) * STEP_S, "s")
    return pd.DataFrame(columns, index=pd.DatetimeIndex(time, name="time"))


def _rooms(
    rng: np.random.Generator,
    hour: np.ndarray,
    outdoor_C: np.ndarray,
    sun: np.ndarray,
    rooms: int,
    events: Sequence[Event],
) -> tuple[np.ndarray, np.ndarray]:
    """Return air (rooms, n) [C] and own heat (rooms, n) [W]; per room a store of air and one of its structure."""
    count = len(hour)
    of_air, of_mass = rng.uniform(70.0, 130.0, rooms), rng.uniform(1500.0, 3000.0, rooms)  # Wh/K
    outside, inside = rng.uniform(10.0, 20.0, rooms), rng.uniform(80.0, 140.0, rooms)  # W/K
    between, window_m2 = 8.0, rng.uniform(0.2, 0.8, rooms)
    target = rng.uniform(20.0, 22.0, rooms)
    gains = _gains(rng, hour, rooms)
    unknown = np.array([_wandering(rng, count, 25.0, 2.0) for _ in range(rooms)])
    air, mass, heating = target.copy(), target - 0.3, np.full(rooms, 200.0)
    airs = np.zeros((rooms, count))
    step_h = STEP_S / 3600.0
    for i in range(count):
        heat = gains[:, i] + unknown[:, i] + window_m2 * sun[i]
        aim = target.copy()
        for each in events:
            if each.acts(hour[i]):
                heat[each.room] += each.heat_W + each.outside_W_K * (outdoor_C[i] - air[each.room])
                aim[each.room] -= each.setback_K
        # floor heating: slow, and its thermostat sees to the air
        heating += step_h / 3.0 * (np.clip(250.0 * (aim - air) + 180.0, 0.0, 700.0) - heating)
        flow = inside * (mass - air) + outside * (outdoor_C[i] - air) + between * (air.mean() - air)
        mass = mass + step_h * (inside * (air - mass) + heating) / of_mass
        air = air + step_h * (flow + heat) / of_air
        airs[:, i] = air
    return airs, gains


def _gains(rng: np.random.Generator, hour: np.ndarray, rooms: int) -> np.ndarray:
    """Return own heat (rooms, n) [W]: an evening that comes every day, and what comes at random."""
    count = len(hour)
    found = np.zeros((rooms, count))
    for room in range(rooms):
        begin, length = rng.uniform(16.0, 20.0), rng.uniform(2.0, 5.0)
        found[room] += rng.uniform(50.0, 150.0) * ((hour % 24.0 >= begin) & (hour % 24.0 < begin + length))
        for at in rng.integers(0, count - 18, count // 72):
            found[room, at : at + rng.integers(2, 18)] += rng.uniform(50.0, 300.0)
    return found


def _wandering(rng: np.random.Generator, count: int, sd: float, length_h: float) -> np.ndarray:
    kept = np.exp(-STEP_S / 3600.0 / length_h)
    found = np.zeros(count)
    for i in range(1, count):
        found[i] = kept * found[i - 1] + (1.0 - kept**2) ** 0.5 * rng.normal(0.0, sd)
    return found


def toml(rooms: int) -> str:
    """Return the dataset.toml of such a record."""
    lines = ['[dataset]\nname = "made"\n[neighbours]\nsun = ["sun"]\n']
    for room in range(rooms):
        own = f'air_temperature_C = "room{room}"\ninternal_gain_W = "gain{room}"\n'
        lines.append(f"[neighbours.room{room}]\n{own}")
    return "".join(lines)


Truth = Mapping[int, Sequence[tuple[float, float]]]
