"""A chain as machine code that needs neither numba nor the blocks where it runs.

It is made where both are there (`carry.py`), pickled, and loaded by LLVM alone in the process of another engine: that
takes less than a tenth of a second, where numba takes one.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import Any

CARRY = "carry"  # the name of the loop in its machine code
CHAIN_ROW = ("output", "signal", "opening", "flow_fraction", "sensed_C")  # what the chain gave, and what it was told
ROW = len(CHAIN_ROW)
Address, Number = ctypes.c_int64, ctypes.c_double


def loaded(codes: Sequence[bytes]) -> Any:
    """Return LLVM's engine with object files in it, which has to be kept as long as their code is called."""
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    engine = llvm.create_mcjit_compiler(
        llvm.parse_assembly(""), llvm.Target.from_default_triple().create_target_machine(jit=True)
    )
    for code in codes:
        engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return engine


def function_in(engine: Any, symbol: str) -> Any:
    """Return a function of one address that gives a number, called as numba calls: its result goes to a place."""
    kind = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)
    return kind(engine.get_function_address(symbol))


class Told(ctypes.Structure):
    """What the loop of the chain is told, and what it gives."""

    _fields_ = (
        *((name, Address) for name in ("steps", "parameters", "states", "low", "high", "count", "rows")),
        *((name, Number) for name in ("setpoint_C", "sensed_C", "rise_K_s", "start_s", "step_s")),
    )


@dataclass(frozen=True)
class Stage:
    """A block of the chain: its symbol ("" where the chain leaves it out), memory, and range."""

    kind: str
    symbol: str = ""
    label: str = ""
    parameters: bytes = b""
    state: bytes = b""
    low: float = 0.0
    high: float = 0.0


@dataclass
class Standalone:
    """A chain at rest, to be called step by step or, quicker, for many steps at once; it keeps its own state.

    Raises `CompiledFailure`, a `SimulationError`, where a block fails; Python then tells why.
    """

    codes: Sequence[bytes]  # object files
    stages: Sequence[Stage]
    setpoint_C: float

    def __call__(self, sensed_C: float, time_s: float, step_s: float) -> list[float]:
        """Return output, signal, opening and flow fraction after a step."""
        row = (Number * ROW)()
        self.carry(sensed_C, 0.0, time_s, step_s, 1, ctypes.addressof(row))
        return list(row)[: ROW - 1]

    def carry(self, sensed_C: float, rise_K_s: float, time_s: float, step_s: float, count: int, rows: int) -> float:
        """Run so many steps on a straight temperature; return their mean flow fraction.

        `rows` is the address of as many rows of `CHAIN_ROW`.
        """
        ready = self._ready
        told = ready.told
        told.sensed_C, told.rise_K_s, told.start_s, told.step_s = sensed_C, rise_K_s, time_s, step_s
        told.count, told.rows = count, rows
        ready.call(*ready.places)
        mean: float = ready.mean.value
        self.refuse(mean, time_s, step_s)
        return mean

    def refuse(self, mean: float, time_s: float, step_s: float) -> None:
        """Raise `CompiledFailure` if the loop gave a failure in place of a mean, or a block changed its parameters."""
        ready = self._ready
        if mean < 0.0:
            step, place = divmod(round(-mean) - 1, len(self.stages))
            self._fail(self.stages[place], time_s + step * step_s)
        if ready.parameters.raw != ready.intact:  # what cannot happen in Python
            self._fail(ready.changed(), time_s)

    @property
    def engine(self) -> Any:
        """LLVM's engine with all of `codes`."""
        return self._ready.engine

    @property
    def told(self) -> Told:
        return self._ready.told

    def _fail(self, stage: Stage, time_s: float) -> None:
        from waxstudy.simulation.interpreted import CompiledFailure, clock  # loads the rest of the library

        raise CompiledFailure(stage.label, clock(time_s))

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name != "_ready"}

    @cached_property
    def _ready(self) -> _Ready:
        return _Ready(self)


class _Ready:
    """The code of a chain in this process, and the memory that it works on."""

    def __init__(self, chain: Standalone) -> None:
        self.stages, self.engine = chain.stages, loaded(chain.codes)
        self.kept: list[Any] = []
        self.parameters, self.first = self._memory([s.parameters for s in chain.stages])
        self.intact = self.parameters.raw
        _, states = self._memory([s.state for s in chain.stages])
        steps = [self.engine.get_function_address(s.symbol) if s.symbol else 0 for s in chain.stages]
        addresses = [self._table(Address, each) for each in (steps, self.first, states)]
        ranges = [self._table(Number, [getattr(s, side) for s in chain.stages]) for side in ("low", "high")]
        self.told = Told(*addresses, *ranges, setpoint_C=chain.setpoint_C)
        self.mean = Number()
        self.call, raised = function_in(self.engine, CARRY), ctypes.c_void_p()
        self.kept.append(raised)
        self.places = tuple(ctypes.c_void_p(ctypes.addressof(each)) for each in (self.mean, raised, self.told))

    def changed(self) -> Stage:
        """Return the first block that changed its parameters."""
        now = [ctypes.string_at(place, len(s.parameters)) for s, place in zip(self.stages, self.first, strict=True)]
        return next(s for s, data in zip(self.stages, now, strict=True) if data != s.parameters)

    def _memory(self, records: Sequence[bytes]) -> tuple[Any, list[int]]:
        """Return memory that holds records, each from a whole number of doubles on, and their addresses."""
        whole = [data + bytes(-len(data) % 8) for data in records]
        memory = ctypes.create_string_buffer(b"".join(whole), sum(map(len, whole)) + 8)
        self.kept.append(memory)
        ends = accumulate(map(len, whole))
        return memory, [ctypes.addressof(memory) + end - len(data) for end, data in zip(ends, whole, strict=True)]

    def _table(self, kind: Any, values: Sequence[float]) -> int:
        table = (kind * len(values))(*values)
        self.kept.append(table)
        return ctypes.addressof(table)
