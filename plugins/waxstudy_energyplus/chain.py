"""The chain between two moments at which the engine tells the temperature."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from waxstudy.plugin import Advance, FloatArray

CHAIN = ("output", "signal", "opening", "flow_fraction")
CHAIN_ROW = (*CHAIN, "sensed_C")  # what the chain gave in a step, and what it was told
FLOW = CHAIN.index("flow_fraction")


def through(
    advance: Advance, told_C: Sequence[float], time_s: float, step_s: float, engine_step_s: float
) -> FloatArray:
    """Return a row (`CHAIN_ROW`) per step of the chain through one step of the engine.

    `told_C` are the temperatures at the ends of the engine's last two steps; the reading goes on as straight as they.
    """
    before_C, last_C = told_C
    rise_K_s = (last_C - before_C) / engine_step_s
    rows = np.empty((round(engine_step_s / step_s), len(CHAIN_ROW)))
    for n in range(len(rows)):
        ahead_s = n * step_s
        sensed_C = last_C + rise_K_s * ahead_s
        rows[n] = *advance(sensed_C, time_s + ahead_s, step_s), sensed_C
    return rows
