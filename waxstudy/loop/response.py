"""What a block answers to a small step, asked of its own step function, and from that its frequency response.

Nothing is known of a block but its step function: a delay, a lag, pulses, a motor that remembers are all asked alike.
Where a modulator has a clock of its own, the answer is the mean over all times at which the step may come.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from waxstudy.plugin import FloatArray
from waxstudy.simulation.chain import Stepped
from waxstudy.study.model import Choice

ComplexArray = NDArray[np.complex128]

SETTLES_S = 4.0 * 3600.0  # in which blocks have answered: longer than any motor's memory counts
PHASES = 24  # of a modulator's period at which the step comes
FEW_PHASES = 4  # to see whether the answer is linear at all
SMALL = 0.005  # step of a level: little of a valve's bend
SMALL_OF_PULSES = 0.05  # of a level that becomes pulses: many steps of their length
SMALL_K = 0.05  # and of a temperature
PROPORTIONAL = 0.2  # a linear block answers twice the step by twice as much, within this share
ERRORS_K = (10.0, 1.0, 0.1, 0.01, 1e-3, 1e-4)  # that bring a controller to its working point
LONGEST_STEPS = 200_000  # to get there
REST = (0.02, 0.98)  # a controller at rest within its output's range


@dataclass(frozen=True)
class Response:
    """Answer to a unit step at time 0: values at each step, and the slope per step in which they end."""

    values: FloatArray
    slope: float = 0.0

    def at(self, z: ComplexArray) -> ComplexArray:
        """Return the transfer function at points of the z plane."""
        impulses = np.diff(self.values, prepend=0.0) - self.slope
        answered = np.flatnonzero(np.abs(impulses) > 1e-12 * np.max(np.abs(self.values), initial=1e-300))
        found = np.polynomial.polynomial.polyval(1.0 / z, impulses[: 1 + max(answered, default=0)])
        return np.asarray(found + (self.slope / (1.0 - 1.0 / z) if self.slope else 0.0))


class Line:
    """Blocks in a row from their start; a copy goes on by itself. What comes out passes through `last`, if given."""

    def __init__(
        self, blocks: Sequence[Choice], step_s: float, last: Callable[[FloatArray], FloatArray] | None = None
    ) -> None:
        self.blocks = [Stepped(choice, step_s) for choice in blocks]
        self.step_s, self.last, self.steps = step_s, last, 0

    def run(self, level: float, steps: int) -> FloatArray:
        """Hold the input for so many steps; return what comes out at each."""
        out = np.empty(steps)
        for n in range(steps):
            value = level
            for block in self.blocks:
                value = block.step(value, (self.steps + n) * self.step_s)
            out[n] = value
        self.steps += steps
        return self.last(out) if self.last else out


def sensor_response(sensor: Choice | None, step_s: float) -> Response:
    """Return what a sensor answers to a change of the temperature."""
    if sensor is None:
        return Response(np.ones(1))
    line, steps = Line([sensor], step_s), round(SETTLES_S / step_s)
    rest_C = 20.0
    before = line.run(rest_C, steps)[-1]
    return Response((line.run(rest_C + SMALL_K, steps) - before) / SMALL_K)


@dataclass(frozen=True)
class Emission:
    """From the controller's output to the mean conductance between water and floor, at one output."""

    output: float
    response: Response  # W/K


class NotLinear(Exception):
    """A loop has no linear form near where it works; the message says which block, and why."""


class Emitter:
    """The blocks after the controller, with what their flow lets through; `period_s` is that of a modulator, or 0."""

    def __init__(
        self,
        blocks: Sequence[Choice],
        period_s: float,
        step_s: float,
        conductance_W_K: Callable[[FloatArray], FloatArray],
    ) -> None:
        self.blocks, self.period_s, self.step_s, self.conductance_W_K = blocks, period_s, step_s, conductance_W_K
        self.window = max(1, round(period_s / step_s))  # steps over which pulses are averaged

    def mean(self, output: float, of_flow: bool = False) -> float:
        """Return the mean conductance [W/K], or mean flow fraction, that a constant output leads to."""
        line = Line(self.blocks, self.step_s, None if of_flow else self.conductance_W_K)
        line.run(output, self._settled())
        return float(np.mean(line.run(output, self.window)))

    def output_for(self, reached: Callable[[float], bool]) -> float:
        """Return the least constant output from which on something is reached, to a thousandth."""
        low, high = 0.0, 1.0
        while high - low > 1e-3:
            middle = 0.5 * (low + high)
            low, high = (low, middle) if reached(middle) else (middle, high)
        return high

    def emission(self, conductance_W_K: float) -> Emission:
        """Return the emission where its mean conductance is as given; raise `NotLinear`."""
        output = self.output_for(lambda level: self.mean(level) >= conductance_W_K)
        wanted = SMALL_OF_PULSES if self.window > 1 else SMALL
        small = min(wanted, output, 1.0 - output)
        if small < wanted / 4.0:
            raise NotLinear("the controller's output is at its limit all the time")
        one, two = (self._answer(output, small * share, FEW_PHASES) for share in (0.5, 1.0))
        if not _is_proportional(one, two):
            raise NotLinear("its motor or valve gets a switched signal and answers no small change of it")
        return Emission(output, Response(self._answer(output, small, PHASES) / small))

    def _answer(self, output: float, small: float, phases: int) -> FloatArray:
        """Return half of what a step up and one down differ by, on the mean over the times at which they come."""
        steps = self._settled()
        times = (np.arange(phases) + 0.5) / phases * self.window if self.window > 1 else np.zeros(1)
        line, total = Line(self.blocks, self.step_s, self.conductance_W_K), np.zeros(steps)
        line.run(output, steps)
        for before, now in zip([0, *map(round, times[:-1])], map(round, times), strict=True):
            line.run(output, now - before)
            up, down = copy.deepcopy(line), copy.deepcopy(line)
            total += 0.5 * (up.run(output + small, steps) - down.run(output - small, steps))
        answer = total / len(times)
        answer[-self.window :] = np.mean(answer[-self.window :])
        return np.asarray(answer)

    def _settled(self) -> int:
        """Steps in which all is settled: whole periods."""
        return self.window * max(4, round(SETTLES_S / self.step_s / self.window))


def _is_proportional(one: FloatArray, two: FloatArray) -> bool:
    """Whether twice the step is answered by twice as much, and by something."""
    least, most = float(one[-1]), float(two[-1])
    return least > 0.0 and abs(most - 2.0 * least) <= PROPORTIONAL * 2.0 * least


def controller_response(controller: Choice, output: float, step_s: float) -> Response:
    """Return a controller's answer to a change of its error near an output; raise `NotLinear` for one that switches."""
    line = _at_rest(controller, output, step_s)
    steps = round(SETTLES_S / step_s)
    base = copy.deepcopy(line).run(0.0, steps)
    # so small that the output stays within its range
    jump = abs(copy.deepcopy(line).run(1e-6, 1)[0] - base[0]) / 1e-6
    small_K = min(SMALL_K, 0.1 / max(jump, 1e-9))
    one, two = (copy.deepcopy(line).run(small_K * share, steps) - base for share in (0.5, 1.0))
    unclipped = steps if two[-1] + base[-1] < 1.0 else int(np.argmax(two + base >= 1.0))
    if unclipped < 4 or not _is_proportional(one[:unclipped], two[:unclipped]):
        raise NotLinear(f"its controller '{controller.component.name}' switches")
    answer = two[:unclipped] / small_K
    last = answer[3 * unclipped // 4 :]
    slope = float((last[-1] - last[0]) / (len(last) - 1)) if len(last) > 1 else 0.0
    return Response(answer, slope)


def _at_rest(controller: Choice, output: float, step_s: float) -> Line:
    """Return a controller whose output stays near what is given while there is no error; raise `NotLinear`."""
    for error_K in ERRORS_K:
        line = Line([controller], step_s)
        for _ in range(LONGEST_STEPS):
            now = float(line.run(error_K, 1)[0])
            if now >= output:
                break
        rest = float(copy.deepcopy(line).run(0.0, 2)[-1])
        if REST[0] < rest < REST[1] and abs(rest - output) < 0.5:
            return line
        if now < output:  # a smaller error would not get there either
            break
    raise NotLinear(f"its controller '{controller.component.name}' rests at no output between off and on")
