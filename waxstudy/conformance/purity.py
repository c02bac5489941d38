"""Names in a block's code that make its results depend on more than its arguments."""

from __future__ import annotations

import dis
from collections.abc import Iterator
from types import CodeType, FunctionType, ModuleType
from typing import Any

from waxstudy.plugin import Block

IMPURE = ("time", "datetime", "random", "secrets", "uuid", "os", "io", "threading", "socket", "numpy.random")
IMPURE_BUILTINS = ("open", "input", "id", "hash", "globals")


def impure_names(block: type[Block]) -> Iterator[tuple[str, int]]:
    """Yield each such name with its line, for `step`, `start` and the functions of the same package they call."""
    seen: set[CodeType] = set()
    for function in (block.step, getattr(block.start, "__func__", block.start)):
        if isinstance(function, FunctionType):
            yield from _in_function(function, seen)


def _in_function(function: FunctionType, seen: set[CodeType]) -> Iterator[tuple[str, int]]:
    if function.__code__ in seen:
        return
    seen.add(function.__code__)
    line, module = function.__code__.co_firstlineno, None
    for instruction in dis.get_instructions(function):
        line = (instruction.positions and instruction.positions.lineno) or line
        name = str(instruction.argval)
        if instruction.opname == "IMPORT_NAME" and _is_impure(name):
            yield name, line
        elif instruction.opname == "LOAD_GLOBAL":
            found = function.__globals__.get(name)
            module = found if isinstance(found, ModuleType) else None
            if _is_impure(_origin(found)) or (found is None and name in IMPURE_BUILTINS):
                yield name, line
            elif isinstance(found, FunctionType) and _package(found) == _package(function):
                yield from _in_function(found, seen)
        elif module and instruction.opname in ("LOAD_ATTR", "LOAD_METHOD"):
            if _is_impure(f"{module.__name__}.{name}"):
                yield f"{module.__name__}.{name}", line
            module = None


def _origin(found: Any) -> str:
    """The module that a global object is, or comes from."""
    return found.__name__ if isinstance(found, ModuleType) else str(getattr(found, "__module__", None) or "")


def _is_impure(module: str) -> bool:
    return any(module == name or module.startswith(f"{name}.") for name in IMPURE)


def _package(function: FunctionType) -> str:
    return function.__module__.split(".")[0]
