"""What an effect is tried on: chains and rooms made of the installed components; and what they do."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from waxstudy.conformance.drive import interpreted
from waxstudy.plugin import (
    CHAIN,
    Belief,
    Block,
    Choice,
    Component,
    FloatArray,
    Inputs,
    LinearRoom,
    OutsideRoom,
    Role,
    Room,
)
from waxstudy.plugin.registry import PluginError, Registry, installed, told
from waxstudy.simulation.records import plain_parameters

STEP_S = 60.0
STEPS = 600
SETPOINT_C = 21.0
INTERVAL_S = 300.0
INTERVALS = 576
FULL_FLOW_L_H = 120.0


def beliefs() -> Iterator[Belief]:
    """Yield beliefs of every installed component: each controller with each modulator and each other block alone."""
    registry = installed()
    rooms = [choice for choice in _choices(registry, "room") if not issubclass(choice.component, OutsideRoom)]
    room = rooms[0] if rooms else None
    inputs = _inputs_of(room)
    others = [{}, *({kind: choice} for kind in ("sensor", "actuator", "valve") for choice in _choices(registry, kind))]
    modulators = [{}, *({"modulator": choice} for choice in _choices(registry, "modulator"))]
    for controller in _choices(registry, "controller"):
        for modulator in modulators:
            for other in others:
                blocks: Mapping[str, Choice] = {"controller": controller, **modulator, **other}
                yield Belief({kind: blocks[kind] for kind in CHAIN if kind in blocks}, room, inputs)
    for other_room in rooms[1:]:
        yield Belief({}, other_room, _inputs_of(other_room))


def _inputs_of(choice: Choice | None) -> Inputs:
    """Return sample inputs, without sun and gains for a room that takes none; of a broken one nothing is known."""
    inputs = sample_inputs()
    try:
        with told():
            room = _built(choice) if choice else None
            sun, gains = (float(room is None or room.takes(role)) for role in (Role.SUN, Role.GAINS))
    except PluginError:
        return inputs
    return replace(inputs, solar_W=sun * inputs.solar_W, gains_W=gains * inputs.gains_W)


def _built(choice: Choice) -> LinearRoom:
    assert issubclass(choice.component, Room)
    return choice.component.build(choice.parameters)


def _choices(registry: Registry, kind: str) -> Iterator[Choice]:
    """Yield each component of a kind with its first example; one that cannot be had so is left out."""
    for name in registry.names(kind):
        component = registry.components[kind, name].component
        if choice := _first(component):
            yield choice


def _first(component: type[Component]) -> Choice | None:
    try:
        with told():
            return Choice.of(component, next(iter(component.examples.values())))
    except PluginError:
        return None


def sample_inputs() -> Inputs:
    """Return two days in which everything that drives a room changes, with a flow that starts and stops."""
    hour = (np.arange(INTERVALS) + 1.0) * INTERVAL_S / 3600.0
    day = np.sin(2.0 * np.pi * (hour - 9.0) / 24.0)
    return Inputs(
        interval_s=INTERVAL_S,
        start_s=0.0,
        outdoor_C=-5.0 + 4.0 * day,
        supply_C=30.0 - day + 0.5 * np.sin(hour),
        solar_W=300.0 * np.clip(day, 0.0, None),
        gains_W=40.0 + 25.0 * np.sign(np.sin(hour / 3.0)),
        ventilation_C=18.0 + 0.2 * day,
        air_C=SETPOINT_C + 0.5 * day,
        flow_L_h=np.where(np.sin(1.7 * hour) > 0.0, FULL_FLOW_L_H, 0.0),
        neighbour_C=19.0 + 0.5 * day,
    )


def outcome(belief: Belief) -> dict[str, FloatArray]:
    """Return what a belief does: each block's output on a temperature that comes and goes, the flow, the room."""
    minutes = np.arange(STEPS)
    signal = list(SETPOINT_C + 1.5 * np.sin(minutes / 40.0) + 0.4 * np.sin(minutes / 170.0))
    shown: dict[str, FloatArray] = {}
    for kind in CHAIN if "controller" in belief.blocks else ():
        if kind == "controller":
            signal = [SETPOINT_C - value for value in signal]
        if kind in belief.blocks:
            signal = _driven(belief.blocks[kind], signal)
        shown[kind] = np.array(signal)
    return shown if belief.room is None else shown | _room(belief.room, belief.inputs, shown.get("valve"))


def _driven(choice: Choice, signal: list[float]) -> list[float]:
    block: Any = choice.component
    assert issubclass(block, Block)
    return interpreted(block, plain_parameters(choice.parameters), signal, STEP_S)


def _room(choice: Choice, inputs: Inputs | None, fraction: FloatArray | None) -> dict[str, FloatArray]:
    from waxstudy.simulation.recorded import driven_by, respond

    room = _built(choice)
    shown = {} if fraction is None else {"flow_L_h": fraction * room.full_flow_L_h}
    if inputs is not None and inputs.flow_L_h is not None:
        found = respond(driven_by(room, inputs), inputs, inputs.flow_L_h)
        shown |= {name: values for name, values in found.items() if name != "return_C"}
    return shown


def difference(one: Mapping[str, FloatArray], other: Mapping[str, FloatArray]) -> float:
    """Return the largest difference of two outcomes."""
    return max((float(np.max(np.abs(one[name] - other[name]))) for name in one if name in other), default=0.0)
