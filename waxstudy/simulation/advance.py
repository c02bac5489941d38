"""A case's chain as an outside engine calls it, step by step, wherever that engine runs."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from functools import cached_property
from typing import Any

from waxstudy.simulation.chain import Chain
from waxstudy.simulation.interpreted import checked
from waxstudy.simulation.kernel import CONTROLLER
from waxstudy.simulation.standalone import Standalone
from waxstudy.study.model import Choice


class ChainAdvance:
    """The blocks of a case at a setpoint, called step by step; raises `SimulationError` as the fast room's loop does.

    It is pickled before its first step, and becomes machine code then (`Standalone`) if all its blocks can and `jit`
    holds. Else they run in Python, as with `--no-jit`.
    """

    def __init__(self, blocks: Mapping[str, Choice], step_s: float, setpoint_C: float, jit: bool = True) -> None:
        self.blocks, self.step_s, self.setpoint_C, self.jit = dict(blocks), step_s, setpoint_C, jit
        self._ready: list[tuple[Any, Any, Any]] = []

    @property
    def is_machine_code(self) -> bool:
        """Whether it is pickled as machine code."""
        return self._standalone is not None

    @cached_property
    def _standalone(self) -> Standalone | None:
        if not self.jit or sys.platform == "win32":  # where code finds the C library's functions otherwise
            return None
        from waxstudy.simulation.carry import standalone

        return standalone(self.blocks, self.step_s, self.setpoint_C)

    def __reduce__(self) -> tuple[Any, ...]:
        if (chain := self._standalone) is not None:
            return Standalone, (chain.codes, chain.stages, chain.setpoint_C)
        return ChainAdvance, (self.blocks, self.step_s, self.setpoint_C, False)

    def __call__(self, sensed_C: float, time_s: float, step_s: float) -> list[float]:
        """Return output, signal, opening and flow fraction after a step; a block left out passes on what it gets."""
        if not self._ready:
            chain = Chain(self.blocks, self.step_s)
            steps = [checked(block) if block else None for block in chain.blocks]
            self._ready = list(zip(steps, chain.plain, chain.start(), strict=True))
        u, values = sensed_C, []
        for place, (step, p, x) in enumerate(self._ready):
            if place == CONTROLLER:
                u = self.setpoint_C - u
            if step is not None:
                u = step(p, x, u, time_s, step_s)
            values.append(u)
        return values[CONTROLLER:]
