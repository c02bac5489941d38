"""Blocks that run in Python: what they do wrong becomes a `SimulationError` that names block, time and place."""

from __future__ import annotations

import ctypes
import dataclasses
import traceback
from collections.abc import Callable
from types import FunctionType
from typing import Any

import numpy as np

from waxstudy.plugin import Block, Port, SimulationError
from waxstudy.plugin.registry import described
from waxstudy.simulation.records import state_problem

NUMBERS = (float, int, np.floating, np.integer, np.bool_)
MOST_FRAMES = 2  # at either end of a long traceback
Step = Callable[[Any, Any, float, float, float], float]
_NUMBER, _OBJECT = ctypes.c_double, ctypes.py_object
_CALLBACK = ctypes.CFUNCTYPE(_NUMBER, _OBJECT, _OBJECT, _NUMBER, _NUMBER, _NUMBER)


class CompiledFailure(SimulationError):
    """A block failed as machine code, which cannot tell why: Python, asked next, is to say."""

    def __init__(self, block: str, when: str) -> None:
        super().__init__(block, when)
        self.block, self.when = block, when

    def __str__(self) -> str:
        name = self.block.split("'")[1]
        return (
            f"{self.block} failed at {self.when}, but only when compiled: check it with "
            f"`waxstudy plugins check {name}`, or run with --no-jit"
        )


def checked(block: type[Block], watch: bool = False) -> Step:
    """Return a block's step that raises `SimulationError` for anything but a number in the declared range.

    With `watch`, also for a state that is not as declared: that takes longer than the step itself.
    """
    own, low, high = block.step, block.output.low, block.output.high

    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        try:
            value = own(p, x, u, t, dt)
        except (Exception, SystemExit) as error:
            frames = traceback.extract_tb(error.__traceback__)[1:]
            raise _failed(block, x, u, t, f"{type(error).__name__}: {error}", frames) from error
        if not (isinstance(value, NUMBERS) and low <= value <= high):  # false for NaN too
            raise _failed(block, x, u, t, _wrong(value, block.output), _definition(block))
        if watch and (wrong := state_problem(x)):
            raise _failed(block, x, u, t, wrong, _definition(block))
        return float(value) + 0.0  # as the compiled guard: no negative zero

    return step


class Callback:
    """A block's step as a C function for the compiled loop, which is given Python objects by their address.

    What the step raises cannot pass through the loop: it is kept in `error`, and the loop is given NaN.
    """

    def __init__(self, block: type[Block]) -> None:
        self.error: SimulationError | None = None
        step = checked(block)

        def call(p: Any, x: Any, u: float, t: float, dt: float) -> float:
            try:
                return step(p, x, u, t, dt)
            except SimulationError as error:
                self.error = error
            except BaseException as error:
                self.error = SimulationError(f"{block.kind} '{block.name}' failed at {clock(t)}: {described(error)}")
            return float("nan")

        self._function = _CALLBACK(call)  # kept: C code holds no reference to it

    @property
    def address(self) -> int:
        return ctypes.cast(self._function, ctypes.c_void_p).value or 0


def _wrong(value: Any, port: Port) -> str:
    """Say what is wrong with a block's output."""
    if not isinstance(value, NUMBERS):
        text = "None (a path without `return`?)" if value is None else f"{type(value).__name__} {_shown(value)}"
        return f"it returned {text}, not a number"
    unit = "" if port.unit == "1" else f" {port.unit}"
    return f"it returned {float(value):g}, not a {port.quantity} from {port.low:g} to {port.high:g}{unit}"


def _failed(block: type[Block], x: Any, u: float, t: float, wrong: str, frames: Any) -> SimulationError:
    frames = list(frames)
    if len(frames) > 2 * MOST_FRAMES:
        frames = [*frames[:MOST_FRAMES], *frames[-MOST_FRAMES:]]
    text = "".join(traceback.format_list(frames))
    lines = [line for line in text.splitlines() if line.strip(" ~^")]  # without Python's underlining
    state = ", ".join(f"{name} = {value!r}" for name, value in _fields(x).items())
    if state:
        lines.append(f"  state then: {state}")
    return SimulationError(
        "\n".join([f"{block.kind} '{block.name}' failed at {clock(t)} with input {u:g}: {wrong}", *lines])
    )


def _shown(value: object) -> str:
    """A value in at most 60 characters of one line, whatever its class does when it is asked."""
    try:
        return " ".join(repr(value).split())[:60]
    except Exception:
        return "that cannot be shown"


def _fields(x: Any) -> dict[str, Any]:
    if not dataclasses.is_dataclass(x):
        return {}
    values = {field.name: getattr(x, field.name, None) for field in dataclasses.fields(x)}
    return {name: value for name, value in values.items() if isinstance(value, int | float)}


def _definition(block: type[Block]) -> list[traceback.FrameSummary]:
    """Where a step is defined, for what went wrong without an exception."""
    step = block.step
    if not isinstance(step, FunctionType):
        return []
    code = step.__code__
    return [traceback.FrameSummary(code.co_filename, code.co_firstlineno, code.co_name, line="")]


def clock(t: float) -> str:
    """A time of the run in words.

    >>> clock(93605.0), clock(-5.0)
    ('day 2, 02:00:05', '5 s before the week (warm-up)')
    """
    if t < 0:
        return f"{-t:g} s before the week (warm-up)"
    day, rest = divmod(t, 86400.0)
    hours, rest = divmod(rest, 3600.0)
    return f"day {day + 1:.0f}, {hours:02.0f}:{rest // 60:02.0f}:{rest % 60:02.0f}"
