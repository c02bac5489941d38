"""The fast room: the library's own effects, and families outside it, in a room of the believed model.

The room strays from the believed one in all that nobody knows of it, as no room stands as it was described.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from waxstudy.plugin import Belief, Choice, Effect, Facade, FloatArray, Inputs, Room, SimulationError, Weather
from waxstudy.plugin.registry import PluginError, installed
from waxstudy.plugin.trial import Cause, Engine, Scene, Staged, Unmakeable
from waxstudy.simulation.run import InputError
from waxstudy.study.model import Study
from waxstudy.study.read import read_study
from waxstudy.synthetic.effects import EffectError, with_effects
from waxstudy.synthetic.simulate import RealityError
from waxstudy.synthetic.write import Telling
from waxstudy_trials.as_built import MOST_SD
from waxstudy_trials.families import FAMILIES, Family, logged
from waxstudy_trials.severity import severity
from waxstudy_trials.when import whens

OUTDOOR_C = (-10.0, 4.0)  # means of the weeks
CLEAR_DAY = {"january": 0.08, "february": 0.4}  # kWh/m2 of a day with nearly all of the sun that there can be
GAINS_W_M2 = (2.5, 6.0)
SHIFT_K = 0.7  # of the setpoint, to either side
WEEK_DAYS = 7
SITE = {"latitude": 59.4, "longitude": 24.8, "timezone": "Etc/GMT-2"}  # of weather `tallinn-week`
# how far heat strays from what is recorded of it, as the logarithm of a factor, whatever the causes are
HEAT_SD = {
    "internal_gain_W": 0.05,  # what a meter of plugs and a count of people leave open
    "solar_gain_W": 0.07,  # panes' g and shadows, where the irradiance was measured
}


class FastRoom(Engine):
    """The paper's room and chains with effects of the library in them: the same code makes and fits these records.

    What nobody knows of the room, and of its gains and sun, strays alike in nulls and where there are causes.
    """

    name = "fast-room"
    lit_days = WEEK_DAYS  # the second week is of other days than its dates say

    @classmethod
    def causes(cls) -> Sequence[Cause]:
        ours = [Cause(effect.name, (effect.stage,)) for effect in effects().values()]
        return [*ours, *(family.cause() for family in FAMILIES.values())]

    @classmethod
    def draw(cls, random: np.random.Generator, names: Sequence[str], days: int) -> Scene:
        places = list(study().cases)
        scene: Scene = {
            "weeks": [_week(random) for _ in range(2)],
            "gains_W_m2": round(float(random.uniform(*GAINS_W_M2)), 2),
            "shift_K": round(float(random.uniform(-SHIFT_K, SHIFT_K)), 2),
            "days": days,
            "departures": {name: _strayed(random) for name in _spreads()},
        }
        fitting = [case for case in places if all(_applies(name, case) for name in names)]
        if not fitting:
            raise Unmakeable(f"no case that {' and '.join(names)} apply to together")
        case = str(random.choice(fitting))
        belief = _belief(case)
        causes = [{"name": name, "values": severity(edit(name), belief, random)} for name in names]
        return {**scene, "believed": case, "causes": causes}

    @classmethod
    def make(cls, scene: Mapping[str, Any]) -> Staged:
        ours = _study(scene)
        case, weeks = ours.cases[scene["believed"]], list(ours.weeks)
        setpoint_C = ours.comfort.setpoint_C + scene["shift_K"]
        choices = [Choice.of(edit(each["name"]), each["values"]) for each in scene["causes"]]
        edits = [None if _is_logger(choice) else choice for choice in choices]
        inside = [choice for choice in edits if choice is not None]
        departures = {name: sd * _spreads()[name] for name, sd in scene["departures"].items()}
        try:
            true, reality = with_effects(ours, case, weeks, scene["days"], setpoint_C, inside, departures)
        except (EffectError, RealityError, PluginError, SimulationError, InputError) as error:
            raise Unmakeable(str(error)) from error
        channels, without = logged(reality.week.channels, reality.week.step_s, choices)
        telling = Telling(ours, true, case, weeks, setpoint_C)
        channels = {**channels, "global_W_m2": _light(ours, len(channels["outdoor_C"]), reality.week.step_s)}
        described = {"nominal": telling.nominal(), "room": ours.room.described(), "site": SITE}
        acts = whens(scene["causes"], channels, reality.week.step_s)
        kept = channels, reality.week.step_s, reality.first_day, described
        return Staged(*kept, edits, without, when=acts, departures=departures)


def _light(ours: Study, count: int, step_s: float) -> FloatArray:
    """Return the light on level ground at the end of every step (count,)."""
    weeks = []
    for week in ours.weeks.values():
        assert issubclass(week.component, Weather)
        record = week.component.load(week.parameters, {"ground": Facade(180.0, tilt_deg=0.0)})
        weeks.append(np.repeat(record.irradiance_W_m2["ground"], round(record.interval_s / step_s)))
    return np.concatenate(weeks)[:count]


def _is_logger(choice: Choice) -> bool:
    return issubclass(choice.component, Family) and choice.component.is_logger


@cache
def effects() -> Mapping[str, type[Effect]]:
    """Return the effects of the library by name."""
    found = {name: entry.component for (kind, name), entry in installed().components.items() if kind == "effect"}
    return {name: effect for name, effect in sorted(found.items()) if issubclass(effect, Effect)}


def edit(name: str) -> type[Effect]:
    """Return an effect of the library or a family."""
    return FAMILIES[name] if name in FAMILIES else effects()[name]


@cache
def _spreads() -> Mapping[str, float]:
    """Return the standard deviation of all that strays: the room's own uncertainties, and its heat."""
    room = study().room
    assert issubclass(room.component, Room)
    return {each.name: each.sd for each in room.component.uncertainties(room.parameters)} | HEAT_SD


def _strayed(random: np.random.Generator) -> float:
    """Return a departure in standard deviations; one that would lie farther off lies there."""
    return round(float(np.clip(random.normal(), -MOST_SD, MOST_SD)), 3)


def _week(random: np.random.Generator) -> dict[str, Any]:
    return {
        "month": str(random.choice(["january", "february"])),
        "outdoor_mean_C": round(float(random.uniform(*OUTDOOR_C)), 1),
        "sun_by_day": [round(float(share), 2) for share in random.uniform(0.0, 1.0, WEEK_DAYS) ** 2],
        "seed": int(random.integers(2**31)),
    }


@cache
def study() -> Study:
    return read_study(Path(__file__).with_name("fast_room.toml"), installed())


def _study(scene: Mapping[str, Any]) -> Study:
    """Return the study with a scene's weather and gains."""
    ours = study()
    weeks = {f"week {n + 1}": _weather(ours.weeks[each["month"]], each) for n, each in enumerate(scene["weeks"])}
    gains: Any = ours.room.parameters
    changed = gains.gains.model_copy(update={"mean_W_m2": scene["gains_W_m2"]})
    return replace(ours, weeks=weeks, room=ours.room.changed(gains=changed))


def _weather(month: Choice, each: Mapping[str, Any]) -> Choice:
    sun = max(0.01, CLEAR_DAY[each["month"]] * sum(each["sun_by_day"]))
    values = {name: each[name] for name in ("outdoor_mean_C", "sun_by_day", "seed")}
    return month.changed(solar_gain_kWh_m2_week=sun, **values)


@cache
def _belief(case: str) -> Belief:
    """Return what is believed of a case, with a day of inputs so that every effect can say whether it applies."""
    day = np.full(1440, 20.0)
    inputs = Inputs(60.0, 0.0, day - 25.0, day + 10.0, day, day, day, flow_L_h=day)
    return Belief(study().cases[case].blocks, study().room, inputs)


@cache
def _applies(name: str, case: str) -> bool:
    return not edit(name).hindrance(_belief(case))
