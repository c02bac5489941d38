"""One block on its own, in Python or compiled."""

from __future__ import annotations

import copy
import ctypes
from collections.abc import Sequence
from typing import Any

from waxstudy.plugin import Block
from waxstudy.simulation.interpreted import checked
from waxstudy.simulation.records import parameter_record, state_record

_GUARDED = ctypes.CFUNCTYPE(
    ctypes.c_double, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_double
)


def interpreted(
    block: type[Block], p: Any, inputs: Sequence[float], dt: float, start_s: float = 0.0, state: Any = None
) -> list[float]:
    """Return the outputs, from a fresh state or a given one, which is changed.

    Raises `SimulationError` as a run would.
    """
    step = checked(block)
    x = copy.deepcopy(block.start(p, dt)) if state is None else state
    return [step(p, x, u, start_s + n * dt, dt) for n, u in enumerate(inputs)]


class CompiledBlock:
    """A block's compiled code with memory of its own."""

    def __init__(self, block: type[Block], p: Any, dt: float) -> None:
        from waxstudy.simulation.compiled import address

        self._call = _GUARDED(address(block, p))
        self._parameters, self._state = parameter_record(p), state_record(block.start(p, dt))
        self._intact = self._parameters.tobytes()

    @property
    def changed_parameters(self) -> bool:
        return self._parameters.tobytes() != self._intact

    def run(self, inputs: Sequence[float], dt: float, start_s: float = 0.0) -> list[float]:
        p, x = self._parameters.ctypes.data, self._state.ctypes.data
        return [self._call(p, x, u, start_s + n * dt, dt) for n, u in enumerate(inputs)]
