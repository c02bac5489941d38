"""What a class must have to be registered at all; the conformance kit asks for more."""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator, Mapping
from types import FunctionType
from typing import Any

from waxstudy.plugin.contracts import API_VERSION, CHAIN, KINDS, Block, Component, Port, Reference, Room, Weather
from waxstudy.plugin.effect import Effect
from waxstudy.plugin.parameters import Parameters

NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")
NAME_RULE = "lower-case letters and digits, words joined by '-', a letter first"
STEP = ("p", "x", "u", "t", "dt")
# what a component of a kind must define itself: (base, function, arguments)
PROVIDED: dict[str, tuple[type[Component], str, int]] = {
    **{kind: (Block, "step", len(STEP)) for kind in CHAIN},
    "room": (Room, "build", 1),
    "weather": (Weather, "load", 2),
    "effect": (Effect, "apply", 2),
    "reference": (Reference, "rows", 0),
}


def structure_problems(component: Any) -> Iterator[str]:
    """Yield what keeps an object from being a component, each with what to do."""
    if not (isinstance(component, type) and issubclass(component, Component)):
        yield f"{component!r:.60} is no component: register classes derived from Actuator, Valve, Room and so on"
        return
    name, kind = getattr(component, "name", None), getattr(component, "kind", None)
    if not (isinstance(name, str) and NAME.fullmatch(name)):
        yield f"{component.__name__}: its name is {name!r}: give `name` a text of {NAME_RULE}"
    major = API_VERSION.split(".")[0]
    if str(component.api_version).split(".")[0] != major:
        yield f"{component.__name__}: made for plugin API {component.api_version}, this is {API_VERSION}"
    model: Any = component.Parameters
    if not (isinstance(model, type) and issubclass(model, Parameters)):
        yield f"{component.__name__}: its Parameters must be a class derived from waxstudy.plugin.Parameters"
    for table in ("examples", "exemptions", *(["tuned"] if issubclass(component, Block) else [])):
        if not isinstance(getattr(component, table), Mapping):
            yield f'{component.__name__}: its {table} must be a table, written {{"name": ...}}'
    doc: Any = component.__doc__
    if not isinstance(doc, str | None):
        yield f"{component.__name__}: its docstring is no text"
    if kind not in KINDS:
        yield f"{component.__name__}: unknown kind {kind!r}; kinds are {', '.join(KINDS)}"
    else:
        yield from _provided(component, kind)


def _provided(component: type[Component], kind: str) -> Iterator[str]:
    base, function, arguments = PROVIDED[kind]
    if not issubclass(component, base):
        yield f"{component.__name__}: a {kind} is derived from {base.__name__} or one of its kinds"
        return
    if _own(component, function) in (None, _own(base, function)):
        yield f"{component.__name__}: a {kind} must define `{function}`"
        return
    defined = getattr(component, function)
    if function == "step" and not isinstance(defined, FunctionType):
        yield f"{component.__name__}: its `step` must be a plain function, marked @staticmethod and nothing else"
        return
    try:
        inspect.signature(defined).bind(*range(arguments))
    except (TypeError, ValueError):
        wanted = f"({', '.join(STEP)})" if function == "step" else f"of {arguments} arguments besides the class"
        yield f"{component.__name__}: its `{function}` must take {wanted}: {function}{inspect.signature(defined)}"


def port_problems(block: type[Block]) -> Iterator[str]:
    """Yield what is wrong with a block's input and output: the loop relies on those of its kind."""
    for side in ("input", "output"):
        port: Any = getattr(block, side)
        whole = next(getattr(base, side) for base in block.__mro__ if base.__module__ == Block.__module__)
        allowed = f"{whole.low:g} to {whole.high:g} [{whole.unit}]"
        if not isinstance(port, Port):
            asked = f"a {block.kind}'s lies within {allowed}"
            yield f"its {side} is {port!r:.60}, not a Port(quantity, unit, low, high); {asked}"
        elif port.unit != whole.unit or not whole.low <= port.low < port.high <= whole.high:
            yield f"its {side} is {port.low:g} to {port.high:g} [{port.unit}]; a {block.kind}'s lies within {allowed}"


def _own(component: type[Component], name: str) -> object:
    """The class attribute as it is written, without binding it to the class."""
    return inspect.getattr_static(component, name, None)
