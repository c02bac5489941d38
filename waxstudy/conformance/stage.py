"""A stage of the kit, and what it is given to look at."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from waxstudy.plugin import Component, Parameters

Problems = Iterator[str]  # each: what is wrong, where, and what to do


@dataclass
class Subject:
    """A component under check. `models` holds its examples once they are known to be valid."""

    component: type[Component]
    examples: Mapping[str, Mapping[str, Any]]
    models: dict[str, Parameters] = field(default_factory=dict)


@dataclass(frozen=True)
class Stage:
    """One claim about a component; `problems` yields what speaks against it."""

    name: str
    claim: str
    problems: Callable[[Subject], Problems]
    needed: bool = False  # the stages after it make no sense without it
    exemptible: bool = False
