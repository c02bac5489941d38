"""A run of EnergyPlus, and what single stages of it would have done otherwise."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from waxstudy.plugin import FloatArray, SimulationError
from waxstudy.plugin.trial import Unmakeable
from waxstudy_trials.energyplus.blocks import STEP_S, Chain, Played, replayed, stages
from waxstudy_trials.energyplus.description import House
from waxstudy_trials.energyplus.room import run
from waxstudy_trials.plant.weather import PART_S, Weather
from waxstudy_trials.put import Put

if TYPE_CHECKING:
    from waxstudy_energyplus.record import Simulated

WARM_UP_DAYS = 3
DAY_STEPS = round(86_400 / STEP_S)
SHOWN = {  # what each stage of the chain gives, and the next one gets
    "sensor": "reading_C",
    "controller": "output",
    "modulator": "signal",
    "actuator": "opening",
    "valve": "flow_L_h",
}
GIVEN = dict(zip(SHOWN, ("sensed_C", *SHOWN.values()), strict=False))
UNTOUCHED = 1e-9  # the least change that a cause makes of a channel


class Happened:
    """A run of EnergyPlus, and what single stages of it would have done otherwise."""

    def __init__(self, house: House, assumed: Weather, setpoint_C: float) -> None:
        self.house, self.assumed, self.setpoint_C = house, assumed, setpoint_C
        chain = Chain(house, setpoint_C, _true(house, assumed))
        found = _simulated(house, assumed, setpoint_C, chain)
        output, signal, opening, self.flow_fraction, self.sensed_C = found.chain.T
        self.channels = {"output": output, "signal": signal, "opening": opening, **_of_room(house, assumed, found)}
        self.channels["flow_L_h"] = house.flow * house.full_flow_L_h * self.flow_fraction
        self.channels["reading_C"] = self.stage("sensor", house)

    def stage(self, name: str, house: House, given: FloatArray | None = None) -> FloatArray:
        """Return what a stage of another house makes of what it is given, or of what was recorded before it."""
        if given is None:
            given = self.sensed_C if name == "sensor" else self.channels[GIVEN[name]]
        found = replayed(stages(house, self.setpoint_C, _true(house, self.assumed))[name], given)
        return found * house.flow * house.full_flow_L_h if name == "valve" else found

    def without(self, put: Put, rest: House) -> dict[str, FloatArray]:
        """Return the channels that a cause changes, as they would be without it: its stage's, and all behind it."""
        if put.logger is not None:
            return {}
        found: dict[str, FloatArray] = {}
        given, fraction, first = None, self.flow_fraction, put.cause.stages[0]
        if first in SHOWN:
            for name in list(SHOWN)[list(SHOWN).index(first) :]:
                given = found[SHOWN[name]] = self.stage(name, rest, given)
            fraction = found["flow_L_h"] / (rest.flow * rest.full_flow_L_h)
        found |= _of_room(rest, self.assumed, _simulated(rest, self.assumed, self.setpoint_C, Played(fraction)))
        changed = {n: v for n, v in found.items() if np.max(np.abs(v - self.channels[n])) > UNTOUCHED}
        return {name: kept(values) for name, values in changed.items()}


def _simulated(house: House, assumed: Weather, setpoint_C: float, advance: Any) -> Simulated:
    try:
        return run(house, assumed, setpoint_C, advance)
    except (SimulationError, ValueError) as error:
        raise Unmakeable(str(error)) from error


def kept(values: FloatArray) -> FloatArray:
    return values[WARM_UP_DAYS * DAY_STEPS :]


def held(values: FloatArray) -> FloatArray:
    """Return the values of quarters of an hour at the chain's step."""
    return np.repeat(values, round(PART_S / STEP_S))


def _of_room(house: House, assumed: Weather, found: Simulated) -> dict[str, FloatArray]:
    """Return what EnergyPlus shows; where no water flows, the return stands at the floor's temperature."""
    from waxstudy_energyplus.chain import FLOW
    from waxstudy_energyplus.model import MINUTE_S
    from waxstudy_paper.room.hydronics import WATER_J_L_K

    per_minute = round(MINUTE_S / STEP_S)
    flow = found.chain[:, FLOW].reshape(-1, per_minute).mean(axis=1) * house.flow * house.full_flow_L_h
    per_K = np.repeat(flow / 3600.0 * WATER_J_L_K, per_minute)
    heat_W = np.repeat(found.minute("water_heat_W"), per_minute)
    supply_C = held(assumed.supply_C) + house.supply_K
    drop_K = np.divide(heat_W, per_K, out=np.zeros_like(per_K), where=per_K > 0.0)
    shown = {name: found.stepped(name) for name in ("air_C", "operative_C", "floor_surface_C")}
    return {**shown, "return_C": np.where(per_K > 0.0, supply_C - drop_K, found.stepped("layer_C"))}


def _true(house: House, assumed: Weather) -> Weather:
    return assumed._replace(sun_W=house.sun * assumed.sun_W)
