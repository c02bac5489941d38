"""A chain that is called step by step, carried through a step of the engine as one in machine code is."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING

from waxstudy.simulation.standalone import CHAIN_ROW, ROW, Standalone

if TYPE_CHECKING:
    from waxstudy.plugin import Advance

FLOW = CHAIN_ROW.index("flow_fraction")


class Called:
    """The `carry` of a `Standalone` chain for any `advance`."""

    def __init__(self, advance: Advance) -> None:
        self.advance = advance

    def carry(self, sensed_C: float, rise_K_s: float, time_s: float, step_s: float, count: int, rows: int) -> float:
        row, total = (ctypes.c_double * (count * ROW)).from_address(rows), 0.0
        for n in range(count):
            ahead_s = n * step_s
            reading_C = sensed_C + rise_K_s * ahead_s
            given = [float(value) for value in self.advance(reading_C, time_s + ahead_s, step_s)]
            row[n * ROW : (n + 1) * ROW] = [*given, reading_C]
            total += given[FLOW]
        return total / count


def carried(advance: Advance) -> Called | Standalone:
    return advance if isinstance(advance, Standalone) else Called(advance)
