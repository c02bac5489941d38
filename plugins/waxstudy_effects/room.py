"""What a real room does that is not believed: air, sun, gains, mass and neighbours are others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from waxstudy.plugin import (
    Belief,
    Effect,
    FloatArray,
    Inputs,
    Parameters,
    Prior,
    changed,
    clock,
    open_share,
    parameter,
)
from waxstudy_effects.description import changed_room, description, room_hindrance
from waxstudy_effects.emitter import NO_RECORD
from waxstudy_paper.room.assembly import AIR_J_L_K
from waxstudy_paper.room.construction import Layer

DAY_H = 24.0
NEIGHBOUR_C = 21.0  # of a neighbour that nobody measured: a heated dwelling
HEAVIEST_KG_M3 = 20_000.0  # of a layer


def factor(description: str, source: str) -> Any:
    """Declare a factor, 1 as believed."""
    return parameter(1.0, unit="1", ge=0.0, le=100.0, description=description, source=source)


def with_heat(belief: Belief, heat_W: FloatArray) -> Belief:
    """Return the belief with more heat for the room's air."""
    assert belief.inputs
    before = 0.0 if belief.inputs.extra_W is None else belief.inputs.extra_W
    return replace(belief, inputs=replace(belief.inputs, extra_W=np.asarray(before + heat_W)))


class InfiltrationParameters(Parameters):
    factor: float = factor("Factor on the flow of outdoor air through leaks.", "chosen: leaks are seldom measured")


class Infiltration(Effect):
    """The room leaks `factor` times as much outdoor air as believed; ventilation and thermal bridges stay."""

    name = "infiltration"
    api_version = "1.0"
    stage = "room"
    Parameters = InfiltrationParameters
    priors = {"factor": Prior(0.1, 40.0, noticeable=1.5, is_log=True, as_built=0.6, varies=0.2)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        if problem := room_hindrance(belief):
            return problem
        return "" if description(belief).air.infiltration_L_s else "no infiltration is believed that could be another"

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        air = description(belief).air
        return changed_room(belief, air=changed(air, infiltration_L_s=p.factor * air.infiltration_L_s))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"The room leaks {p.factor:.1f} times as much outdoor air as believed."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"factor": 4.0}, {"factor": 15.0}]


class WindowOpeningParameters(Parameters):
    flow_L_s: float = parameter(
        0.0,
        unit="L/s",
        ge=0.0,
        le=1000.0,
        description="Outdoor air through the open window.",
        source="chosen: 10 to 60 L/s through a tilted window",
    )
    from_h: float = parameter(
        7.0, unit="h", ge=0.0, le=DAY_H, description="Hour of the day at which it is opened.", source="chosen"
    )
    to_h: float = parameter(
        8.0,
        unit="h",
        ge=0.0,
        le=DAY_H,
        description="Hour of the day at which it is closed; before `from_h`: of the next day.",
        source="chosen",
    )


class WindowOpening(Effect):
    """Every day between two hours an open window lets outdoor air in.

    Heat to the air: flow * 1.206 J/(L K) * (outdoor - air), with the recorded air, by the part of each interval that
    it is open. Opened and closed at the same hour it stays closed.
    """

    name = "window-opening"
    api_version = "1.0"
    stage = "room"
    Parameters = WindowOpeningParameters
    priors = {
        "flow_L_s": Prior(0.0, 100.0, noticeable=1.0),
        "from_h": Prior(0.0, 24.0, noticeable=0.5),
        "to_h": Prior(0.0, 24.0, noticeable=0.5),
    }

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return "" if belief.inputs else NO_RECORD

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        return {"flow_L_s": 0.0}  # at any hours

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        assert belief.inputs
        inputs = belief.inputs
        exchange_W_K = AIR_J_L_K * p.flow_L_s * open_share(inputs, p.from_h, p.to_h)
        return with_heat(belief, exchange_W_K * (inputs.outdoor_C - inputs.air_C))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return (
            f"Every day from {clock(p.from_h)} to {clock(p.to_h)} a window lets {p.flow_L_s:.0f} L/s of outdoor air in."
        )

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        hours = [(float(hour), lasting_h) for hour in range(24) for lasting_h in (1.0, 2.0, 4.0)]
        hours += [(6.0 * quarter, 8.0) for quarter in range(4)]
        starts = [{"flow_L_s": 10.0, "from_h": from_h, "to_h": (from_h + h) % DAY_H} for from_h, h in hours]
        return [*starts, {"flow_L_s": 1.0, "from_h": 0.0, "to_h": 0.999 * DAY_H}]  # open all day


class SolarFactorParameters(Parameters):
    factor: float = factor(
        "Factor on the sun that reaches the room.", "chosen: shading, dirt, a g-value for another angle"
    )


class SolarFactor(Effect):
    """The sun gives the room `factor` times the recorded or assumed heat; where it falls stays as believed."""

    name = "solar-factor"
    api_version = "1.0"
    stage = "room"
    absorbs = ("solar gain",)
    Parameters = SolarFactorParameters
    priors = {"factor": Prior(0.1, 5.0, noticeable=1.1, is_log=True, as_built=0.15, varies=0.03)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        if belief.inputs is None:
            return NO_RECORD
        is_known = belief.inputs.solar_W.any() and "solar_W" not in belief.inputs.stand_ins
        return "" if is_known else "no sun is recorded or assumed"

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        assert belief.inputs
        return replace(belief, inputs=replace(belief.inputs, solar_W=p.factor * belief.inputs.solar_W))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"The sun heats the room {p.factor:.2f} times as much as believed."


class GainShiftParameters(Parameters):
    shift_h: float = parameter(
        0.0,
        unit="h",
        ge=-12.0,
        le=12.0,
        description="How much later the gains come than believed; below 0 earlier.",
        source="chosen: people do not keep to schedules",
    )
    factor: float = factor("Factor on the internal gains.", "chosen: a household's gains differ by far more than half")


class GainShift(Effect):
    """Internal gains come `shift_h` later and are `factor` times the believed ones.

    gains(t) = factor * believed(t - shift), straight between samples; beyond the ends of the record the same hours of
    the nearest day.
    """

    name = "gain-shift"
    api_version = "1.0"
    stage = "room"
    absorbs = ("internal gains",)
    Parameters = GainShiftParameters
    priors = {
        "shift_h": Prior(-12.0, 12.0, noticeable=0.5, as_built=1.0, varies=0.4),
        "factor": Prior(0.1, 10.0, noticeable=1.15, is_log=True, as_built=0.3, varies=0.12),
    }

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        if belief.inputs is None:
            return NO_RECORD
        is_known = belief.inputs.gains_W.any() and "gains_W" not in belief.inputs.stand_ins
        return "" if is_known else "no internal gains are recorded or assumed"

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        assert belief.inputs
        gains_W = p.factor * later(belief.inputs, p.shift_h)
        return replace(belief, inputs=replace(belief.inputs, gains_W=gains_W))

    @classmethod
    def sentence(cls, p: Any) -> str:
        when = f"{abs(p.shift_h):.1f} h {'later' if p.shift_h >= 0.0 else 'earlier'}"
        return f"People and appliances heat the room {when} than believed and {p.factor:.2f} times as much."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"shift_h": shift_h, "factor": 1.0} for shift_h in (-8.0, -4.0, -1.5, 1.5, 4.0, 8.0)]


def later(inputs: Inputs, shift_h: float) -> FloatArray:
    """Return the gains moved by hours (n,)."""
    gains_W = inputs.gains_W
    per_day = round(86_400.0 / inputs.interval_s)
    ahead = min(per_day, len(gains_W))
    index = np.arange(len(gains_W), dtype=float) - shift_h * 3600.0 / inputs.interval_s
    padded = np.concatenate((gains_W[:ahead], gains_W, gains_W[-ahead:]))
    return np.asarray(np.interp(index + ahead, np.arange(len(padded)), padded))


class ThermalMassParameters(Parameters):
    factor: float = factor(
        "Factor on what stores heat in the room, besides the heated floor.",
        "chosen: furniture, boards and partitions are seldom known",
    )


class ThermalMass(Effect):
    """All that stores heat but the heated floor is `factor` times as heavy as believed.

    That is the capacity of air and furniture (a program's multiplier on the zone's air capacity, which stays 1 at
    least) and the mass of every layer of the other surfaces; resistances stay. Behind insulation it hardly counts, so
    that it is mostly furniture, boards and inner walls.
    """

    name = "thermal-mass"
    api_version = "1.0"
    stage = "room"
    Parameters = ThermalMassParameters
    priors = {"factor": Prior(0.3, 6.0, noticeable=1.2, is_log=True)}
    absorbs = ("air-capacity", "boards-capacity")

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return room_hindrance(belief)

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        room = description(belief)
        heavier = [
            surface
            if surface is room.floor
            else changed(surface, layers=tuple(heavier_layer(layer, p.factor) for layer in surface.layers))
            for surface in room.surfaces
        ]
        multiplier = min(50.0, max(1.0, p.factor * room.air.capacity_multiplier))
        return changed_room(belief, surfaces=tuple(heavier), air=changed(room.air, capacity_multiplier=multiplier))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"Furniture, boards and inner walls store {p.factor:.2f} times as much heat as believed."


def heavier_layer(layer: Layer, factor: float) -> Layer:
    """Return a layer with another mass and the same resistance."""
    return changed(layer, density_kg_m3=min(HEAVIEST_KG_M3, factor * layer.density_kg_m3))


class NeighbourHeatParameters(Parameters):
    conductance_W_K: float = parameter(
        0.0,
        unit="W/K",
        ge=0.0,
        le=200.0,
        description="Between the room's air and the neighbour.",
        source="chosen: an inner wall of 10 m2 without insulation has 20 W/K",
    )


class NeighbourHeat(Effect):
    """A neighbour's room exchanges heat with the air: G (T_neighbour - air), with the recorded air.

    The neighbour is at its recorded temperature, or at 21 C where none is recorded. Mass of the wall is left out.
    """

    name = "neighbour-heat"
    api_version = "1.0"
    stage = "room"
    Parameters = NeighbourHeatParameters
    priors = {"conductance_W_K": Prior(0.0, 40.0, noticeable=0.4)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return "" if belief.inputs else NO_RECORD

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        assert belief.inputs
        inputs = belief.inputs
        neighbour_C = NEIGHBOUR_C if inputs.neighbour_C is None else inputs.neighbour_C
        return with_heat(belief, p.conductance_W_K * (neighbour_C - inputs.air_C))

    @classmethod
    def sentence(cls, p: Any) -> str:
        at = f"at {NEIGHBOUR_C:g} C if its temperature is not recorded"
        return f"The room exchanges heat with a neighbour, {at}, through {p.conductance_W_K:.1f} W/K."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"conductance_W_K": conductance} for conductance in (3.0, 12.0)]


class ExtraHeatParameters(Parameters):
    heat_W: float = parameter(
        0.0,
        unit="W",
        ge=-10_000.0,
        le=10_000.0,
        description="Heat into the room at all times; below 0 heat that is taken out of it.",
        source="chosen: a device that never rests, a warm pipe, a cold store behind a wall",
    )
    radiant_share: float = parameter(
        0.0,
        unit="1",
        ge=0.0,
        le=1.0,
        description="Share that surfaces get instead of the air.",
        source="chosen: 0 of a fan heater, 0.5 to 0.8 of a warm surface",
    )


class ExtraHeat(Effect):
    """Something gives the room `heat_W` at all times, a part of it to its surfaces.

    Surfaces get it as they get the radiant part of internal gains: as much gains as have that part are added, and what
    they give to the air is taken from the air's. A room whose gains do not radiate has no way to them.
    """

    name = "extra-heat"
    api_version = "1.0"
    stage = "room"
    Parameters = ExtraHeatParameters
    # a fan heater gives 2 kW; nothing common takes as much
    priors = {"heat_W": Prior(-500.0, 2000.0, noticeable=10.0), "radiant_share": Prior(0.0, 1.0, noticeable=0.3)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        if belief.inputs is None:
            return NO_RECORD
        if problem := room_hindrance(belief):
            return problem
        radiates = description(belief).gains.radiant_share > 0.0
        return "" if radiates else "internal gains do not radiate in the believed room"

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        return {"heat_W": 0.0}  # whatever its share

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        assert belief.inputs
        gains_W = p.heat_W * p.radiant_share / description(belief).gains.radiant_share
        warmed = replace(belief, inputs=replace(belief.inputs, gains_W=belief.inputs.gains_W + gains_W))
        return with_heat(warmed, np.full(len(belief.inputs.outdoor_C), p.heat_W - gains_W))

    @classmethod
    def sentence(cls, p: Any) -> str:
        what = "Something heats" if p.heat_W > 0.0 else "Something cools"
        radiant = f"{100.0 * p.radiant_share:.0f} % of it by radiation"
        return f"{what} the room by {abs(p.heat_W):.0f} W at all times, {radiant}."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"heat_W": heat_W, "radiant_share": 0.3} for heat_W in (-100.0, -30.0, 30.0, 100.0)]
