"""A room that somebody else has modelled, as an FMU for co-simulation, in a process of its own."""

from __future__ import annotations

from collections.abc import Callable

from waxstudy.plugin import Component, hookimpl
from waxstudy_fmu.room import FmuRoom


@hookimpl
def waxstudy_register(register: Callable[[type[Component]], None]) -> None:
    register(FmuRoom)
