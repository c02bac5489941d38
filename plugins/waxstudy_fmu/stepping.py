"""The chain closed over an FMU, step by step, in the process that runs it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from waxstudy.plugin import TRACE, FloatArray
from waxstudy.simulation.engine import DAY_S, WARM_UP_DAYS
from waxstudy.simulation.interpreted import clock
from waxstudy.simulation.watch import Watch
from waxstudy_fmu.job import Job
from waxstudy_fmu.package import opened
from waxstudy_fmu.roles import STANDS_FOR


class FmuFailed(Exception):
    """The FMU refused a call, or gave something that is no number; the message says what and when."""


class Slave:
    """An FMU of either version, by value references; what it refuses becomes `FmuFailed`."""

    def __init__(self, job: Job, folder: Path, watch: Watch) -> None:
        import fmpy
        from fmpy.fmi2 import FMU2Slave
        from fmpy.fmi3 import FMU3Slave

        package = opened(job.path)
        self.watch, self.when = watch, "before the warm-up"
        unpacked = fmpy.extract(str(job.path), str(folder / "fmu"))
        given = {"guid": package.description.guid, "unzipDirectory": unpacked, "modelIdentifier": package.identifier}
        self.slave: Any = (FMU2Slave if package.fmi == 2 else FMU3Slave)(instanceName="room", **given)
        self.is_2 = package.fmi == 2
        self.call("instantiate", self.slave.instantiate)

    def call(self, name: str, function: Any, *arguments: Any, **named: Any) -> Any:
        self.watch.begin(name)
        try:
            return function(*arguments, **named)
        except Exception as error:
            raise FmuFailed(f"the FMU failed {self.when}: {error}") from error
        finally:
            self.watch.end()

    def begin(self) -> None:
        if self.is_2:
            self.call("setupExperiment", self.slave.setupExperiment, startTime=0.0)
            self.call("enterInitializationMode", self.slave.enterInitializationMode)
        else:
            self.call("enterInitializationMode", self.slave.enterInitializationMode, startTime=0.0)
        self.call("exitInitializationMode", self.slave.exitInitializationMode)

    def set(self, references: list[int], values: list[float]) -> None:
        if references:
            self.call("set", self.slave.setReal if self.is_2 else self.slave.setFloat64, references, values)

    def get(self, references: list[int]) -> list[float]:
        values: list[float] = self.call("get", self.slave.getReal if self.is_2 else self.slave.getFloat64, references)
        return values

    def step(self, at_s: float, step_s: float) -> None:
        self.call("doStep", self.slave.doStep, at_s, step_s)


def record(job: Job, folder: Path, watch: Watch) -> FloatArray:
    """Return the record of a job (steps, len(TRACE)), after the warm-up."""
    slave = Slave(job, folder, watch)
    inputs = job.variables.inputs
    starts = [role for role in ("start_air_C", "start_floor_C") if role in inputs]
    slave.set([inputs[role].reference for role in starts], [inputs[r].theirs(job.start[r]) for r in starts])
    slave.set(list(job.given), [float(series[0]) for series in job.given.values()])
    slave.begin()
    per_interval = round(job.interval_s / job.step_s)
    steps, warm = len(job.supply_C) * per_interval, round(WARM_UP_DAYS * DAY_S / job.step_s)
    rows, state, interval = np.zeros((steps, len(TRACE))), _outputs(slave, job), -1
    for n in range(-warm, steps):
        time_s = n * job.step_s
        slave.when = f"at {clock(time_s)}"
        now = int((time_s % DAY_S if n < 0 else time_s) / job.interval_s + 1e-9)
        if now != interval:
            interval = now
            slave.set(list(job.given), [float(series[now]) for series in job.given.values()])
        chain = job.advance(state["sensed_C"], time_s, job.step_s)
        heat_W = _drive(slave, job, float(chain[-1]), float(job.supply_C[now]), state["layer_C"])
        slave.step((n + warm) * job.step_s, job.step_s)
        state = _outputs(slave, job)
        if n >= 0:
            rows[n] = _row(job, state, chain, float(job.supply_C[now]), heat_W)
    return rows


def _drive(slave: Slave, job: Job, fraction: float, supply_C: float, layer_C: float) -> float:
    """Give the FMU its flow, or its heat; return the heat [W], NaN where only the FMU knows it."""
    inputs = job.variables.inputs
    if "heat_W" in inputs:
        place = np.linspace(0.0, 1.0, len(job.conductance_W_K))
        heat_W = float(np.interp(fraction, place, job.conductance_W_K)) * (supply_C - layer_C)
        slave.set([inputs["heat_W"].reference], [inputs["heat_W"].theirs(heat_W)])
        return heat_W
    flow = inputs["flow"]
    slave.set([flow.reference], [fraction if flow.unit == "1" else flow.theirs(fraction * job.full_flow_L_h)])
    return math.nan


def _outputs(slave: Slave, job: Job) -> dict[str, float]:
    """Return what the FMU gives, in our units, and what stands for what it does not give."""
    outputs = job.variables.outputs
    numbers = slave.get([each.reference for each in outputs.values()])
    state = {}
    for (role, each), number in zip(outputs.items(), numbers, strict=True):
        if not math.isfinite(number):
            raise FmuFailed(f"the FMU gave {number:g} for {role} (variable {each.name}) {slave.when}")
        state[role] = each.ours(number)
    for role, other in STANDS_FOR.items():
        state.setdefault(role, state[other])
    return state


def _row(job: Job, state: dict[str, float], chain: Any, supply_C: float, heat_W: float) -> list[float]:
    """Return a row of the record."""
    if "water_heat_W" in state:
        heat_W = state["water_heat_W"]
    elif "return_C" in state and math.isnan(heat_W):
        flow_L_s = float(chain[-1]) * job.full_flow_L_h / 3600.0
        heat_W = flow_L_s * job.water_J_L_K * (supply_C - state["return_C"])
    floor_W_m2 = state.get("floor_heat_W_m2", heat_W / job.floor_area_m2)
    known = {**state, "floor_heat_W_m2": floor_W_m2, "water_heat_W": heat_W}
    known |= dict(zip(("output", "signal", "opening", "flow_fraction"), chain, strict=True))
    return [known[name] for name in TRACE]
