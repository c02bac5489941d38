"""Rooms in EnergyPlus: a second engine for the same chains, driven minute by minute through its C API."""

from __future__ import annotations

from collections.abc import Callable

from waxstudy.plugin import Component, hookimpl
from waxstudy_energyplus.rooms import NzebEnergyPlus, SurfacesEnergyPlus
from waxstudy_energyplus.users.room import EnergyPlusModelRoom


@hookimpl
def waxstudy_register(register: Callable[[type[Component]], None]) -> None:
    register(NzebEnergyPlus)
    register(SurfacesEnergyPlus)
    register(EnergyPlusModelRoom)
