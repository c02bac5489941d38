"""The loop of a case, linearised where it works: exact for the room's modes, asked of the blocks (`response`).

With the mean conductance g from water to floor and the drop D that drives the heat q, dq = D dg - g dT of the layer.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from waxstudy.loop.response import (
    ComplexArray,
    Emission,
    Emitter,
    NotLinear,
    Response,
    controller_response,
    sensor_response,
)
from waxstudy.plugin import CHAIN, ROOM_OUTPUTS, FloatArray
from waxstudy.simulation.modes import DrivenRoom
from waxstudy.study.model import Case, Choice

SLOWEST_S = 30.0 * 86400.0
FREQUENCIES = 2000
FLOWING = 0.01  # mean flow fraction from which on an output is of use
AFTER_CONTROLLER = CHAIN[CHAIN.index("controller") + 1 :]


@dataclass(frozen=True)
class Margins:
    """How far a loop is from instability: below 1, or below 0, it is unstable."""

    gain: float
    phase_deg: float
    period_s: float  # of the swing with which the loop would become unstable

    @property
    def is_stable(self) -> bool:
        return self.gain > 1.0 and self.phase_deg > 0.0


@dataclass(frozen=True)
class Reaction:
    """A process seen as one that integrates after a delay: steepest slope of its step response, where it begins."""

    slope_K_s: float
    delay_s: float


@dataclass(frozen=True)
class LinearLoop:
    """Responses of the parts of a loop around the point where it works. `process` is all but the controller."""

    driven: DrivenRoom
    conductance_W_K: float
    drop_K: float
    sensor: Response
    emission: Emission
    controller: Response | None  # None for one that switches

    @cached_property
    def frequencies(self) -> FloatArray:
        """Angular frequencies [rad/s], up to half of one step."""
        return np.geomspace(2.0 * np.pi / SLOWEST_S, 0.999 * np.pi / self.driven.step_s, FREQUENCIES)

    @cached_property
    def process(self) -> ComplexArray:
        """From the controller's output to the reading [K]."""
        z = np.exp(1j * self.frequencies * self.driven.step_s)
        sensed, layer = (self._room(name, z) / z for name in ("sensed_C", "layer_C"))
        heat_W = self.drop_K * self.emission.response.at(z) / (1.0 + self.conductance_W_K * layer)
        return np.asarray(self.sensor.at(z) * sensed * heat_W)

    @cached_property
    def open_loop(self) -> ComplexArray | None:
        """From the error to the reading, or None where the controller switches."""
        if self.controller is None:
            return None
        return np.asarray(self.controller.at(np.exp(1j * self.frequencies * self.driven.step_s)) * self.process)

    def _room(self, output: str, z: ComplexArray) -> ComplexArray:
        """From the floor's heat [W] to a temperature at the end of the same step."""
        driven, place = self.driven, ROOM_OUTPUTS.index(output)
        terms = driven.outputs[place] * driven.heat_gain / (1.0 - driven.decay / z[:, None])
        return np.asarray(driven.heat_offset[place] + np.sum(terms, axis=1))

    @cached_property
    def margins(self) -> Margins | None:
        """The margins nearest to the limit of stability; None where the controller switches."""
        if self.open_loop is None:
            return None
        size, phase = np.abs(self.open_loop), np.unwrap(np.angle(self.open_loop))
        swings = self._crossings(phase + np.pi, np.log(size))
        at, log_size = min(swings, key=lambda swing: abs(swing[1]), default=(np.nan, -np.inf))
        phases = [np.degrees(value + np.pi) for _, value in self._crossings(np.log(size), phase)]
        return Margins(float(np.exp(-log_size)), float(min(phases, key=abs, default=np.inf)), float(2.0 * np.pi / at))

    @cached_property
    def ultimate(self) -> tuple[float, float] | None:
        """Gain [1/K] at which a proportional controller would just swing, and the period [s]; None if none does."""
        size, phase = np.abs(self.process), np.unwrap(np.angle(self.process))
        found = next(self._crossings(phase + np.pi, np.log(size)), None)
        return None if found is None else (float(np.exp(-found[1])), float(2.0 * np.pi / found[0]))

    def _crossings(self, crossed: FloatArray, told: FloatArray) -> Iterator[tuple[float, float]]:
        """Yield frequency and another value at each place where a value crosses zero, between the samples."""
        for i in np.flatnonzero(np.diff(np.sign(crossed)) != 0):
            share = crossed[i] / (crossed[i] - crossed[i + 1])
            logs = np.log(self.frequencies[i : i + 2])
            frequency = np.exp(logs[0] + share * (logs[1] - logs[0]))
            yield float(frequency), float(told[i] + share * (told[i + 1] - told[i]))

    def reaction(self, duration_s: float = 86400.0) -> Reaction:
        """Return the reaction curve of the process: tangent at the steepest place of its answer to a unit step."""
        driven, steps = self.driven, round(duration_s / self.driven.step_s)
        sensed, layer = (ROOM_OUTPUTS.index(name) for name in ("sensed_C", "layer_C"))
        given = self.emission.response.values
        modes, layer_K, reading = np.zeros(len(driven.decay)), 0.0, np.empty(steps)
        for n in range(steps):
            heat_W = self.drop_K * given[min(n, len(given) - 1)] - self.conductance_W_K * layer_K
            modes = driven.decay * modes + driven.heat_gain * heat_W
            layer_K = float(driven.outputs[layer] @ modes + driven.heat_offset[layer] * heat_W)
            reading[n] = driven.outputs[sensed] @ modes + driven.heat_offset[sensed] * heat_W
        seen = np.convolve(np.diff(self.sensor.values, prepend=0.0), reading)[:steps]
        slopes = np.diff(seen) / driven.step_s
        steepest = int(np.argmax(slopes))
        slope = float(slopes[steepest])
        # what is seen at the end of step n is told n + 1 steps after the output changed
        at_s, middle_K = (steepest + 1.5) * driven.step_s, 0.5 * float(seen[steepest] + seen[steepest + 1])
        return Reaction(slope, at_s - middle_K / slope)


def emitter_of(case: Case, driven: DrivenRoom) -> Emitter:
    """Return the blocks after a case's controller, with the conductance from water to floor that their flow makes."""
    blocks = [case.blocks[kind] for kind in AFTER_CONTROLLER if kind in case.blocks]
    return Emitter(blocks, _period_s(case), driven.step_s, driven.room.floor_conductance_W_K)


def linearised(case: Case, driven: DrivenRoom, conductance_W_K: float, drop_K: float) -> LinearLoop:
    """Return the loop of a case near where it works; raise `NotLinear` where it has no linear form."""
    step_s = driven.step_s
    emission = emitter_of(case, driven).emission(conductance_W_K)
    try:
        controller = controller_response(case.blocks["controller"], emission.output, step_s)
    except NotLinear:
        controller = None
    sensor = sensor_response(case.blocks.get("sensor"), step_s)
    return LinearLoop(driven, conductance_W_K, drop_K, sensor, emission, controller)


def minimum_duty(case: Case, driven: DrivenRoom) -> float:
    """Return the least constant output that lets water flow: what asks for less moves motor and valve for nothing."""
    emitter = emitter_of(case, driven)
    return emitter.output_for(lambda level: emitter.mean(level, of_flow=True) >= FLOWING * level and level > 0.0)


def _period_s(case: Case) -> float:
    """Return the period of a case's modulator, 0 where it has none or no clock of its own."""
    modulator: Choice | None = case.blocks.get("modulator")
    name = getattr(modulator.component, "period", "") if modulator else ""
    return float(getattr(modulator.parameters, name)) if modulator and name else 0.0
