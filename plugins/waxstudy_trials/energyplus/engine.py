"""A room in EnergyPlus as an engine of the blind test, with what an engineer would honestly believe of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import date, timedelta
from importlib.util import find_spec
from typing import Any

import numpy as np

from waxstudy.plugin import BackendMissing, FloatArray
from waxstudy.plugin.trial import Cause, Engine, Scene, Staged
from waxstudy_trials.as_built import as_built, earlier, healthy
from waxstudy_trials.commissioning import fitted_valve
from waxstudy_trials.energyplus.blocks import STEP_S, flow_fraction
from waxstudy_trials.energyplus.causes import PUTS
from waxstudy_trials.energyplus.description import House, built
from waxstudy_trials.energyplus.drawn import drawn
from waxstudy_trials.energyplus.happened import WARM_UP_DAYS, Happened, held, kept
from waxstudy_trials.energyplus.room import WINDOW_M2, building
from waxstudy_trials.plant.people import lived_in
from waxstudy_trials.plant.weather import Weather, weather
from waxstudy_trials.put import logged_puts, scene_of, with_all, with_causes
from waxstudy_trials.when import whens

FIRST = date(2023, 1, 8)
SCATTERED = ("power", "furniture", "exchange", "leaks", "gains", "sun")  # otherwise, as built


class EnergyPlusRoom(Engine):
    """A corner room with a wet floor in EnergyPlus; on-off, or PI with a pulse in each period; a wax motor or none."""

    name = "energyplus-room"
    departs = ("actuator", "valve", "emitter", "room")
    has_baselines = True

    @classmethod
    def hindrance(cls) -> str:
        from waxstudy_energyplus.installation import installed_version

        if find_spec("waxstudy_enthalpy") is None:
            return "its wax motor is not installed: pip install ./plugins/waxstudy-enthalpy"
        try:
            installed_version()
        except BackendMissing as error:
            return str(error)
        return ""

    @classmethod
    def causes(cls) -> Sequence[Cause]:
        return [put.cause for put in PUTS.values()]

    @classmethod
    def draw(cls, random: np.random.Generator, names: Sequence[str], days: int) -> Scene:
        scene = scene_of(random, PUTS, names, days, gains_W=(40.0, 90.0))
        scene["house"] = drawn(random, names)
        return with_causes(scene, random, PUTS, names)

    @classmethod
    def draw_built(cls, random: np.random.Generator, names: Sequence[str], days: int) -> Scene:
        scene = scene_of(random, PUTS, names, days, gains_W=(40.0, 90.0))
        house = drawn(random, names)
        scene["house"] = {name: value for name, value in house.items() if name not in SCATTERED}
        scene |= {"as_built": as_built(random), "baseline": earlier(random, scene["day"])}
        return with_causes(scene, random, PUTS, names)

    @classmethod
    def baseline_of(cls, scene: Mapping[str, Any]) -> Scene | None:
        return healthy(scene)

    @classmethod
    def make(cls, scene: Mapping[str, Any]) -> Staged:
        house, differs = House(**scene["house"]), scene.get("as_built")
        puts = [(PUTS[each["name"]], each["values"]) for each in scene["causes"]]
        assumed, setpoint_C = _weather(scene), scene["setpoint_C"]
        true = lived_in(assumed, scene["seed"]) if differs else assumed
        happened = Happened(built(with_all(house, puts), differs), true, setpoint_C)
        rests = [built(with_all(house, [other for other in puts if other is not put]), differs) for put in puts]
        still = [happened.without(put, rest) for (put, _), rest in zip(puts, rests, strict=True)]
        whole = {name: kept(values) for name, values in (happened.channels | _inputs(assumed, setpoint_C)).items()}
        channels, without = logged_puts(whole, STEP_S, puts, still)
        return Staged(
            channels=channels,
            step_s=STEP_S,
            first_day=(FIRST + timedelta(days=scene["day"])).isoformat(),
            described={
                "nominal": nominal(house, setpoint_C),
                "building": {"use": "nzeb", **building(house.full_flow_L_h)},
            },
            effects=[None] * len(puts),
            without=without,
            when=whens(scene["causes"], channels, STEP_S),
        )


def _weather(scene: Mapping[str, Any]) -> Weather:
    random, days = np.random.default_rng(scene["seed"]), scene["days"] + WARM_UP_DAYS
    return weather(random, days, scene["outdoor_C"], scene["gains_W"], WINDOW_M2)


def _inputs(assumed: Weather, setpoint_C: float) -> dict[str, FloatArray]:
    """Return what is known or assumed besides."""
    sources = {
        "outdoor_C": assumed.outdoor_C,
        "supply_C": assumed.supply_C,
        "solar_gain_W": assumed.sun_W,
        "internal_gain_W": assumed.gains_W,
        "neighbour_C": assumed.neighbour_C,
        "setpoint_C": np.full(len(assumed.sun_W), setpoint_C),
    }
    return {name: held(values) for name, values in sources.items()}


# --- what is believed ---


def nominal(house: House, setpoint_C: float) -> dict[str, Any]:
    """Return the chain of its data sheets: the motor's of Table 2, the valve's curve as it was measured."""
    sensor = (
        {"use": "lag", "time_constant_s": house.lag_s} if house.lag_s else {"use": "delay", "delay_s": house.delay_s}
    )
    return {
        "sensor": sensor,
        **(_pi(house) if house.is_pi else {"controller": {"use": "on-off", "dead_band_K": house.band_K}}),
        "actuator": {"use": "variable-times", "product": house.product} if house.product else {"use": "ideal"},
        "valve": {"use": "quick-opening", **_fitted(house)} if house.curve != 1.0 else {"use": "linear"},
        "setpoint_C": setpoint_C,
    }


def _pi(house: House) -> dict[str, Any]:
    tuning = {"gain": house.gain_1_K, "integration_time_s": house.integration_s, "tracking_time_s": house.tracking_s}
    pulses = {"period_s": house.period_s, "min_pulse_s": house.min_pulse_s}
    return {"controller": {"use": "pi", **tuning}, "modulator": {"use": "pwm", **pulses}}


def _fitted(house: House) -> dict[str, float]:
    return fitted_valve(lambda opening: flow_fraction(house, opening), house.lift, house.authority)
