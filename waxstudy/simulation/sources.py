"""Digests of the sources that results and compiled code depend on."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from types import FunctionType

from waxstudy.plugin import Component, delayed


def _source_files(module_name: str) -> list[Path]:
    """The Python files of the top-level package (or the one file) that a module belongs to."""
    top = sys.modules[module_name.split(".")[0]]
    folders = getattr(top, "__path__", None)
    if folders:
        return sorted(file for folder in folders for file in Path(folder).rglob("*.py"))
    return [Path(file)] if (file := getattr(top, "__file__", None)) else []


def digest(parts: Iterable[str | bytes | Path]) -> str:
    """Return a short digest of texts and file contents."""
    total = hashlib.sha256()
    for part in parts:
        data = part.read_bytes() if isinstance(part, Path) else part
        total.update(data if isinstance(data, bytes) else data.encode())
        total.update(b"\0")
    return total.hexdigest()[:16]


@cache
def source_digest(module_name: str) -> str:
    """Digest of the sources that a module's results depend on: its package, or for the core what simulates."""
    files = _source_files(module_name)
    if module_name.split(".")[0] == "waxstudy":
        files = [file for file in files if file.parent.name in ("plugin", "simulation", "results")]
    return digest(files)


def helpers(function: FunctionType) -> dict[str, FunctionType]:
    """The plain functions that a function calls by name."""
    found = {name: function.__globals__.get(name) for name in function.__code__.co_names}
    known = (delayed, function)
    return {name: f for name, f in found.items() if isinstance(f, FunctionType) and f not in known}


def _modules(function: FunctionType) -> set[str]:
    """The modules of a function and of all helpers below it."""
    return {function.__module__}.union(*(_modules(helper) for helper in helpers(function).values()))


def component_digest(component: type[Component]) -> str:
    """Digest of the sources of a component: its bases' packages, and those of every function its step calls."""
    modules = {base.__module__ for base in component.__mro__ if base is not object}
    step = getattr(component, "step", None)
    modules |= _modules(step) if isinstance(step, FunctionType) else set()
    return digest(sorted({source_digest(module) for module in modules}))
