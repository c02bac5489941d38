"""Put an effect around any block, a stranger's too: one more parameter, and a step that calls the believed one.

The step of a wrapper is a plain function that calls `believed(p, x, u, t, dt)`. Made for a block, that name is the
block's own step, so that the whole runs compiled or in Python like any other block.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import fields, make_dataclass
from functools import cache
from types import FunctionType
from typing import Any

from pydantic import create_model

from waxstudy.plugin import Block, Choice, Effect, NoState

Step = Callable[[Any, Any, float, float, float], float]
Start = Callable[[Any, float, Any], Any]
Combine = Callable[[float, float], float]


def believed(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Stands for the step of the block that is wrapped."""
    raise NotImplementedError


def started(p: Any, dt: float, block: Any) -> Any:
    """The state that the block itself starts with."""
    return block.start(p, dt)


def wrapped(
    choice: Choice,
    effect: type[Effect],
    p: Any,
    step: Step,
    start: Start = started,
    memory: type = NoState,
    both: Combine | None = None,
) -> Choice:
    """Return a block with an effect around it; where it has it already, with `both(before, more)` of each parameter.

    The step reads the effect's parameters as `p.let_by_fraction`, for `fraction` of the effect `let-by`. What it
    remembers are the fields of the dataclass `memory`, beside those of the block's own state; each has a default.
    """
    component = choice.component
    assert issubclass(component, Block)
    make: Callable[..., type[Block]] = _wrapper  # a cached function takes hashable arguments, which classes are
    own = {parameter_name(effect, name): value for name, value in dict(p).items()}
    if both and is_wrapped(choice, effect):
        return choice.changed(**{name: both(getattr(choice.parameters, name), value) for name, value in own.items()})
    return Choice.of(make(component, effect, step, start, memory), {**dict(choice.parameters), **own})


def parameter_name(effect: type[Effect], name: str) -> str:
    """Return what an effect's parameter is called in a block that it is wrapped around."""
    return f"{effect.name.replace('-', '_')}_{name}"


def is_wrapped(choice: Choice, effect: type[Effect]) -> bool:
    """Whether a block has this effect around it already."""
    first = parameter_name(effect, next(iter(effect.Parameters.model_fields)))
    return first in type(choice.parameters).model_fields


@cache
def _wrapper(block: type[Block], effect: type[Effect], step: Step, start: Start, memory: type) -> type[Block]:
    """Make the block's class: its own parameters and state, and the effect's besides."""
    assert isinstance(step, FunctionType)
    own: dict[str, Any] = {
        parameter_name(effect, name): (field.annotation, field)
        for name, field in effect.Parameters.model_fields.items()
    }
    name = f"{block.__name__}With{effect.__name__}"
    of_kind = next(base for base in block.__mro__ if base.__module__ == Block.__module__)
    inside = {**step.__globals__, believed.__name__: block.step}
    outer = FunctionType(step.__code__, inside, step.__name__, step.__defaults__, step.__closure__)
    state: Any = _state(name, block, memory)
    members = {
        "__module__": step.__module__,
        "__doc__": block.__doc__,
        "name": f"{block.name} with {effect.name}",
        "Parameters": create_model(f"{name}Parameters", __base__=block.Parameters, __module__=step.__module__, **own),
        "State": state,
        "output": getattr(of_kind, "output"),  # noqa: B009  what the effect does may exceed the block's own range
        "start": classmethod(lambda cls, p, dt: _filled(state, start(p, dt, block))),
        "step": staticmethod(outer),
    }
    made = type(name, (block,), members)
    assert issubclass(made, Block)
    return made


def _state(name: str, block: type[Block], memory: type) -> type:
    """Return the state class of both: with a module of its own it can be pickled."""
    if not fields(memory):
        return block.State
    made = make_dataclass(f"{name}State", [], bases=(memory, block.State), namespace={"__module__": __name__})
    setattr(sys.modules[__name__], made.__name__, made)
    return made


def _filled(state: Any, begun: Any) -> Any:
    """Return a state with the values of the block's own."""
    return (
        begun if type(begun) is state else state(**{field.name: getattr(begun, field.name) for field in fields(begun)})
    )
