"""Part of a chain driven by a recorded signal instead of by the room: open loop, so that nothing feeds back."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit, types

from waxstudy.plugin import CHAIN, FloatArray, SimulationError
from waxstudy.simulation.cache import cached
from waxstudy.simulation.chain import Chain, CompiledChain
from waxstudy.simulation.interpreted import clock
from waxstudy.simulation.kernel import CHAIN_LENGTH, CONTROLLER, DONE, call_block


def run(
    steps: Any,  # (5,) block functions, 0 where there is none or it takes no part
    parameters: Any,  # (5,)
    states: Any,  # (5,) changed in place
    low: Any,  # (5,) and high: range of each block's output
    high: Any,
    signal: Any,  # (n,) what drives the first block, at the end of each interval
    setpoint: Any,  # (n,) C
    jump: Any,  # (n,) part of the interval after which the signal jumps; below 0 it runs straight through it
    first: int,  # place of the first block
    dt: float,
    steps_per_interval: int,
    start_s: float,
    ends: Any,  # (n, 5) out: output of each place at the end of an interval
    means: Any,  # (n, 5) out: its mean over the interval
    counters: Any,  # (1,) out: failing step
) -> int:
    """Run the blocks over all intervals; return DONE or the place of the block that failed."""
    before = signal[0]
    for n in range(len(signal)):
        now = signal[n]
        for i in range(steps_per_interval):
            part = (i + 0.5) / steps_per_interval
            share = part if jump[n] < 0.0 else (1.0 if part > jump[n] else 0.0)
            u = before + (now - before) * share
            t = start_s + (n * steps_per_interval + i) * dt
            for k in range(first, CHAIN_LENGTH):
                if k == CONTROLLER:
                    u = setpoint[n] - u
                if steps[k] != 0:
                    u = call_block(steps[k], parameters[k], states[k], u, t, dt)
                    if not (low[k] <= u <= high[k]):
                        counters[0] = n * steps_per_interval + i
                        return k
                ends[n, k] = u
                means[n, k] += u / steps_per_interval
        before = now
    return DONE


_NUMBERS, _TABLE, _COUNTS = types.float64[::1], types.float64[:, ::1], types.int64[::1]
_RUN = types.int64(
    *[_COUNTS] * 3,
    *[_NUMBERS] * 5,
    types.int64,
    types.float64,
    types.int64,
    types.float64,
    _TABLE,
    _TABLE,
    _COUNTS,
)


@cache
def compiled() -> Callable[..., int]:
    """Return the compiled loop; it releases the interpreter lock."""

    def build(folder: Path | None) -> Any:
        return njit(_RUN, nogil=True, cache=folder is not None)(run)

    function: Callable[..., int] = cached(build)
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
) -> tuple[dict[str, FloatArray], dict[str, FloatArray]]:
    """Drive a chain from the block of kind `first` on; return each kind's output (n,) at the ends, and its means.

    `signal` (n,) is what that block would get (the sensor's temperature, for the controller the reading), at the end
    of each interval, the first of which starts `start_s` after midnight. A kind without a block passes on what it
    gets. With `jump` (n,) the signal is a switch that jumps after that part of each interval; without, it runs straight
    from sample to sample. Raises `SimulationError`.
    """
    ready = CompiledChain(chain)
    place, count = CHAIN.index(first), len(signal)
    states = ready.start()
    ends, means, counters = (
        np.zeros((count, CHAIN_LENGTH)),
        np.zeros((count, CHAIN_LENGTH)),
        np.zeros(1, dtype=np.int64),
    )
    code = compiled()(
        ready.addresses,
        ready.parameters,
        ready.pointers(states),
        chain.low,
        chain.high,
        np.array(signal, dtype=float),  # a copy: compiled code takes no read-only memory
        np.array(setpoint_C, dtype=float),
        np.full(count, -1.0) if jump is None else np.array(jump, dtype=float),
        place,
        chain.step_s,
        round(interval_s / chain.step_s),
        start_s,
        ends,
        means,
        counters,
    )
    failed = ready.failed(states) if code == DONE else code
    if failed is not None:
        kind = CHAIN[failed] if failed < CHAIN_LENGTH else "room"
        raise SimulationError(f"{kind} failed at {clock(start_s + float(counters[0]) * chain.step_s)} of the record")
    return (
        {kind: ends[:, k] for k, kind in enumerate(CHAIN) if k >= place},
        {kind: means[:, k] for k, kind in enumerate(CHAIN) if k >= place},
    )
