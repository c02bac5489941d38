"""Digests of the sources and values that results and compiled code depend on."""

from __future__ import annotations

import dis
import hashlib
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from waxstudy.plugin import Component, delayed

_SIMPLE = (bool, int, float, complex, str, bytes, tuple, frozenset, type(None))
_LIBRARIES = ("builtins", "pydantic", "numpy", "math")


# --- source files ----------------------------------------------------------------------------------


def digest(parts: Iterable[str | bytes | Path]) -> str:
    """Return a short digest of texts and file contents."""
    total = hashlib.sha256()
    for part in parts:
        data = part.read_bytes() if isinstance(part, Path) else part
        total.update(data if isinstance(data, bytes) else data.encode())
        total.update(b"\0")
    return total.hexdigest()[:16]


def _source_files(module_name: str) -> list[Path]:
    """The Python files of the top-level package (or the one file) of a module; none for one that has no file."""
    top = sys.modules.get(module_name.split(".")[0])
    folders = getattr(top, "__path__", None)
    if folders:
        return sorted(file for folder in folders for file in Path(folder).rglob("*.py"))
    file = Path(getattr(top, "__file__", None) or "")
    return [file] if file.is_file() else []


@cache
def source_digest(module_name: str) -> str:
    """Digest of the sources that a module's results depend on: its package, or for the core what simulates."""
    files = _source_files(module_name)
    if module_name.split(".")[0] == "waxstudy":
        files = [file for file in files if file.parent.name in ("plugin", "simulation", "results")]
    return digest(files)


# --- functions -------------------------------------------------------------------------------------


def helpers(function: FunctionType) -> dict[str, FunctionType]:
    """The plain functions that a function calls by name."""
    found = {name: function.__globals__.get(name) for name in global_names(function.__code__)}
    known = (delayed, function)
    return {name: f for name, f in found.items() if isinstance(f, FunctionType) and f not in known}


@cache  # code never changes
def global_names(code: CodeType) -> tuple[str, ...]:
    """The names that code takes from its module; attributes of the same name are others."""
    names = [str(i.argval) for i in dis.get_instructions(code) if i.opname in ("LOAD_GLOBAL", "LOAD_NAME")]
    inner = [name for constant in code.co_consts if isinstance(constant, CodeType) for name in global_names(constant)]
    return tuple(dict.fromkeys([*names, *inner]))


def with_helpers(function: FunctionType, seen: dict[FunctionType, None] | None = None) -> list[FunctionType]:
    """A function and all helpers below it, each once."""
    seen = {} if seen is None else seen
    if function not in seen:
        seen[function] = None
        for helper in helpers(function).values():
            with_helpers(helper, seen)
    return list(seen)


def function_digest(function: FunctionType) -> str:
    """Digest of what a function computes: code and sources, also of helpers, and the values taken from outside."""
    parts: list[str | bytes] = []
    for one in with_helpers(function):
        parts += [source_digest(one.__module__), one.__qualname__, *_code(one.__code__), *_outside(one)]
    return digest(parts)


def _code(code: CodeType) -> Iterator[str | bytes]:
    yield code.co_code
    yield repr(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _code(constant)
        else:
            yield repr(constant)


def _outside(function: FunctionType) -> Iterator[str | bytes]:
    """Defaults, closure and globals that a function uses; of a module, what has one of the code's names."""
    cells = [cell.cell_contents for cell in function.__closure__ or ()]
    named = [function.__globals__.get(name) for name in global_names(function.__code__)]
    for value in (*(function.__defaults__ or ()), *cells, *named):
        yield _value(value)
        if isinstance(value, ModuleType) and value.__name__.split(".")[0] not in _LIBRARIES:
            yield source_digest(value.__name__)
            yield from (_value(getattr(value, name, None)) for name in function.__code__.co_names)


def _value(value: Any) -> str | bytes:
    """A value as far as it can be told from another: numbers, texts and arrays wholly, others by their kind."""
    if isinstance(value, np.ndarray):
        return value.tobytes()
    return repr(value) if isinstance(value, _SIMPLE) else type(value).__qualname__


# --- components ------------------------------------------------------------------------------------


def component_digest(component: type[Component]) -> str:
    """Digest of the sources of a component: its bases' and its state's packages, and all that its functions use."""
    classes = (*component.__mro__, *component.Parameters.__mro__, *getattr(component, "State", object).__mro__)
    modules = {base.__module__ for base in classes if base.__module__.split(".")[0] not in _LIBRARIES}
    defined = [getattr(component, name, None) for name in ("step", "start", "build", "load", "simulate")]
    functions = [getattr(function, "__func__", function) for function in defined]
    used = [function_digest(function) for function in functions if isinstance(function, FunctionType)]
    return digest([*sorted({source_digest(module) for module in modules}), *used])
