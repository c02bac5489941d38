"""One case in one room and week: the chain closed over the room, from a given start."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.plugin import FloatArray, SimulationError, Stopped
from waxstudy.simulation import kernel
from waxstudy.simulation.chain import Chain, CompiledChain
from waxstudy.simulation.interpreted import CompiledFailure, checked, clock
from waxstudy.simulation.lanes import LANES
from waxstudy.simulation.modes import DrivenRoom

DAY_S = 86400.0
WARM_UP_DAYS = 7  # with the first day's weather
SLAB_ABOVE_K = 2.0  # a heated floor at the start of the warm-up


@dataclass(frozen=True)
class Start:
    """Where one ensemble member starts its warm-up: what it adds to air and walls, and to the floor [K]."""

    air_K: float
    slab_K: float


START = Start(0.0, 0.0)


@dataclass(frozen=True)
class Week:
    """What one simulated week gives, hours while comfort counts.

    `trace` has a row per step (columns `kernel.TRACE`), or none.
    """

    hours_below: float
    trace: FloatArray


@dataclass(frozen=True)
class Part:
    """A part of a run: its trace, and how much more heat the room holds at its end (NaN where that is not known)."""

    trace: FloatArray
    stored_J: float


@dataclass
class State:
    """State of a loop between two parts of its run."""

    modes: FloatArray
    readings: FloatArray
    blocks: list[Any]  # memory for compiled code, objects for the interpreter


class Loop:
    """A chain closed over a driven room."""

    def __init__(self, chain: Chain, driven: DrivenRoom, limit_C: float, jit: bool = True, watch: bool = False) -> None:
        assert len(driven.decay) % LANES == 0, "compiled code reads whole lanes"
        self.chain, self.driven, self.limit_C, self.watch = chain, driven, limit_C, watch
        self.compiled = CompiledChain(chain) if jit else None

    @property
    def warnings(self) -> list[str]:
        """What the user should know of blocks that could not be compiled."""
        return self.compiled.warnings if self.compiled else []

    def weeks(
        self, setpoint_C: float, starts: Iterable[Start], *, trace: bool = False, stop: np.ndarray | None = None
    ) -> Iterator[Week]:
        """Warm up and simulate the week from every start; raise `SimulationError` or `Stopped`."""
        stop = np.zeros(1, dtype=np.int64) if stop is None else stop
        for start in starts:
            try:
                week = self._week(setpoint_C, start, trace, stop)
            except OutOfRange as error:
                raise self._explained(error, setpoint_C, start, stop) from None
            yield week

    def parts(self, setpoint_C: float, start: Start, intervals: int, stop: np.ndarray) -> Iterator[Part]:
        """Warm up and simulate from one start; yield one part of so many weather intervals after another.

        Raises `SimulationError` or `Stopped`.
        """
        try:
            state = self._warm(setpoint_C, start, stop)
            for first in range(0, len(self.driven.supply_C), intervals):
                part = np.arange(first, min(first + intervals, len(self.driven.supply_C)))
                begin_s = first * self.driven.weather.interval_s
                before = state.modes.copy()
                trace = self.advance(state, part, begin_s, setpoint_C, trace=True, stop=stop)[1]
                yield Part(trace, float(self.driven.stored_J @ (state.modes - before)))
        except OutOfRange as error:
            raise self._explained(error, setpoint_C, start, stop) from None

    def _explained(self, error: OutOfRange, setpoint_C: float, start: Start, stop: np.ndarray) -> Exception:
        """Return what Python says of a failure: the exception and its line, which compiled code cannot tell."""
        if error.place == kernel.ROOM:
            return SimulationError(f"the room's temperatures are lost by {clock(error.time_s)}")
        callback = self.compiled.callbacks.get(error.place) if self.compiled else None
        if callback and callback.error:
            return callback.error
        try:
            Loop(self.chain, self.driven, self.limit_C, jit=False, watch=True)._week(setpoint_C, start, False, stop)
        except (SimulationError, Stopped) as told:
            return told
        block = self.chain.blocks[error.place]
        assert block
        return CompiledFailure(f"{block.kind} '{block.name}'", clock(error.time_s))

    def start(self, setpoint_C: float, start: Start = START) -> State:
        """Return the state of a room near its setpoint, the floor somewhat warmer, and of a chain at rest."""
        driven, air = self.driven, self.driven.room.air_nodes
        nodes = setpoint_C + air * start.air_K + (1.0 - air) * (SLAB_ABOVE_K + start.slab_K)
        modes = driven.to_modes @ nodes
        blocks: list[Any] = self.compiled.start() if self.compiled else self.chain.start()
        return State(modes, (driven.outputs @ modes + driven.offsets[0])[:3], blocks)

    def advance(
        self,
        state: State,
        intervals: np.ndarray,
        start_s: float,
        setpoint_C: float,
        *,
        trace: bool = False,
        stop: np.ndarray | None = None,
    ) -> tuple[int, FloatArray]:
        """Run weather intervals (by index) from a state, which is changed in place.

        Returns the number of cold steps and the trace (steps, len(TRACE)), without rows if not asked for.
        """
        driven = self.driven
        counters = np.zeros(2, dtype=np.int64)
        record = np.zeros((len(intervals) * driven.steps_per_interval if trace else 0, len(kernel.TRACE)))
        stop = np.zeros(1, dtype=np.int64) if stop is None else stop
        room = (
            self.chain.low,
            self.chain.high,
            driven.decay,
            driven.heat_gain,
            driven.forcing[intervals],
            driven.outputs,
            driven.offsets[intervals],
            driven.heat_offset,
            driven.supply_C[intervals],
            driven.conductance_W_K,
        )
        rest = (setpoint_C, start_s, driven.step_s, driven.steps_per_interval, self.limit_C)
        run = self._compiled if self.compiled else self._interpreted
        code = run(state, room, rest, record, counters, stop)
        if code == kernel.STOPPED:
            raise Stopped
        time_s = start_s + float(counters[1]) * driven.step_s
        if code >= 0:
            raise OutOfRange(code, time_s)
        return int(counters[0]), record

    def _week(self, setpoint_C: float, start: Start, trace: bool, stop: np.ndarray) -> Week:
        """Warm up from one start, then simulate the week."""
        state, cold, records = self._warm(setpoint_C, start, stop), 0, []
        for span, counts in self.driven.spans:
            begin_s = float(span[0]) * self.driven.weather.interval_s
            below, record = self.advance(state, span, begin_s, setpoint_C, trace=trace, stop=stop)
            cold += below if counts else 0
            records.append(record)
        return Week(
            hours_below=cold * self.driven.step_s / 3600.0,
            trace=records[0] if len(records) == 1 else np.concatenate(records),
        )

    def _warm(self, setpoint_C: float, start: Start, stop: np.ndarray) -> State:
        """Return the state after a warm-up with the first day's weather."""
        state = self.start(setpoint_C, start)
        first_day = np.arange(round(DAY_S / self.driven.weather.interval_s))
        self.advance(state, np.tile(first_day, WARM_UP_DAYS), -WARM_UP_DAYS * DAY_S, setpoint_C, stop=stop)
        return state

    def _compiled(self, state: State, room: tuple[Any, ...], rest: tuple[Any, ...], *out: np.ndarray) -> int:
        from waxstudy.simulation.compiled import loop

        assert self.compiled
        blocks = (self.compiled.addresses, self.compiled.parameters, self.compiled.pointers(state.blocks))
        code = int(loop()(*blocks, *room, state.modes, state.readings, *rest, *out))
        failed = self.compiled.failed(state.blocks)
        return code if failed is None else failed

    def _interpreted(self, state: State, room: tuple[Any, ...], rest: tuple[Any, ...], *out: np.ndarray) -> int:
        """Run the same loop in Python; lists are several times quicker there than arrays."""
        steps = [checked(block, self.watch) if block else 0 for block in self.chain.blocks]
        modes, readings = state.modes.tolist(), state.readings.tolist()
        run: Callable[..., int] = kernel.simulate
        plain_room = [array.tolist() for array in room]
        code = run(steps, self.chain.plain, state.blocks, *plain_room, modes, readings, *rest, *out)
        state.modes[:], state.readings[:] = modes, readings
        odd = self.chain.odd_state(state.blocks)
        return code if odd is None else odd


class OutOfRange(Exception):
    """A block returned NaN or a value outside its range."""

    def __init__(self, place: int, time_s: float) -> None:
        super().__init__(place, time_s)
        self.place, self.time_s = place, time_s
