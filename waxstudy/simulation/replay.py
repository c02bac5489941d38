"""Part of a chain driven by a recorded signal instead of by the room: open loop, so that nothing feeds back."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit, types
from numpy.typing import ArrayLike

from waxstudy.plugin import CHAIN, FloatArray, SimulationError
from waxstudy.simulation.cache import cached
from waxstudy.simulation.chain import Chain, CompiledChain
from waxstudy.simulation.interpreted import clock
from waxstudy.simulation.kernel import CONTROLLER, DONE, call_block


def run(step: Any, parameters: Any, state: Any, low: float, high: float, u: Any, start_s: float, dt: float) -> int:
    """Put a block's output (steps,) in the place of its input; return DONE or the step at which it failed."""
    for n in range(len(u)):
        shown = call_block(step, parameters, state, u[n], start_s + n * dt, dt)
        if not (low <= shown <= high):  # false for NaN too
            return n
        u[n] = shown
    return DONE


def spread(signal: Any, jump: Any, u: Any) -> None:
    """Put a signal (n,) in the middle of each step into u (n, parts); `jump` (n,) is as for `replay`, (0,) for none."""
    parts = u.shape[1]
    for i in range(len(signal)):
        before, now = signal[max(0, i - 1)], signal[i]
        for k in range(parts):
            middle = (k + 0.5) / parts
            if len(jump) == 0:
                u[i, k] = (now - before) * middle + before
            else:
                u[i, k] = now if now == before or middle > jump[i] else before


def subtract(setpoint_C: Any, u: Any) -> None:
    """Put the error in the place of the reading u (n, parts), by the setpoint of each interval (n,)."""
    for i in range(len(setpoint_C)):
        for k in range(u.shape[1]):
            u[i, k] = setpoint_C[i] - u[i, k]


_POINTER, _NUMBER, _STEPS = types.int64, types.float64, types.float64[:, ::1]
_SERIES = types.Array(_NUMBER, 1, "C", readonly=True)
_SIGNATURES = {
    run: types.int64(_POINTER, _POINTER, _POINTER, _NUMBER, _NUMBER, _NUMBER[::1], _NUMBER, _NUMBER),
    spread: types.void(_SERIES, _SERIES, _STEPS),
    subtract: types.void(_SERIES, _STEPS),
}


@cache
def compiled(loop: Callable[..., Any]) -> Callable[..., Any]:
    """Return one of the loops above, compiled; it releases the interpreter lock."""

    def build(folder: Path | None) -> Any:
        return njit(_SIGNATURES[loop], nogil=True, cache=folder is not None)(loop)

    function: Callable[..., Any] = cached(build)
    return function


def replay(
    chain: Chain,
    first: str,
    signal: FloatArray,
    setpoint_C: FloatArray,
    *,
    interval_s: float,
    start_s: float,
    jump: FloatArray | None = None,
    last: str = CHAIN[-1],
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Drive a chain from the block of kind `first` on; return each kind's output (n,) at the ends, and its means.

    `signal` (n,) is what that block would get (the sensor's temperature, for the controller the reading), at the end
    of each interval, the first of which starts `start_s` after midnight. A kind without a block passes on what it
    gets. With `jump` (n,) the signal is a switch that jumps after that part of each interval; without, it runs straight
    from sample to sample. Nothing behind the block of kind `last` is run. Raises `SimulationError`.
    """
    if not len(signal) == len(setpoint_C) == len(signal if jump is None else jump):
        raise ValueError("signal, setpoint and jumps must be of the same length")
    ready = CompiledChain(chain)
    states = ready.start()
    pointers, parts = ready.pointers(states), round(interval_s / chain.step_s)
    u = _in_steps(signal, jump, parts)
    ends: dict[str, FloatArray] = {}
    means: dict[str, FloatArray] = {}
    end = mean = np.zeros(0)
    for place in range(CHAIN.index(first), CHAIN.index(last) + 1):
        if place == CONTROLLER:
            compiled(subtract)(_series(setpoint_C), u)
        if chain.blocks[place]:
            block = ready.addresses[place], ready.parameters[place], pointers[place]
            failed = compiled(run)(*block, chain.low[place], chain.high[place], u.reshape(-1), start_s, chain.step_s)
            if failed != DONE or ready.failed(states) is not None:
                at = clock(start_s + max(0, failed) * chain.step_s)
                raise SimulationError(f"{CHAIN[place]} failed at {at} of the record")
        if chain.blocks[place] or place == CONTROLLER or not ends:
            end, mean = _shown(u)
        ends[CHAIN[place]], means[CHAIN[place]] = end, mean
    return ends, means


def _shown(u: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the ends of intervals and their means (n,), from all steps (n, parts)."""
    return u[:, -1].copy(), u @ np.full(u.shape[1], 1.0 / u.shape[1])


def _in_steps(signal: FloatArray, jump: FloatArray | None, parts: int) -> FloatArray:
    """Return a signal in the middle of each step (n, parts)."""
    u = np.empty((len(signal), parts))
    compiled(spread)(_series(signal), _series([] if jump is None else jump), u)
    return u


def _series(values: ArrayLike) -> FloatArray:
    return np.ascontiguousarray(values, dtype=float)
