"""What the effects are tried on: chains of the paper's blocks in its room, and a day of inputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from waxstudy.conformance.drive import interpreted
from waxstudy.plugin import Belief, Block, Choice, Effect, FloatArray, Inputs, Room
from waxstudy.plugin.registry import installed
from waxstudy.simulation.recorded import driven_by, respond
from waxstudy.simulation.records import plain_parameters

Words = Mapping[str, Mapping[str, Any]]
IDEAL: Words = {
    "sensor": {"use": "ideal"},
    "controller": {"use": "on-off", "dead_band_K": 0.5},
    "actuator": {"use": "ideal"},
    "valve": {"use": "linear"},
}
REAL: Words = {
    "sensor": {"use": "delay", "delay_s": 120.0},
    "controller": {"use": "on-off", "dead_band_K": 0.5},
    "actuator": {"use": "variable-times", "product": "B"},
    "valve": {"use": "quick-opening", "authority": 0.097},
}
MODULATED: Words = {
    "sensor": {"use": "lag"},
    "controller": {"use": "pi", "gain": 18.0, "integration_time_s": 2300.0},
    "modulator": {"use": "pwm"},
    "actuator": {"use": "constant-times"},
    "valve": {"use": "quick-opening"},
}
CONTINUOUS: Words = {"controller": {"use": "pi"}, "valve": {"use": "linear"}}
CHAINS = {"ideal": IDEAL, "real": REAL, "modulated": MODULATED, "continuous": CONTINUOUS}

EFFECTS: dict[str, type[Effect]] = {
    name: entry.component
    for (kind, name), entry in installed().components.items()
    if kind == "effect" and entry.package == "waxstudy" and issubclass(entry.component, Effect)
}


def choice(kind: str, words: Mapping[str, Any]) -> Choice:
    values = {key: value for key, value in words.items() if key != "use"}
    return Choice.of(installed().get(kind, words["use"]), values)


def day(interval_s: float = 60.0, **changes: FloatArray | float) -> Inputs:
    """A winter's day without sun or gains, with a flow of 100 L/h; each channel can be another."""
    count = round(86_400.0 / interval_s)
    still = {"outdoor_C": -5.0, "supply_C": 32.0, "solar_W": 0.0, "gains_W": 0.0}
    still |= {"ventilation_C": 18.0, "air_C": 21.0, "flow_L_h": 100.0}
    channels = {name: np.broadcast_to(np.asarray(v, dtype=float), count) for name, v in {**still, **changes}.items()}
    return Inputs(interval_s, 0.0, **{name: values.copy() for name, values in channels.items()})


def belief(words: Words = IDEAL, inputs: Inputs | None = None) -> Belief:
    blocks = {kind: choice(kind, block) for kind, block in words.items()}
    return Belief(blocks, choice("room", {"use": "nzeb"}), inputs or day())


def with_effect(name: str, to: Belief, **values: float) -> Belief:
    effect = EFFECTS[name]
    assert effect.hindrance(to) == ""
    return effect.apply(to, effect.Parameters(**values))


def output(of: Belief, kind: str, signal: Sequence[float] | np.ndarray, dt: float = 5.0) -> FloatArray:
    """What one block of a belief makes of a signal."""
    block: Any = of.blocks[kind].component
    assert issubclass(block, Block)
    plain = plain_parameters(of.blocks[kind].parameters)
    return np.array(interpreted(block, plain, [float(value) for value in signal], dt))


def response(of: Belief) -> dict[str, FloatArray]:
    """What the room of a belief does under its inputs and their flow."""
    assert of.room
    assert issubclass(of.room.component, Room)
    assert of.inputs
    assert of.inputs.flow_L_h is not None
    return respond(driven_by(of.room.component.build(of.room.parameters), of.inputs), of.inputs, of.inputs.flow_L_h)


def with_inputs(of: Belief, **channels: FloatArray | None) -> Belief:
    assert of.inputs
    changes: dict[str, Any] = dict(channels)
    return replace(of, inputs=replace(of.inputs, **changes))
