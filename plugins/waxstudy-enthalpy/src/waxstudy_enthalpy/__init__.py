"""A physical wax actuator for waxstudy: the actuator `enthalpy`."""

from __future__ import annotations

from collections.abc import Callable

from waxstudy.plugin import Component, hookimpl
from waxstudy_enthalpy.motor import Enthalpy

__all__ = ["Enthalpy", "waxstudy_register"]


@hookimpl
def waxstudy_register(register: Callable[[type[Component]], None]) -> None:
    register(Enthalpy)
