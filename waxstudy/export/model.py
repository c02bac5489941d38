"""What an exported model is, whatever it is written as: its variables, its memory at the start, its machine code."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property


class NotExportable(Exception):
    """A block cannot be written in the form that was asked for; the message says which, and why."""


@dataclass(frozen=True)
class Variable:
    """One number that an importer sees; `place` is as in `shell/model.h`."""

    name: str
    causality: str  # time, input, output, parameter or constant
    unit: str
    description: str
    place: int = 0
    start: float = 0.0
    low: float = 0.0
    high: float = 0.0
    above_low: bool = False  # the bound itself is not allowed
    below_high: bool = False
    type: str = "d"  # d: double, q: whole number, ?: boolean


@dataclass(frozen=True)
class Stage:
    """One block of a chain; without code it passes on what it gets."""

    label: str
    code: str = ""  # LLVM's text of a function that has the name `symbol`
    symbol: str = ""
    parameters: int = 0  # first byte
    state: int = 0
    low: float = 0.0
    high: float = 0.0
    subtracts: bool = False  # its input from the setpoint


@dataclass(frozen=True)
class Model:
    """A chain, or a single block, ready to be written."""

    title: str
    step_s: float
    variables: Sequence[Variable]
    parameters: bytes
    state: bytes
    stages: Sequence[Stage]

    def of(self, causality: str) -> list[Variable]:
        return [variable for variable in self.variables if variable.causality == causality]

    @cached_property
    def token(self) -> str:
        """A UUID of what the model does: the same model has the same one."""
        parts = repr((self.title, self.step_s, self.variables, self.parameters, self.state, self.stages))
        digest = hashlib.sha256(parts.encode()).hexdigest()
        return "-".join(("{" + digest[:8], digest[8:12], digest[12:16], digest[16:20], digest[20:32] + "}"))
