"""A block's `step` as Python that needs the standard library alone: its source, its helpers' and its constants."""

from __future__ import annotations

import inspect
import math
import textwrap
from collections.abc import Iterator
from types import FunctionType, ModuleType
from typing import Any

from waxstudy.plugin import Block, Ring, delayed
from waxstudy.simulation.sources import global_names, with_helpers

SIMPLE = (bool, int, float, str, tuple, type(None))
BUILTINS = vars(__import__("builtins"))


class NotPortable(Exception):
    """A block cannot be written so; the message says why."""


def factory(block: type[Block], name: str) -> str:
    """Return a function `name()` that returns the block's `step`; raise `NotPortable`.

    What the step needs stands within it, so that blocks whose helpers have the same names stay apart.
    """
    step = block.step
    assert isinstance(step, FunctionType)
    functions = with_helpers(step)
    names = [function.__name__ for function in functions]
    if twice := sorted({each for each in names if names.count(each) > 1}):
        raise NotPortable(f"two functions that it calls are named {twice[0]}")
    constants: dict[str, str] = {}
    for function in functions:
        if function.__closure__ or function.__kwdefaults__:
            raise NotPortable(f"{function.__name__} takes values from a function around it")
        for key, value in _globals(function, names):
            if constants.setdefault(key, value) != value:
                raise NotPortable(f"two modules of it mean other things by {key}")
    parts = [*(f"{key} = {value}" for key, value in constants.items()), *map(_source, reversed(functions))]
    body = textwrap.indent("\n\n".join([*parts, f"return {step.__name__}"]), "    ")
    return f"def {name}():\n{body}\n"


def _globals(function: FunctionType, functions: list[str]) -> Iterator[tuple[str, str]]:
    """Yield the constants that a function takes from its module; raise `NotPortable` for what is none."""
    for name in global_names(function.__code__):
        value = function.__globals__.get(name, BUILTINS.get(name))
        is_known = name in functions or value is delayed or value is math or value is BUILTINS.get(name)
        if is_known and value is not None:
            continue
        if isinstance(value, ModuleType):
            raise NotPortable(f"it needs {value.__name__}, which is not of the standard library of EnergyPlus")
        if not isinstance(value, SIMPLE):
            raise NotPortable(f"it needs {name}, which is no plain number or text")
        yield name, written(value)


def written(value: Any) -> str:
    """A number as Python reads it back.

    >>> written(0.5), written(math.nan)
    ('0.5', "float('nan')")
    """
    if isinstance(value, float) and not math.isfinite(value):
        return f"float('{value}')"
    return repr(value)


def ring() -> str:
    """Return the source of the delay ring."""
    return f"{inspect.getsource(Ring)}\n\n{inspect.getsource(delayed)}"


def _source(function: FunctionType) -> str:
    try:
        text = textwrap.dedent(inspect.getsource(function))
    except (OSError, TypeError) as error:
        raise NotPortable(f"the source of {function.__name__} cannot be found") from error
    return text[text.index("def ") :].rstrip()
