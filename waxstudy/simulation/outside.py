"""One case in a room of another engine, with the same interface as the fast room's loop."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from waxstudy.plugin import TRACE, BackendMissing, FloatArray, OutsideRoom, SimulationError, Stopped, WeatherRecord
from waxstudy.plugin.registry import PluginError, told
from waxstudy.plugin.shapes import array_problems
from waxstudy.simulation.advance import ChainAdvance
from waxstudy.simulation.engine import Loop, Part, Start, Week
from waxstudy.simulation.interpreted import CompiledFailure
from waxstudy.simulation.modes import DrivenRoom
from waxstudy.study.model import Case, Choice

OPERATIVE = TRACE.index("operative_C")


def engine_of(room: Choice, weather: WeatherRecord, step_s: float) -> str:
    """Return an outside room's engine with its version, "" for a linear room; raise what `OutsideRoom.ready` raises."""
    if not issubclass(room.component, OutsideRoom):
        return ""
    with told("[room]", BackendMissing, ValueError):
        engine = room.component.ready(room.parameters, weather, step_s)
    if not (isinstance(engine, str) and engine.strip()):
        raise PluginError(f"[room]: its ready must return the engine with its version as a text, not {engine!r:.60}")
    return engine


def record_problems(record: Any, steps: int) -> Iterator[str]:
    """Yield what keeps a record from being one of so many steps."""
    yield from array_problems("its record", record, (steps, len(TRACE)))


def given_to(driven: DrivenRoom) -> Iterator[str | bytes]:
    """Yield what an outside room's record depends on besides its parameters: engine and weather as it is."""
    weather = driven.weather
    yield from (driven.engine, repr((weather.interval_s, weather.first_day)), weather.outdoor_C.tobytes())
    for name, values in sorted(weather.irradiance_W_m2.items()):
        yield from (name, values.tobytes())
    yield b"" if weather.sky_C is None else weather.sky_C.tobytes()


class OutsideLoop:
    """A chain closed over an outside room. `stand_in` is the fast loop that gives the first guess."""

    def __init__(self, room: Choice, case: Case, stand_in: Loop) -> None:
        self.room, self.case, self.stand_in = room, case, stand_in
        self.chain, self.driven, self.warnings = stand_in.chain, stand_in.driven, stand_in.warnings

    def weeks(
        self, setpoint_C: float, starts: Iterable[Start], *, trace: bool = False, stop: np.ndarray | None = None
    ) -> Iterator[Week]:
        """Warm up and simulate the week from every start; raise what the room raises."""
        asked = np.zeros(1, dtype=np.int64) if stop is None else stop
        for start in starts:
            record = self._record(setpoint_C, start, asked)
            below = record[:, OPERATIVE] < self.stand_in.limit_C
            counts = self.driven.counts
            steps = self.driven.steps_per_interval
            cold = np.count_nonzero(below if counts is None else below & np.repeat(counts, steps))
            yield Week(hours_below=cold * self.driven.step_s / 3600.0, trace=record if trace else record[:0])

    def parts(self, setpoint_C: float, start: Start, intervals: int, stop: np.ndarray) -> Iterator[Part]:
        """Simulate from one start; yield the record of so many weather intervals after another, as `Loop.parts`.

        An engine gives its record as a whole, and does not say what heat its room holds.
        """
        record, steps = self._record(setpoint_C, start, stop), intervals * self.driven.steps_per_interval
        for first in range(0, len(record), steps):
            yield Part(record[first : first + steps], np.nan)

    def _record(self, setpoint_C: float, start: Start, stop: np.ndarray) -> FloatArray:
        """Return what the room gives; what it breaks off or leaves unfinished must not be kept as a result."""
        try:
            record = self._simulated(setpoint_C, start, stop, self.stand_in.compiled is not None)
        except CompiledFailure:
            self._simulated(setpoint_C, start, stop, False)  # Python tells the exception and its line
            raise
        if stop[0]:
            raise Stopped
        for problem in record_problems(record, len(self.driven.supply_C) * self.driven.steps_per_interval):
            raise PluginError(f"[room]: {problem}")
        return record

    def _simulated(self, setpoint_C: float, start: Start, stop: np.ndarray, jit: bool) -> FloatArray:
        component, driven = self.room.component, self.driven
        assert issubclass(component, OutsideRoom)
        with told("[room]", Stopped, BackendMissing, SimulationError, OSError):
            return component.simulate(
                self.room.parameters,
                driven.weather,
                ChainAdvance(self.case.blocks, driven.step_s, setpoint_C, jit),
                setpoint_C=setpoint_C,
                step_s=driven.step_s,
                air_K=start.air_K,
                slab_K=start.slab_K,
                stop=lambda: bool(stop[0]),
            )
