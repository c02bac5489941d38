"""One loop and one chain: left to its controller, or with a constant in the place of its controller's output.

While a loop is overridden its controller stands still, its sensor goes on. Its modulator begins anew when that begins
and when it ends, so that it decides at once and not at the next period of its own.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from waxstudy.plugin import CHAIN, Choice, Controller, FloatArray, Parameters, SimulationError, parameter
from waxstudy.simulation import kernel
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.engine import DAY_S, WARM_UP_DAYS, Loop, OutOfRange, Start, State
from waxstudy.simulation.interpreted import clock
from waxstudy.simulation.modes import DrivenRoom

CONTROLLER, MODULATOR = CHAIN.index("controller"), CHAIN.index("modulator")
CURVE = np.linspace(0.0, 1.0, 1001)


class Held(Parameters):
    output: float = parameter(0.0, unit="1", description="What it gives.", source="the call", ge=0.0, le=1.0)


class Override(Controller):
    """A constant in the place of a controller's output."""

    name = "override"
    Parameters = Held

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return float(p.output)


class Course:
    """A loop that can be run from any step to any other, left to itself or overridden."""

    def __init__(
        self,
        blocks: Mapping[str, Choice],
        driven: DrivenRoom,
        setpoint_C: float,
        flow_share: float,
        clock_s: float,
        jit: bool,
        stop: np.ndarray,
    ) -> None:
        self.setpoint_C, self.clock_s, self.stop = setpoint_C, clock_s, stop
        self.blocks, self.step_s = blocks, driven.step_s
        self.driven = with_flow(driven, flow_share)
        # weather that is held over an interval is held over its steps
        by_step = replace(self.driven, weather=replace(driven.weather, interval_s=driven.step_s))
        chains: dict[float | None, Mapping[str, Choice]] = {None: blocks}
        chains |= {held: {**blocks, "controller": Choice(Override, Held(output=held))} for held in (0.0, 1.0)}
        loops = {held: Loop(Chain(each, self.step_s), self.driven, -np.inf, jit) for held, each in chains.items()}
        self.starts = {held: (loop.compiled or loop.chain).start() for held, loop in loops.items()}
        self.loops = {held: (loop, _over(loop, by_step)) for held, loop in loops.items()}

    def warm(self, start: Start) -> State:
        """Return the state at the start of the week, after a warm-up with the first day's weather."""
        free = self.loops[None][0]
        state = free.start(self.setpoint_C, start)
        first_day = np.arange(round(DAY_S / self.driven.weather.interval_s))
        self._advance(free, state, np.tile(first_day, WARM_UP_DAYS), -WARM_UP_DAYS * DAY_S, False)
        return state

    def run(self, state: State, begin: int, end: int, held: float | None = None, trace: bool = True) -> FloatArray:
        """Run from a step to another and return the trace; `state` is changed in place."""
        kept = state.blocks[CONTROLLER]
        if held is not None:
            state.blocks[CONTROLLER] = self._fresh(CONTROLLER, held)
            state.blocks[MODULATOR] = self._fresh(MODULATOR)
        parts = [self._stretch(held, state, *part, trace) for part in self._parts(begin, end)]
        if held is not None:
            state.blocks[CONTROLLER] = kept
            state.blocks[MODULATOR] = self._fresh(MODULATOR)
        return np.concatenate(parts) if parts else np.zeros((0, len(kernel.TRACE)))

    def _parts(self, begin: int, end: int) -> list[tuple[int, int]]:
        """Return whole weather intervals in one piece, and what is left before and behind."""
        per = self.driven.steps_per_interval
        first, last = -(-begin // per) * per, end // per * per
        bounds = [begin, first, last, end] if first < last else [begin, end]
        return [(a, b) for a, b in pairwise(bounds) if a < b]

    def _stretch(self, held: float | None, state: State, begin: int, end: int, trace: bool) -> FloatArray:
        whole, by_step = self.loops[held]
        per = self.driven.steps_per_interval
        if begin % per == end % per == 0:
            return self._advance(whole, state, np.arange(begin // per, end // per), begin * self.step_s, trace)
        return self._advance(by_step, state, np.arange(begin, end) // per, begin * self.step_s, trace)

    def _advance(self, loop: Loop, state: State, intervals: np.ndarray, start_s: float, trace: bool) -> FloatArray:
        at_s = start_s + self.clock_s
        try:
            return loop.advance(state, intervals, at_s, self.setpoint_C, trace=trace, stop=self.stop)[1]
        except OutOfRange as error:
            raise SimulationError(_told(loop, error)) from None

    def _fresh(self, place: int, held: float | None = None) -> Any:
        return copy.deepcopy(self.starts[held][place])

    @property
    def warnings(self) -> list[str]:
        """What the user should know of blocks that could not be compiled."""
        return self.loops[None][0].warnings


def copied(state: State) -> State:
    """Return a state that goes on apart from the other."""
    return copy.deepcopy(state)


def with_flow(driven: DrivenRoom, share: float) -> DrivenRoom:
    """Return a room whose open valve lets through a share of its full flow."""
    if share == 1.0:
        return driven
    return replace(driven, conductance_W_K=np.ascontiguousarray(driven.room.floor_conductance_W_K(share * CURVE)))


def _over(loop: Loop, driven: DrivenRoom) -> Loop:
    """Return the same chain over the same room with its weather cut otherwise."""
    other = copy.copy(loop)
    other.driven = driven
    return other


def _told(loop: Loop, error: OutOfRange) -> str:
    if error.place == kernel.ROOM:
        return f"the room's temperatures are lost by {clock(error.time_s)}"
    callback = loop.compiled.callbacks.get(error.place) if loop.compiled else None
    if callback and callback.error:
        return str(callback.error)
    block = loop.chain.blocks[error.place]
    assert block
    return f"{block.kind} '{block.name}' failed at {clock(error.time_s)}: see `waxstudy plugins check {block.name}`"
