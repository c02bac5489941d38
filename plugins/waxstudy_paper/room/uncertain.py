"""What nobody knows of a room exactly, with its spread: edits of the description, each a smooth function of one number.

The spreads are chosen. They are wide where physics is uncertain: EN ISO 6946 states films for differences of some
kelvins, and at a few tenths natural convection (TARP: 1.31 dT^(1/3) on walls) gives a fifth to a half of them. They are
narrow where a builder knows: areas, insulation, the mass of the floor.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import exp
from typing import TYPE_CHECKING

import numpy as np

from waxstudy.plugin import Choice, Room, Uncertainty, changed
from waxstudy_paper.room.construction import HEAVIEST_KG_M3, THICKEST_M, Layer, Surface
from waxstudy_paper.room.hydronics import exchange_W_m2K, full_flow_L_h

if TYPE_CHECKING:
    from waxstudy_paper.room.description import RoomDescription

UPWARDS = 0.2  # of what goes downwards: a film stronger than the standard's is hardly to be had
MOST_MOVED = 0.99  # of the resistance below the pipes
LEAST_M2K_W = 1e-6  # of a layer; less is none

Edit = Callable[["RoomDescription", float], "RoomDescription"]


@dataclass(frozen=True)
class Unknown:
    """One of them, of a description."""

    name: str
    description: str
    sd: float
    edit: Edit
    is_log: bool = True


def uncertainties(describe: Callable[[Choice], RoomDescription], room: type[Room]) -> Sequence[Uncertainty]:
    """Return what is uncertain of rooms that can be described; an edit makes a `room` of the edited description."""
    return [
        Uncertainty(u.name, u.description, u.sd, partial(_applied, describe, room, u.edit), u.is_log) for u in UNKNOWNS
    ]


def _applied(
    describe: Callable[[Choice], RoomDescription], room: type[Room], edit: Edit, believed: Choice, departure: float
) -> Choice:
    return believed if departure == 0.0 else Choice(room, edit(describe(believed), departure))


# --- numbers ---------------------------------------------------------------------------------------


def mostly_down(departure: float) -> float:
    """Return a factor that falls far and rises little."""
    return exp(departure if departure < 0.0 else UPWARDS * departure)


def moved_share(share: float, departure: float) -> float:
    """Return a share moved by a departure, with slope 1 at 0 and always from 0 to 1.

    >>> moved_share(0.5, 0.0), moved_share(0.5, 9.0) <= 1.0, moved_share(0.0, -9.0)
    (0.5, True, 0.0)
    """
    if departure >= 0.0:
        room = 1.0 - share
        return share + room * (1.0 - exp(-departure / room)) if room > 0.0 else share
    return share * exp(departure / share) if share > 0.0 else share


# --- edits -----------------------------------------------------------------------------------------


def _film_floor(room: RoomDescription, departure: float) -> RoomDescription:
    films = changed(room.films, floor_W_m2K=min(50.0, room.films.floor_W_m2K * mostly_down(departure)))
    return changed(room, films=films)


def _film_walls(room: RoomDescription, departure: float) -> RoomDescription:
    factor, films = mostly_down(departure), room.films
    wall, ceiling = (min(50.0, factor * film) for film in (films.wall_W_m2K, films.ceiling_W_m2K))
    return changed(room, films=changed(films, wall_W_m2K=wall, ceiling_W_m2K=ceiling))


def _air_capacity(room: RoomDescription, departure: float) -> RoomDescription:
    multiplier = min(50.0, max(1.0, room.air.capacity_multiplier * exp(departure)))
    return changed(room, air=changed(room.air, capacity_multiplier=multiplier))


def _heavier(surface: Surface, factor: float) -> Surface:
    layers = [
        changed(layer, density_kg_m3=min(HEAVIEST_KG_M3, factor * layer.density_kg_m3)) for layer in surface.layers
    ]
    return changed(surface, layers=tuple(layers))


def _floor_capacity(room: RoomDescription, departure: float) -> RoomDescription:
    floor = room.floor
    return changed(room, surfaces=tuple(_heavier(s, exp(departure)) if s is floor else s for s in room.surfaces))


def _boards_capacity(room: RoomDescription, departure: float) -> RoomDescription:
    floor = room.floor
    return changed(room, surfaces=tuple(s if s is floor else _heavier(s, exp(departure)) for s in room.surfaces))


def _heat_loss(room: RoomDescription, departure: float) -> RoomDescription:
    """Scale all ways out: the best insulating layer of a surface takes what its U-value asks for."""
    factor, air = exp(departure), room.air
    flows = {name: factor * getattr(air, name) for name in ("ventilation_L_s", "infiltration_L_s")}
    return changed(
        room,
        surfaces=tuple(_leakier(room, surface, factor) for surface in room.surfaces),
        windows=tuple(changed(window, U_W_m2K=min(5.0, factor * window.U_W_m2K)) for window in room.windows),
        air=changed(air, thermal_bridges_W_K=factor * air.thermal_bridges_W_K, **flows),
    )


def _leakier(room: RoomDescription, surface: Surface, factor: float) -> Surface:
    if surface.boundary == "adiabatic":
        return surface
    films = room.films.interior_m2K_W(surface.facing) + 1.0 / room.films.exterior_W_m2K
    whole = films + sum(layer.resistance_m2K_W for layer in surface.layers)
    best = max(surface.layers, key=lambda layer: layer.resistance_m2K_W)
    wanted = max(0.05 * best.resistance_m2K_W, best.resistance_m2K_W + whole / factor - whole)
    scaled = changed(best, thickness_m=min(THICKEST_M, wanted * best.conductivity_W_mK))
    return changed(surface, layers=tuple(scaled if layer is best else layer for layer in surface.layers))


def _sun_on_floor(room: RoomDescription, departure: float) -> RoomDescription:
    return changed(room, sun=changed(room.sun, floor_share=moved_share(room.sun.floor_share, departure)))


def _sun_to_air(room: RoomDescription, departure: float) -> RoomDescription:
    return changed(room, sun=changed(room.sun, air_share=moved_share(room.sun.air_share, departure)))


def _operative(room: RoomDescription, departure: float) -> RoomDescription:
    share = moved_share(room.sensing.operative_air_share, departure)
    return changed(room, sensing=changed(room.sensing, operative_air_share=share))


def _exchange(room: RoomDescription, departure: float) -> RoomDescription:
    factor = min(100.0, max(0.01, room.circuit.exchange_factor * exp(departure)))
    return changed(room, circuit=changed(room.circuit, exchange_factor=factor))


def _above_pipes(room: RoomDescription, departure: float) -> RoomDescription:
    """Move resistance from between water and the plane of the pipes to above that plane; the sum stays.

    Below 0 the layers above the pipes give some of theirs to the water's side.
    """
    water = water_m2K_W(room)
    if departure < 0.0:
        kept = 1.0 / (1.0 - departure)
        moved_m2K_W = -(1.0 - kept) * room.above_m2K_W
        surface, pipes = _thinner_above(room, kept), room.heated_floor
    else:
        thickest_m2K_W = THICKEST_M / room.beside_pipes[0].conductivity_W_mK
        moved_m2K_W = min(thickest_m2K_W, water * min(MOST_MOVED, 1.0 - exp(-departure)))
        if moved_m2K_W < LEAST_M2K_W:
            return room
        surface = _layer_above(room, moved_m2K_W)
        pipes = changed(room.heated_floor, pipes_after_layer=room.heated_floor.pipes_after_layer + 1)
    factor = room.circuit.exchange_factor * water / (water - moved_m2K_W)
    floor, design_m2K_W = room.floor, room.design_cover_m2K_W
    return changed(
        room,
        surfaces=tuple(surface if s is floor else s for s in room.surfaces),
        heated_floor=pipes,
        circuit=changed(room.circuit, design_cover_m2K_W=design_m2K_W, exchange_factor=min(100.0, max(0.01, factor))),
    )


def _layer_above(room: RoomDescription, resistance_m2K_W: float) -> Surface:
    """Return the floor with a layer without mass just above the pipes."""
    floor, after = room.floor, room.heated_floor.pipes_after_layer
    above = floor.layers[after - 1]
    own = Layer(
        thickness_m=resistance_m2K_W * above.conductivity_W_mK,
        conductivity_W_mK=above.conductivity_W_mK,
        density_kg_m3=0.0,
        heat_capacity_J_kgK=above.heat_capacity_J_kgK,
    )
    return changed(floor, layers=(*floor.layers[:after], own, *floor.layers[after:]))


def _thinner_above(room: RoomDescription, kept: float) -> Surface:
    """Return the floor with less resistance above the pipes, and as much mass."""
    floor, after = room.floor, room.heated_floor.pipes_after_layer
    thinner = [
        changed(
            layer,
            thickness_m=kept * layer.thickness_m,
            density_kg_m3=min(HEAVIEST_KG_M3, layer.density_kg_m3 / kept),
        )
        for layer in floor.layers[:after]
    ]
    return changed(floor, layers=(*thinner, *floor.layers[after:]))


def water_m2K_W(room: RoomDescription) -> float:
    """Return the resistance between water and the plane of the pipes at full flow."""
    flow_L_s = np.array([full_flow_L_h(room.circuit, room.floor.area_m2) / 3600.0])
    exchange = exchange_W_m2K(room.circuit, room.cover_m2K_W, room.screed_W_mK, flow_L_s)
    return 1.0 / float(exchange[0])


UNKNOWNS = (
    Unknown("film-floor", "factor on the floor's convective film", 0.7, _film_floor),
    Unknown("film-walls", "factor on the convective films of walls, windows and ceiling", 0.8, _film_walls),
    Unknown("air-capacity", "factor on the capacity of air and furniture", 0.2, _air_capacity),
    Unknown("floor-capacity", "factor on the mass of the heated floor", 0.1, _floor_capacity),
    Unknown("boards-capacity", "factor on the mass of all other surfaces", 0.2, _boards_capacity),
    Unknown("heat-loss", "factor on U-values, thermal bridges, ventilation and leaks", 0.07, _heat_loss),
    Unknown("sun-on-floor", "added to the share of the sun that falls on the floor", 0.15, _sun_on_floor, is_log=False),
    Unknown("sun-to-air", "added to the share of the sun that heats the air at once", 0.1, _sun_to_air, is_log=False),
    Unknown("operative-air", "added to the share of air in the operative temperature", 0.1, _operative, is_log=False),
    Unknown("water-exchange", "factor on the exchange between water and floor", 1.0, _exchange),
    Unknown(
        "above-pipes",
        "factor by which the resistance below the pipes' plane lies above it",
        0.8,
        _above_pipes,
    ),
)
