"""The chain closed over EnergyPlus: what happens at each step of a run, in the process that runs the engine.

Rooms differ in how they hold the start of the warm-up and how they set the flow. A job is plain numbers and names, so
that this process need load nothing else.
"""

from __future__ import annotations

import ctypes
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from waxstudy.simulation.standalone import ROW, Address, Number, Standalone
from waxstudy_energyplus.chain import carried
from waxstudy_energyplus.library import AFTER_REPORTING, BEFORE_PREDICTOR, Engine
from waxstudy_energyplus.native import DRIVE, READ, Native, Wire

if TYPE_CHECKING:
    from waxstudy.plugin import Advance


@dataclass(frozen=True, kw_only=True)
class Job(ABC):
    """One run, driven by `advance` at a step that divides the engine's."""

    engine: str  # its folder
    advance: Advance
    step_s: float
    engine_step_s: float
    warm_up_steps: int  # of the engine
    steps: int  # of the engine, after the warm-up
    variables: tuple[tuple[str, str], ...]  # that are read at each of its steps: name and key
    sensed: tuple[tuple[int, float], ...]  # places of those that the sensor is exposed to, and their weights
    longest_silence_s: float
    codes: tuple[bytes, ...] = ()  # of `native_code`, for a chain that is machine code

    @property
    def chain_steps(self) -> int:
        """Steps of the chain in one of the engine."""
        return round(self.engine_step_s / self.step_s)

    @abstractmethod
    def loop(self, engine: Engine) -> Loop:
        """Return the run in an engine of this process."""


class Loop(ABC):
    """The state of a run between steps of the engine, and its record: `rows` and `chain`, one after another."""

    def __init__(self, job: Job, engine: Engine) -> None:
        self.job, self.engine = job, engine
        self.chain_of, self.is_warm = carried(job.advance), False
        self.native: Native | None = None
        self.wire = Wire(step=-job.warm_up_steps)
        self.sensed_C: list[float] = []  # at the end of the last two steps
        self.values: Callable[[], list[float]] | None = None
        number, self.width = ctypes.c_double, job.chain_steps * ROW
        self.rows: Any = (number * (job.steps * len(job.variables)))()
        self.chain: Any = (number * (job.steps * self.width))()
        self.spare: Any = (number * self.width)()  # for steps that are not kept
        for name, key in job.variables:
            engine.request(name, key)
        if job.codes and isinstance(self.chain_of, Standalone):
            self.chain_of.codes = [*self.chain_of.codes, *job.codes]
            self.native = Native(self.chain_of, self.wire)
            engine.watch_also(lambda: int(self.wire.step))
        for moment, call, name in ((BEFORE_PREDICTOR, self.drive, DRIVE), (AFTER_REPORTING, self.read, READ)):
            engine.at(moment, call, partial(self.native.callback, name) if self.native else None)

    @abstractmethod
    def hold(self) -> None:
        """Set the flow in the engine's own warm-up."""

    @abstractmethod
    def set_share(self, share: float) -> None:
        """Set the flow, a share of the full one."""

    @property
    @abstractmethod
    def plain_flow(self) -> tuple[int, float] | None:
        """Handle of the flow's actuator and the full flow [kg/s], where `set_share` does nothing else."""

    def find(self) -> None:
        """Find the handles, as soon as there are any."""
        self.handles = [self.engine.handle(*each) for each in self.job.variables]
        self.values = self.engine.values(self.handles)

    @property
    def step(self) -> int:
        """The step of the engine, counted from the end of the warm-up."""
        return int(self.wire.step)

    @property
    def time_s(self) -> float:
        return self.step * self.job.engine_step_s

    @property
    def is_kept(self) -> bool:
        return 0 <= self.step < self.job.steps

    def is_warming(self) -> bool:
        """Whether the engine still repeats the first day; it does so once."""
        self.is_warm = self.is_warm or not self.engine.warming_up
        return not self.is_warm

    def drive(self) -> None:
        """Before the predictor: let the chain run through the step on a reading that goes on as it went."""
        if not (self.is_warm or self.engine.in_weather):
            return
        if self.values is None:
            self.find()
        if self.is_warming() or not self.sensed_C:
            self.hold()
            return
        job, (before_C, last_C) = self.job, self.sensed_C
        rise_K_s = (last_C - before_C) / job.engine_step_s
        place = ctypes.addressof(self.spare)
        if self.is_kept:
            place = ctypes.addressof(self.chain) + self.step * ctypes.sizeof(self.spare)
        self.set_share(self.chain_of.carry(last_C, rise_K_s, self.time_s, job.step_s, job.chain_steps, place))

    def read(self) -> None:
        """After reporting: keep what the step has brought."""
        if self.values is None or not (self.is_warm or self.engine.in_weather):
            return
        self.end()
        values = self.values()
        sensed_C = sum([weight * values[place] for place, weight in self.job.sensed])
        self.sensed_C = [self.sensed_C[-1] if self.sensed_C else sensed_C, sensed_C]
        if self.is_warming():
            return
        if self.is_kept:
            first = self.step * len(values)
            self.rows[first : first + len(values)] = values
        self.wire.step += 1
        if self.native and self.plain_flow:
            self._hand_over(self.native, *self.plain_flow)

    def _hand_over(self, native: Native, flow: int, full_flow_kg_s: float) -> None:
        """Let machine code do the rest, as `drive` and `read` do it."""
        job, wire = self.job, self.wire
        wire.state, wire.get_value, wire.set_value = self.engine.addresses()
        wire.handles, wire.variables = native.table(Address, self.handles), len(self.handles)
        wire.places = native.table(Address, [place for place, _ in job.sensed])
        wire.weights, wire.sensed = native.table(Number, [weight for _, weight in job.sensed]), len(job.sensed)
        wire.rows, wire.chain, wire.spare = (ctypes.addressof(each) for each in (self.rows, self.chain, self.spare))
        wire.chain_bytes, wire.steps = ctypes.sizeof(self.spare), job.steps
        wire.before_C, wire.last_C = self.sensed_C
        wire.engine_step_s, wire.flow, wire.full_flow_kg_s = job.engine_step_s, flow, full_flow_kg_s
        wire.is_active = 1

    def end(self) -> None:
        """Raise what machine code could not, at the latest after the run."""
        if (self.native or self.wire.failed) and isinstance(self.chain_of, Standalone):
            self.chain_of.refuse(self.wire.failed, self.time_s, self.job.step_s)
