"""A bench for actuators on their own: drive one with a signal, and read its characteristic times off the opening."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from types import FunctionType
from typing import Any

import numpy as np
from numba import njit
from numba.extending import register_jitable

from waxstudy.plugin import Actuator, FloatArray
from waxstudy.plugin.registry import installed
from waxstudy.simulation.records import parameter_record, plain_parameters, state_dtype
from waxstudy_enthalpy import motor
from waxstudy_enthalpy.parameters import EnthalpyParameters

STEP_S = 5.0
SLACK = 0.01  # the valve moves from 1 % and has moved at 99 % of the stroke
TIMES = ("dead", "rise", "hold", "fall")
PROFILES_MIN = ((15, 15), (15, 45), (30, 30), (10, 10))  # of the paper's Table 1
SETTLING_S = 6 * 3600.0  # several times the longest memory of both models (19 min)

Times = tuple[float, float, float, float]


def empirical(product: str, signal: FloatArray, dt: float = STEP_S) -> FloatArray:
    """Return the opening that the paper's `variable-times` answers a signal with, from a long pause."""
    block: Any = installed().get("actuator", "variable-times")
    return interpreted(block, plain_parameters(block.Parameters.model_validate({"product": product})), signal, dt)


def interpreted(block: type[Actuator], p: Any, signal: FloatArray, dt: float) -> FloatArray:
    """Return the opening of any actuator at the end of each step, stepped by the interpreter."""
    x = block.start(p, dt)
    return np.array([block.step(p, x, float(u), n * dt, dt) for n, u in enumerate(signal)])


def parameters(values: Mapping[str, Any]) -> Any:
    """Return the plain parameters of the motor; what is not given is that of the product."""
    return plain_parameters(EnthalpyParameters.model_validate(dict(values)))


class Rig:
    """A motor that is driven by compiled code and keeps its state between calls."""

    def __init__(self, p: Any, dt: float = STEP_S) -> None:
        self.p, self.dt = p, dt
        self._parameters = parameter_record(p)
        self._state = np.zeros(1, dtype=state_dtype(motor.Motor))
        for name, value in vars(motor.Enthalpy.start(p, dt)).items():
            self._state[name] = value

    def run(self, signal: FloatArray) -> FloatArray:
        """Return the opening at the end of each step of a signal."""
        opening: FloatArray = _driver()(self._parameters, self._state, np.asarray(signal, dtype=float), self.dt)
        return opening

    def copy(self) -> Rig:
        """Return a second motor in the same state."""
        other = Rig(self.p, self.dt)
        other._state[:] = self._state
        return other

    def __getattr__(self, name: str) -> float:
        if name.startswith("_"):
            raise AttributeError(name)
        return float(self._state[name][0])


@cache
def _driver() -> Callable[..., FloatArray]:
    """Compile the loop; the motor's functions are made known to numba and stay plain functions."""
    for function in vars(motor).values():
        if isinstance(function, FunctionType) and function.__module__ == motor.__name__:
            register_jitable(function)
    step = register_jitable(motor.Enthalpy.step)

    @njit(error_model="python")  # type: ignore[misc,unused-ignore]
    def drive(p, x, signal, dt):  # type: ignore[no-untyped-def]
        opening = np.empty(len(signal))
        for n in range(len(signal)):
            opening[n] = step(p[0], x[0], signal[n], n * dt, dt)
        return opening

    return drive  # type: ignore[no-any-return,unused-ignore]


def on_off(on_min: float, off_min: float, cycles: int, dt: float = STEP_S) -> FloatArray:
    """Return the signal of a periodic profile, on first."""
    on, off = round(60.0 * on_min / dt), round(60.0 * off_min / dt)
    return np.tile(np.concatenate([np.ones(on), np.zeros(off)]), cycles)


def settled_cycles(on_min: float, off_min: float) -> int:
    """Return how many cycles of a profile make a cycle that no longer changes."""
    return round(SETTLING_S / (60.0 * (on_min + off_min))) + 1


def crossing_s(part: FloatArray, before: float, level: float, rising: bool, dt: float) -> float:
    """Return when an opening first passes a level, between steps by a line; what is missing counts on from the end."""
    values = np.concatenate([[before], part])
    beyond = values >= level if rising else values <= level
    if beyond[0]:
        return 0.0
    n = int(np.argmax(beyond))
    if n == 0:  # never: a penalty that falls as the opening comes nearer
        return dt * len(part) + 1000.0 * abs(float(level - values[-1]))
    low, high = values[n - 1], values[n]
    return float(dt * (n - 1 + (level - low) / (high - low)))


def cycle_times(opening: FloatArray, before: float, on_s: float, dt: float = STEP_S) -> Times:
    """Return dead, rise, hold and fall time [s] of one cycle that starts with switching on.

    Dead: switching on to 1 % of the stroke; rise: 1 to 99 %; hold: switching off to 99 %; fall: 99 to 1 %. The paper
    cuts by slope instead; both models are read in the same way here.
    """
    on = round(on_s / dt)
    up, down = opening[:on], opening[on:]
    moves = crossing_s(up, before, SLACK, True, dt)
    open_ = crossing_s(up, before, 1.0 - SLACK, True, dt)
    leaves = crossing_s(down, up[-1], 1.0 - SLACK, False, dt)
    closed = crossing_s(down, up[-1], SLACK, False, dt)
    return moves, open_ - moves, leaves, closed - leaves


def last_cycle(opening: FloatArray, on_min: float, off_min: float, dt: float = STEP_S) -> Times:
    """Return the times of the last cycle of a periodic profile."""
    steps = round(60.0 * (on_min + off_min) / dt)
    before = opening[-steps - 1] if len(opening) > steps else 0.0
    return cycle_times(opening[-steps:], before, 60.0 * on_min, dt)


def steady_times(respond: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Return the times of the settled cycle of each profile (profiles, times) [s]."""
    rows = []
    for on_min, off_min in PROFILES_MIN:
        opening = respond(on_off(on_min, off_min, settled_cycles(on_min, off_min)))
        rows.append(last_cycle(opening, on_min, off_min))
    return np.array(rows)
