"""The records of `benchmarks.channel_sets`: weeks of January to March in houses that stray from what is believed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
import pandas as pd

from benchmarks.self_consistency_records import NULL_CASES, TABLE, study
from waxstudy.dataset.channels import GLOBAL as LIGHT
from waxstudy.dataset.stand_ins import GAINS, SUN
from waxstudy.plugin import Choice, Effect, Facade, FloatArray, Room, Weather
from waxstudy.plugin.registry import installed
from waxstudy.study.model import Study
from waxstudy.synthetic.effects import with_effects
from waxstudy.synthetic.instruments import Instruments, measure
from waxstudy.synthetic.simulate import Reality
from waxstudy.synthetic.write import Telling, described

# channel set -> what of these three it has
SETS: Mapping[str, Sequence[str]] = {
    "all": (SUN, GAINS),
    "no sun": (GAINS,),
    "no gains": (SUN,),
    "neither": (),
    "sun as GHI": (LIGHT, GAINS),
    "GHI alone": (LIGHT,),
}
INTERVAL_S = 120.0  # of the samples: some effects of the chain last for two minutes
HEATS, DRAWS = 0.1, 20  # share of the time that the valve of a healthy loop is open, and draws of days until it is
CHAIN = ("sensor", "controller", "modulator", "actuator", "valve")
FIRST_DAY, LAST_DAY = pd.Timestamp("2001-01-02"), pd.Timestamp("2001-03-31")
SHIFT_K = 0.5  # of the setpoint, to either side
MOST_SD = 2.5  # that a house strays at most
HEAT_SD = {SUN: 0.07, GAINS: 0.05}  # that heat strays from what is recorded of it, as in the blind test
GAINS_W_M2, GAINS_LATER_H = (2.5, 6.0), 2.0  # nobody told how much goes on in this room, nor when


@dataclass(frozen=True)
class Made:
    """A record to make. All is drawn from its name."""

    name: str
    weather: Path
    days: int
    effect: str = ""
    values: Mapping[str, float] = field(default_factory=dict)
    believed: str = ""  # case; drawn where it is not said

    @property
    def random(self) -> np.random.Generator:
        return np.random.default_rng(crc32(self.name.encode()))

    @property
    def effects(self) -> list[Choice]:
        return [Choice.of(installed().components["effect", self.effect].component, self.values)] if self.effect else []


def nulls(count: int, weather: Path, days: int) -> list[Made]:
    return [Made(f"null-{number:03d}", weather, days) for number in range(count)]


def with_effect(count: int, weather: Path, days: int) -> list[Made]:
    """Return records with an effect of the chain each, in turn; first clear ones, then strong ones."""
    chosen = [
        (name, case, severity, values)
        for severity in (1, 2)
        for name, (case, three) in TABLE.items()
        if _stage(name) in CHAIN
        for values in (three[severity],)
    ]
    rounds = [(turn // len(chosen), *chosen[turn % len(chosen)]) for turn in range(count)]
    return [
        Made(f"{name}-{('clear', 'strong')[severity - 1]}-{turn}", weather, days, name, values, case)
        for turn, name, case, severity, values in rounds
    ]


def _stage(name: str) -> str:
    effect = installed().components["effect", name].component
    assert issubclass(effect, Effect)
    return effect.stage


@dataclass(frozen=True)
class House:
    """A record as it happened, what is told of it, and how the house strays from that."""

    reality: Reality
    telling: Telling
    departures: Mapping[str, float]
    light_W_m2: FloatArray  # at the end of every step
    seed: int

    def table(self, instruments: Instruments) -> pd.DataFrame:
        found = measure(self.reality, instruments)
        steps = round(instruments.interval_s / self.reality.week.step_s)
        found[LIGHT] = np.round(self.light_W_m2[: len(found) * steps].reshape(-1, steps).mean(axis=1), 1)
        return found

    def dataset(self, table: pd.DataFrame, instruments: Instruments) -> dict[str, Any]:
        """Return dataset.toml for the channels of a table."""
        names = [name for name in table.columns[1:] if name != LIGHT]
        about = described("record", self.telling, names, instruments)
        return about if LIGHT not in table else about | {"site": _site(self.telling.study)}


class NoHeating(ValueError):
    """No days were drawn on which a house has to heat, as where a valve lets by all that it needs."""


def house(made: Made) -> House:
    """Return what happens in a house on days when it has to heat; raise `NoHeating`, and as `with_effects` does."""
    random = made.random
    for _ in range(DRAWS):
        found = _drawn(made, random)
        if float(np.mean(found.reality.week.channels["opening"])) > HEATS:
            return found
    raise NoHeating(f"{made.name}: no days on which it heats")


def _drawn(made: Made, random: np.random.Generator) -> House:
    ours = study()
    first = FIRST_DAY + pd.Timedelta(days=int(random.integers((LAST_DAY - FIRST_DAY).days - made.days + 1)))
    case = ours.cases[made.believed or str(random.choice(NULL_CASES))]
    setpoint_C = round(ours.comfort.setpoint_C + float(random.uniform(-SHIFT_K, SHIFT_K)), 2)
    component = installed().components["weather", "epw"].component
    values = {"path": str(made.weather), "start": f"{first:%m-%d}", "days": made.days}
    weather = Choice.of(component, values)
    lived_in = _lived_in(ours.room, random)
    true = replace(ours, weeks={"days": weather}, room=lived_in)
    departures = _departures(ours.room, random)
    altered, reality = with_effects(true, case, ["days"], None, setpoint_C, made.effects, departures)
    documented = replace(true, room=ours.room)
    telling = Telling(documented, altered, case, ["days"], setpoint_C, made.effects)
    return House(reality, telling, departures, _light(weather, reality), int(random.integers(2**31)))


def _lived_in(room: Choice, random: np.random.Generator) -> Choice:
    """Return a room whose people are others than its papers say, at other hours."""
    gains = room.parameters.gains  # type: ignore[attr-defined]
    later = round(float(random.uniform(-GAINS_LATER_H, GAINS_LATER_H)))
    schedule = tuple(float(each) for each in np.roll(gains.schedule, later))
    mean = round(float(random.uniform(*GAINS_W_M2)), 2)
    return room.changed(gains=gains.model_copy(update={"mean_W_m2": mean, "schedule": schedule}))


def _departures(room: Choice, random: np.random.Generator) -> dict[str, float]:
    assert issubclass(room.component, Room)
    spreads = {each.name: each.sd for each in room.component.uncertainties(room.parameters)} | HEAT_SD
    return {name: sd * float(np.clip(random.normal(), -MOST_SD, MOST_SD)) for name, sd in spreads.items()}


def _light(weather: Choice, reality: Reality) -> FloatArray:
    """Return the light on level ground that a weather has."""
    assert issubclass(weather.component, Weather)
    record = weather.component.load(weather.parameters, {"ground": Facade(180.0, 0.0)})
    return np.repeat(record.irradiance_W_m2["ground"], round(record.interval_s / reality.week.step_s))


def _site(ours: Study) -> dict[str, float | str]:
    from pvlib.iotools import read_epw

    place = read_epw(ours.weeks["days"].parameters.path)[1]  # type: ignore[attr-defined]
    zone = f"Etc/GMT{-round(place['TZ']):+d}"
    return {"latitude": place["latitude"], "longitude": place["longitude"], "timezone": zone}
