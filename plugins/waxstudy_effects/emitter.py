"""What a real emitter does that is not believed: other water arrives, later, and the floor is covered."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from waxstudy.plugin import Belief, Effect, FloatArray, Inputs, Parameters, Prior, changed, parameter
from waxstudy_effects.description import changed_room, description, room_hindrance
from waxstudy_paper.room.construction import Layer

NO_RECORD = "nothing that drives the room is recorded"
PIECE_S = 10.0  # of an interval, in which water leaves a pipe
STANDING_S = 3600.0  # see PipeDelay
COVER_W_MK = 0.1  # of a cover's material; only its resistance counts
LEAST_COVER_M2K_W = 1e-6  # less is no layer at all


class SupplyOffsetParameters(Parameters):
    offset_K: float = parameter(
        0.0,
        unit="K",
        ge=-20.0,
        le=20.0,
        description="Added to the recorded supply temperature; above 0 the circuit gets warmer water than recorded.",
        source="chosen: a sensor strapped to the pipe, a mixing valve after it",
    )


class SupplyOffset(Effect):
    """The water that enters the circuit is `offset_K` warmer than recorded."""

    name = "supply-offset"
    api_version = "1.0"
    stage = "emitter"
    Parameters = SupplyOffsetParameters
    priors = {"offset_K": Prior(-8.0, 8.0, noticeable=0.3, as_built=0.3, varies=0.1)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return "" if belief.inputs else NO_RECORD

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        assert belief.inputs
        return replace(belief, inputs=replace(belief.inputs, supply_C=belief.inputs.supply_C + p.offset_K))

    @classmethod
    def sentence(cls, p: Any) -> str:
        other = "warmer" if p.offset_K > 0.0 else "colder"
        return f"The water enters the floor {abs(p.offset_K):.1f} K {other} than recorded."


class PipeDelayParameters(Parameters):
    volume_L: float = parameter(
        0.0,
        unit="L",
        ge=0.0,
        le=100.0,
        description="Water between the supply temperature's sensor and the circuit.",
        source="chosen: 0.2 L per metre of a pipe of 20 x 2 mm",
    )


class PipeDelay(Effect):
    """The supply temperature is that of the water which passed the sensor `volume_L` ago, cooled on its way.

    Plug flow: T(t) = air + (T_sensor(t') - air) exp(-(t - t') / 3600 s), where `volume_L` flowed between t' and t. The
    recorded flow drives it, also where a closed loop has a flow of its own; without a recorded flow it cannot apply.
    An hour is chosen: water and wall of a pipe of 20 x 2 mm hold 1.1 kJ/(m K) and lose 0.3 W/(m K), insulated as EN
    15316-3 has it for pipes in heated rooms. The water that fills the pipe at first passed the sensor at the first
    sample.
    """

    name = "pipe-delay"
    api_version = "1.0"
    stage = "emitter"
    Parameters = PipeDelayParameters
    priors = {"volume_L": Prior(0.0, 20.0, noticeable=0.5)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        if belief.inputs is None:
            return NO_RECORD
        return "no flow is recorded" if belief.inputs.flow_L_h is None else ""

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        assert belief.inputs
        if p.volume_L == 0.0:
            return belief
        return replace(belief, inputs=replace(belief.inputs, supply_C=after_pipe_C(belief.inputs, p.volume_L)))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"Between supply sensor and floor lie {p.volume_L:.1f} L of pipe, in which water is late and cools."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"volume_L": volume_L} for volume_L in (1.0, 4.0, 10.0)]


def after_pipe_C(inputs: Inputs, volume_L: float) -> FloatArray:
    """Return the temperature at the end of a pipe, of the water that leaves it in each interval.

    A plug may pass within an interval: the mean is taken over pieces of 10 s, all with the interval's flow and the
    temperature at its end, as a room takes its supply. So nothing changes as the volume goes to 0.
    """
    assert inputs.flow_L_h is not None
    count, pieces = len(inputs.supply_C), max(1, round(inputs.interval_s / PIECE_S))
    end_s = inputs.interval_s * np.arange(1.0, count + 1.0)
    time_s = inputs.interval_s / pieces * (np.arange(count * pieces) + 0.5)
    # a flow too small to matter, so that a time belongs to each volume while the water stands
    passed_L = np.cumsum(np.maximum(inputs.flow_L_h, 1e-6)) * inputs.interval_s / 3600.0
    left_L = np.interp(time_s, np.append(0.0, end_s), np.append(0.0, passed_L)) - volume_L
    entered_s = np.interp(left_L, np.append(0.0, passed_L), np.append(0.0, end_s))
    kept = np.exp(-(time_s - entered_s) / STANDING_S)
    of = np.clip(np.ceil(entered_s / inputs.interval_s).astype(int) - 1, 0, count - 1)
    entered_C, air_C = inputs.supply_C[of], np.repeat(inputs.air_C, pieces)
    return np.asarray((air_C + (entered_C - air_C) * kept).reshape(count, pieces).mean(axis=1))


class FloorCoverParameters(Parameters):
    resistance_m2K_W: float = parameter(
        0.0,
        unit="m2 K/W",
        ge=0.0,
        le=1.0,
        description="Thermal resistance of what lies on the floor.",
        source="chosen: EN 1264-2 has 0.1 for parquet and 0.15 for carpet",
    )


class FloorCover(Effect):
    """Something without mass lies on the heated floor: its resistance comes on top of the believed layers.

    The water-to-floor exchange stays as it was: the nominal output is stated for the believed layers.
    """

    name = "floor-cover"
    api_version = "1.0"
    stage = "emitter"
    Parameters = FloorCoverParameters
    priors = {"resistance_m2K_W": Prior(0.0, 0.4, noticeable=0.01, as_built=0.01)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return room_hindrance(belief)

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        if p.resistance_m2K_W < LEAST_COVER_M2K_W:
            return belief
        room = description(belief)
        cover = Layer(
            thickness_m=p.resistance_m2K_W * COVER_W_MK,
            conductivity_W_mK=COVER_W_MK,
            density_kg_m3=0.0,
            heat_capacity_J_kgK=1000.0,
        )
        covered = changed(room.floor, layers=(cover, *room.floor.layers))
        pipes = room.heated_floor.pipes_after_layer + 1
        return changed_room(
            belief,
            surfaces=tuple(covered if surface is room.floor else surface for surface in room.surfaces),
            heated_floor=changed(room.heated_floor, pipes_after_layer=pipes),
            circuit=changed(room.circuit, design_cover_m2K_W=room.design_cover_m2K_W),
        )

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"Something with a thermal resistance of {p.resistance_m2K_W:.3f} m²K/W lies on the floor."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"resistance_m2K_W": resistance} for resistance in (0.03, 0.1)]
