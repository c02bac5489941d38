"""One case in one room and week: the chain closed over the room, from a given start."""

from __future__ import annotations

import traceback
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.plugin import CHAIN, Block, FloatArray
from waxstudy.simulation import kernel
from waxstudy.simulation.modes import DrivenRoom
from waxstudy.simulation.records import parameter_record, plain_parameters, state_record
from waxstudy.study.model import Choice

DAY_S = 86400.0
WARM_UP_DAYS = 7  # with the first day's weather
SLAB_ABOVE_K = 2.0  # a heated floor at the start of the warm-up


class SimulationError(Exception):
    """The simulation failed; the message names the block and the time."""


class Stopped(Exception):
    """The simulation was asked to stop."""


@dataclass(frozen=True)
class Start:
    """Where one ensemble member starts its warm-up: what it adds to air and walls, and to the floor [K]."""

    air_K: float
    slab_K: float


START = Start(0.0, 0.0)


@dataclass(frozen=True)
class Week:
    """What one simulated week gives. `trace` has a row per step (columns `kernel.TRACE`), or none."""

    hours_below: float
    trace: FloatArray


@dataclass
class State:
    """State of a loop between two parts of its run."""

    modes: FloatArray
    readings: FloatArray
    blocks: list[Any]  # records for compiled code, objects for the interpreter


class Chain:
    """The blocks of one case, ready to run."""

    def __init__(self, blocks: Mapping[str, Choice], step_s: float) -> None:
        self.blocks: list[type[Block] | None] = [None] * len(CHAIN)
        self.plain: list[Any] = [()] * len(CHAIN)
        for kind, choice in blocks.items():
            place = CHAIN.index(kind)
            assert issubclass(choice.component, Block)
            self.blocks[place] = choice.component
            self.plain[place] = plain_parameters(choice.parameters)
        self.step_s = step_s
        ports = [block.output if block else None for block in self.blocks]
        self.low = np.array([port.low if port else 0.0 for port in ports])
        self.high = np.array([port.high if port else 0.0 for port in ports])

    def start(self) -> list[Any]:
        """Return fresh state objects, 0 where the chain has no block."""
        pairs = zip(self.blocks, self.plain, strict=True)
        return [block.start(plain, self.step_s) if block else 0 for block, plain in pairs]


class Loop:
    """A chain closed over a driven room."""

    def __init__(self, chain: Chain, driven: DrivenRoom, limit_C: float, jit: bool = True) -> None:
        self.chain, self.driven, self.limit_C, self.jit = chain, driven, limit_C, jit
        self._records = [parameter_record(plain) for plain in chain.plain]
        self._addresses = self._compile() if jit else None

    def _compile(self) -> Any:
        from waxstudy.simulation.compiled import address, loop

        self._loop = loop()
        pairs = zip(self.chain.blocks, self.chain.plain, strict=True)
        return np.array([address(block, plain) if block else 0 for block, plain in pairs], dtype=np.int64)

    def weeks(
        self, setpoint_C: float, starts: Iterable[Start], *, trace: bool = False, stop: np.ndarray | None = None
    ) -> Iterator[Week]:
        """Warm up and simulate the week from every start; raise `SimulationError` or `Stopped`."""
        stop = np.zeros(1, dtype=np.int64) if stop is None else stop
        starts = list(starts)
        try:
            for start in starts:
                yield self._week(setpoint_C, start, trace, stop)
        except _OutOfRange as error:
            if self.jit:  # the interpreter tells what compiled code cannot: the exception and its line
                interpreted = Loop(self.chain, self.driven, self.limit_C, jit=False)
                deque(interpreted.weeks(setpoint_C, starts, stop=stop), maxlen=0)
            if error.place == kernel.ROOM:
                raise SimulationError(f"the room's temperatures are lost by {clock(error.time_s)}") from None
            block = self.chain.blocks[error.place]
            assert block
            port = block.output
            unit = "" if port.unit == "1" else f" {port.unit}"
            raise SimulationError(
                f"{block.kind} '{block.name}' gave NaN or a {port.quantity} outside {port.low:g} to "
                f"{port.high:g}{unit} at {clock(error.time_s)}"
            ) from None

    def start(self, setpoint_C: float, start: Start = START) -> State:
        """Return the state of a room near its setpoint, the floor somewhat warmer, and of a chain at rest."""
        driven, air = self.driven, self.driven.room.air_nodes
        nodes = setpoint_C + air * start.air_K + (1.0 - air) * (SLAB_ABOVE_K + start.slab_K)
        modes = driven.to_modes @ nodes
        blocks: Any = self.chain.start()
        if self.jit:
            blocks = [state_record(block) if block != 0 else None for block in blocks]
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
        run = self._compiled if self.jit else self._interpreted
        code = run(state, room, rest, record, counters, stop)
        if code == kernel.STOPPED:
            raise Stopped
        if code >= 0:
            raise _OutOfRange(code, start_s + float(counters[1]) * driven.step_s)
        return int(counters[0]), record

    def _week(self, setpoint_C: float, start: Start, trace: bool, stop: np.ndarray) -> Week:
        """Warm up from one start with the first day's weather, then simulate the week."""
        driven, state = self.driven, self.start(setpoint_C, start)
        first_day = np.arange(round(DAY_S / driven.weather.interval_s))
        self.advance(state, np.tile(first_day, WARM_UP_DAYS), -WARM_UP_DAYS * DAY_S, setpoint_C, stop=stop)
        week = np.arange(len(driven.supply_C))
        cold, record = self.advance(state, week, 0.0, setpoint_C, trace=trace, stop=stop)
        return Week(hours_below=cold * driven.step_s / 3600.0, trace=record)

    def _compiled(self, state: State, room: tuple[Any, ...], rest: tuple[Any, ...], *out: np.ndarray) -> int:
        parameters = np.array([record.ctypes.data for record in self._records], dtype=np.int64)
        pointers = np.array([0 if s is None else s.ctypes.data for s in state.blocks], dtype=np.int64)
        blocks = (self._addresses, parameters, pointers)
        return int(self._loop(*blocks, *room, state.modes, state.readings, *rest, *out))

    def _interpreted(self, state: State, room: tuple[Any, ...], rest: tuple[Any, ...], *out: np.ndarray) -> int:
        """Run the same loop in Python; lists are several times quicker there than arrays."""
        steps = [_named(block) if block else 0 for block in self.chain.blocks]
        modes, readings = state.modes.tolist(), state.readings.tolist()
        run: Callable[..., int] = kernel.simulate
        plain_room = [array.tolist() for array in room]
        code = run(steps, self.chain.plain, state.blocks, *plain_room, modes, readings, *rest, *out)
        state.modes[:], state.readings[:] = modes, readings
        return code


class _OutOfRange(Exception):
    """A block returned NaN or a value outside its range."""

    def __init__(self, place: int, time_s: float) -> None:
        super().__init__(place, time_s)
        self.place, self.time_s = place, time_s


def _named(block: type[Block]) -> Callable[..., float]:
    """Wrap a block's function so that what it raises names the block and the time."""

    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        try:
            return float(block.step(p, x, u, t, dt)) + 0.0  # as the compiled guard: no negative zero
        except Exception as error:
            frame = traceback.extract_tb(error.__traceback__)[-1]
            raise SimulationError(
                f"{block.kind} '{block.name}' failed at {clock(t)} with input {u:g}: "
                f"{type(error).__name__}: {error} ({frame.filename}:{frame.lineno})"
            ) from error

    return step


def clock(t: float) -> str:
    """A time of the run in words.

    >>> clock(93605.0), clock(-5.0)
    ('day 2, 02:00:05', '5 s before the week (warm-up)')
    """
    if t < 0:
        return f"{-t:g} s before the week (warm-up)"
    day, rest = divmod(t, 86400.0)
    hours, rest = divmod(rest, 3600.0)
    return f"day {day + 1:.0f}, {hours:02.0f}:{rest // 60:02.0f}:{rest % 60:02.0f}"
