"""Parameters and state of a block in memory: one record each for compiled code, plain objects for the interpreter."""

from __future__ import annotations

import dataclasses
import typing
from collections import namedtuple
from functools import cache
from typing import Any, Literal, get_args, get_origin

import numpy as np

from waxstudy.plugin import Parameters, Ring
from waxstudy.plugin.registry import hint

EMPTY = "none"  # field of a record that would have none
RING = np.dtype([("offset", "i8"), ("length", "i8"), ("head", "i8")])
_SCALARS = {float: "f8", int: "i8", bool: "?"}
# what a field of a type may hold in Python
_STORED = {float: (float, int, np.floating, np.integer), int: (int, np.integer), bool: (bool, np.bool_), Ring: (Ring,)}


def choices_of(annotation: Any) -> tuple[Any, ...]:
    """The choices of a `Literal` field, optional or not; empty for other fields."""
    if get_origin(annotation) is Literal:
        return get_args(annotation)
    return next((c for c in map(choices_of, get_args(annotation)) if c), ())


def plain_parameters(parameters: Parameters) -> Any:
    """Return the numbers of a parameter model as a namedtuple.

    Choices become their index (-1 for none), a number that is not given becomes NaN, texts are left out.
    """
    values: dict[str, float | int | bool] = {}
    for name, field in type(parameters).model_fields.items():
        value = getattr(parameters, name)
        choices = choices_of(field.annotation)
        if choices:
            values[name] = choices.index(value) if value in choices else -1
        elif isinstance(value, bool | int | float):
            # an optional number is always a float, so that one compilation serves it given or not
            values[name] = float(value) if None.__class__ in get_args(field.annotation) else value
        elif value is None and {float, int}.intersection(get_args(field.annotation)):
            values[name] = float("nan")
    return _numbers(*values)(**values) if values else ()


@cache
def _numbers(*names: str) -> Any:
    """Return the one type that holds these numbers: making it takes longer than a block's start."""
    return namedtuple("p", names)


def parameter_record(plain: Any) -> np.ndarray:
    """Return the namedtuple of `plain_parameters` as a one-element record array."""
    return np.array([tuple(plain) or (0,)], dtype=parameter_dtype(plain))


def parameter_dtype(plain: Any) -> np.dtype[Any]:
    """Return the layout of a parameter record."""
    return _layout(getattr(plain, "_fields", ()), tuple(map(type, plain)))


@cache
def _layout(names: tuple[str, ...], kinds: tuple[type, ...]) -> np.dtype[Any]:
    """Return one layout for all parameters of these names and types: making it takes longer than the record."""
    fields: list[tuple[str, Any]] = [(name, _SCALARS[kind]) for name, kind in zip(names, kinds, strict=True)]
    return np.dtype(fields or [(EMPTY, "i8")], align=True)


@cache
def _hints(state: type) -> dict[str, Any]:
    return typing.get_type_hints(state)


@cache
def state_dtype(state: type) -> np.dtype[Any]:
    """Return the record layout of a state dataclass of float, int, bool and Ring fields.

    Raises `TypeError` naming a field of another type, or a class that is no dataclass.
    """
    if not dataclasses.is_dataclass(state):
        raise TypeError(f"its State, {state.__name__}, is no dataclass: mark it @dataclass")
    if state.__dataclass_params__.frozen:  # type: ignore[attr-defined]
        raise TypeError(
            f"its State, {state.__name__}, is frozen: a step changes its state, so mark it plain @dataclass"
        )
    hints = _hints(state)
    fields: list[tuple[str, Any]] = []
    for field in dataclasses.fields(state):
        kind = hints[field.name]
        if kind is not Ring and kind not in _SCALARS:
            raise TypeError(f"state field {state.__name__}.{field.name}: must be float, int, bool or Ring, not {kind}")
        fields.append((field.name, RING if kind is Ring else _SCALARS[kind]))
    return np.dtype(fields or [(EMPTY, "i8")], align=True)


def state_record(state: Any) -> np.ndarray:
    """Return a state object as bytes: its record, then the samples of its rings."""
    dtype = state_dtype(type(state))  # type: ignore[arg-type]  # a class is hashable
    size = -(-dtype.itemsize // 8) * 8
    rings = [name for name in dtype.names or () if dtype[name] == RING]
    total = size + 8 * sum(getattr(state, name).length for name in rings)
    memory = np.zeros(total, dtype=np.uint8)
    record = memory[: dtype.itemsize].view(dtype)[0]
    place = size
    for field in dataclasses.fields(state):
        value = getattr(state, field.name)
        if field.name in rings:
            assert dtype.fields is not None
            record[field.name] = (place - dtype.fields[field.name][1], value.length, value.head)
            memory[place : place + 8 * value.length].view("f8")[:] = value.values
            place += 8 * value.length
        else:
            record[field.name] = value
    return memory


def state_problem(state: Any) -> str:
    """Say what makes a state object differ from what its class declares, or "": compiled code keeps to that.

    >>> from dataclasses import make_dataclass
    >>> state = make_dataclass("Wax", [("opening", float, 0.0), ("cycles", int, 0)])()
    >>> state.openning = 1.0
    >>> state_problem(state)
    "its step sets 'openning', which its State does not declare; did you mean 'opening'?"
    """
    hints = _hints(type(state))  # type: ignore[arg-type]  # a class is hashable
    for name in getattr(state, "__dict__", {}):
        if name not in hints:
            return f"its step sets '{name}', which its State does not declare{hint(name, hints)}"
    for field in dataclasses.fields(state):
        kind, value = hints[field.name], getattr(state, field.name)
        if not isinstance(value, _STORED[kind]):
            return f"its state field '{field.name}' is declared {kind.__name__} and holds {value!r}"
    return ""
