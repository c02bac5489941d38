"""What a run does at each step in machine code, once it is warm: no Python of the chain runs then.

`native_code.py` makes the code where numba is; here it is loaded and told where all is.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

from waxstudy.simulation.standalone import CARRY, Address, Number, Standalone

READ, DRIVE = "read", "drive"  # what is done after reporting, and before the predictor
AT = "at_"  # and the callbacks of the engine that do it


class Wire(ctypes.Structure):
    """Where all is that a step needs."""

    _fields_ = (
        ("is_active", Address),  # else the engine calls Python
        ("state", Address),
        ("get_value", Address),
        ("set_value", Address),
        ("carry", Address),
        ("told", Address),
        ("handles", Address),
        ("variables", Address),
        ("rows", Address),
        ("places", Address),
        ("weights", Address),
        ("sensed", Address),
        ("flow", Address),
        ("step", Address),
        ("steps", Address),
        ("chain", Address),
        ("spare", Address),
        ("chain_bytes", Address),
        ("before_C", Number),
        ("last_C", Number),
        ("engine_step_s", Number),
        ("full_flow_kg_s", Number),
        ("failed", Number),  # what `carry` gave of a block that failed, else 0
    )


class Native:
    """The code in this process. `callback` is for the engine; it calls Python until a run is warm."""

    def __init__(self, chain: Standalone, wire: Wire) -> None:
        self.code, self.kept = chain.engine, list[Any]()
        wire.carry, wire.told = self.code.get_function_address(CARRY), ctypes.addressof(chain.told)
        self._put("wire", ctypes.addressof(wire))

    def callback(self, name: str, python: int) -> int:
        """Return the address of what the engine calls in place of Python's function at an address."""
        self._put(f"python_{name}", python)
        return int(self.code.get_function_address(AT + name))

    def table(self, kind: Any, values: Sequence[float]) -> int:
        self.kept.append((kind * len(values))(*values))
        return ctypes.addressof(self.kept[-1])

    def _put(self, symbol: str, value: int) -> None:
        Address.from_address(self.code.get_global_value_address(symbol)).value = value
