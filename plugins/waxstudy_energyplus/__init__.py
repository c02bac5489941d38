"""Rooms in EnergyPlus: a second engine for the same chains, driven step by step through its C API.

The rooms are imported when they are asked for: a run's process, which belongs to this package too, needs none of them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from pluggy import HookimplMarker

if TYPE_CHECKING:
    from waxstudy.plugin import Component

hookimpl = HookimplMarker("waxstudy")  # that of `waxstudy.plugin`, which takes half a second to import


@hookimpl
def waxstudy_register(register: Callable[[type[Component]], None]) -> None:
    from waxstudy_energyplus.rooms import NzebEnergyPlus, SurfacesEnergyPlus
    from waxstudy_energyplus.users.room import EnergyPlusModelRoom

    register(NzebEnergyPlus)
    register(SurfacesEnergyPlus)
    register(EnergyPlusModelRoom)
