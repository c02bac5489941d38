"""What numba's types say about a block: mistakes that compile and then give other results than Python."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
from numba import from_dtype, types
from numba.core import ir

from waxstudy.plugin import Block, Ring
from waxstudy.plugin.registry import PluginError, hint
from waxstudy.simulation.records import EMPTY, RING

LONGEST_REASON = 200
_RING = from_dtype(RING)


class CannotCompile(Exception):
    """A block cannot be compiled, though it may run in Python; the message says why."""


def examine(block: type[Block], step: Any, parameters: np.dtype[Any], state: np.dtype[Any]) -> None:
    """Compile a step for its records and look at its types.

    Raises `CannotCompile` where Python may still run it, `PluginError` where Python would give another result: a
    number cut off by the type of its state field, a name that is no field, a path that returns nothing.
    """
    records = (from_dtype(parameters), from_dtype(state))
    try:
        step.compile((*records, types.float64, types.float64, types.float64))
    except KeyError as error:  # numba's word for a record without such a field
        field = str(error.args[0])
        if hasattr(block.State, field) or hasattr(Ring, field):  # a method, or a constant of the class
            raise CannotCompile(f"a compiled step has the fields of its state only, and no '{field}'") from error
        wrong = _no_field(field, *parameters.fields or (), *state.fields or ())
        raise PluginError(f"{block.kind} '{block.name}': {wrong} {_defined(step)}") from error
    except Exception as error:  # not all of numba's errors are `NumbaError`
        raise CannotCompile(reason(error, step.py_func.__code__.co_filename)) from error
    for wrong in (*_not_kept(step), *_without_return(step)):
        raise PluginError(f"{block.kind} '{block.name}': {wrong}")
    returned = next(iter(step.overloads.values())).signature.return_type
    if not isinstance(returned, types.Float | types.Integer | types.Boolean):
        raise CannotCompile(f"it returns {_spoken(returned)}, not a number")


def reason(error: BaseException, file: str = "") -> str:
    """Return numba's first sentence, without the pipeline around it, and the line of the block's file."""
    lines = [line.strip() for line in str(error).splitlines()]
    said = [line for line in lines if line and not line.startswith("Failed in ")] or [type(error).__name__]
    first = said[0]
    if first.endswith("for signature:") and len(said) > 1:
        first = f"{first.removesuffix(' found for signature:')} {said[1].removeprefix('>>> ')}"
    first = re.sub(r" ?Raised from .*|, defined at .*", "", first).rstrip(". ")
    first = re.sub(r"Module\(<module '(\S+)'[^>]*>\)", r"module \1", first)
    place = re.search(rf'{re.escape(Path(file).name)}"?(?:, line | \()(\d+)', str(error)) if file else None
    return first[:LONGEST_REASON] + (f" (line {place[1]})" if place else "")


def _no_field(field: str, *names: str) -> str:
    known = [name for name in names if name != EMPTY]
    what = hint(field, known) or " (a step gets numbers and choices only)"
    return f"its state and parameters have no field '{field}'{what}"


def _dispatchers(step: Any, seen: set[int] | None = None) -> Iterator[Any]:
    """A compiled step and the compiled helpers below it, each once."""
    seen = set() if seen is None else seen
    if id(step) in seen:
        return
    seen.add(id(step))
    yield step
    function: FunctionType = step.py_func
    for name in function.__code__.co_names:
        helper = function.__globals__.get(name)
        if hasattr(helper, "overloads"):
            yield from _dispatchers(helper, seen)


def _not_kept(step: Any) -> Iterator[str]:
    """Say where a state field is given what it does not hold whole, or a ring is written to."""
    for dispatcher in _dispatchers(step):
        for overload in dispatcher.overloads.values():
            known = overload.type_annotation.typemap
            for place in _assignments(overload.type_annotation.blocks.values()):
                record, value = known[place.target.name], known[place.value.name]
                where = f"({Path(place.loc.filename).name}, line {place.loc.line})"
                if not isinstance(record, types.Record):
                    continue
                if record == _RING or record.typeof(place.attr) == _RING:
                    yield f"its step writes to a ring itself {where}: only `delayed` may"
                elif not _holds(field := record.typeof(place.attr), value):
                    given = f"is declared {_spoken(field)} and is given {_spoken(value)}"
                    yield f"its state field '{place.attr}' {given} {where}: compiled, it would be another value"


def _holds(field: Any, value: Any) -> bool:
    """Whether a state field keeps a value whole: a bool takes a bool, an int an int or a bool, a float any number."""
    if isinstance(field, types.Boolean):
        return isinstance(value, types.Boolean)
    numbers = types.Integer | types.Boolean
    return isinstance(value, numbers if isinstance(field, types.Integer) else numbers | types.Float)


def _assignments(blocks: Any) -> Iterator[ir.SetAttr]:
    for block in blocks:
        yield from block.find_insts(ir.SetAttr)


def _spoken(numba_type: Any) -> str:
    words = {
        types.Boolean: "bool",
        types.Integer: "int",
        types.Float: "a float",
        types.Array: "an array",
        types.BaseTuple: "a tuple",
        types.UnicodeType: "a text",
        types.StringLiteral: "a text",
    }
    return next((word for kind, word in words.items() if isinstance(numba_type, kind)), str(numba_type))


def _without_return(step: Any) -> Iterator[str]:
    for overload in step.overloads.values():
        if isinstance(overload.signature.return_type, types.Optional):
            yield f"a path through its step returns nothing {_defined(step)}; every path needs `return` with a number"


def _defined(step: Any) -> str:
    code = step.py_func.__code__
    return f"({Path(code.co_filename).name}, line {code.co_firstlineno})"
