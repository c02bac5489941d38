"""The description of a room: all that its model is built from, and checked to be possible."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any, Self

import numpy as np
from pydantic import model_validator

from waxstudy.plugin import Facade, Parameters, parameter
from waxstudy_paper.room.conditions import Air, Films, Gains, Sensing, Shading, Sun
from waxstudy_paper.room.construction import STUDY, Layer, Part, Surface, Window
from waxstudy_paper.room.hydronics import Circuit, exchange_W_m2K, nominal_film_m2K_W


class HeatedFloor(Parameters):
    """The surface with the pipes and where in it they lie."""

    surface: str = parameter(unit="", description="name of the surface", source=STUDY)
    pipes_after_layer: int = parameter(
        unit="1", description="number of layers between the room and the plane of the pipes", source=STUDY, ge=1, le=100
    )


class RoomDescription(Parameters):
    """A room as surfaces, windows, air, gains and one heated floor."""

    surfaces: tuple[Surface, ...] = parameter(unit="", description="opaque surfaces", source=STUDY, strict=False)
    windows: tuple[Window, ...] = parameter((), unit="", description="windows", source=STUDY, strict=False)
    air: Air = parameter(unit="", description="air", source=STUDY)
    heated_floor: HeatedFloor = parameter(unit="", description="where the pipes lie", source=STUDY)
    circuit: Circuit = parameter(Circuit(), unit="", description="heating circuit", source="Table 3")
    films: Films = parameter(Films(), unit="", description="films", source="EN ISO 6946, EN 1264-2")
    gains: Gains = parameter(Gains(), unit="", description="internal gains", source="section 3.3")
    sun: Sun = parameter(Sun(), unit="", description="sun in the room", source="chosen")
    shading: Shading = parameter(Shading(), unit="", description="external shading of the windows", source="chosen")
    sensing: Sensing = parameter(Sensing(), unit="", description="operative point and sensor", source="chosen")
    ground_temperature_C: float | None = parameter(
        None, unit="C", description="behind surfaces on the ground", source=STUDY, ge=-40, le=60
    )
    ground_resistance_m2K_W: float = parameter(
        0.25,
        unit="m2 K/W",
        description="soil between the last layer and the ground temperature",
        source="ISO 52016-1: half a metre of soil at 2 W/(m K), here without its mass",
        gt=0,
        le=20,
    )
    cell_time_s: float = parameter(
        300.0,
        unit="s",
        description="time in which heat crosses one cell of a layer: cell = sqrt(diffusivity * time)",
        source="chosen: see docs/room-equations.md for the error",
        ge=10,
        le=86_400,
    )

    @model_validator(mode="after")
    def _possible(self) -> Self:
        problems = list(_problems(self)) or list(_design_problems(self))
        if problems:
            raise ValueError("; ".join(problems))
        return self

    @property
    def parts(self) -> tuple[Part, ...]:
        """Surfaces and windows."""
        return (*self.surfaces, *self.windows)

    @property
    def floor(self) -> Surface:
        """The surface with the pipes."""
        return next(surface for surface in self.surfaces if surface.name == self.heated_floor.surface)

    @property
    def cover_m2K_W(self) -> float:
        """From the plane of the pipes to the room at the nominal output: layers and the film of EN 1264-2."""
        return self.design_cover_m2K_W + nominal_film_m2K_W(self.circuit)

    @property
    def design_cover_m2K_W(self) -> float:
        """The layers above the pipes that the nominal output is stated for."""
        stated = self.circuit.design_cover_m2K_W
        return self.above_m2K_W if stated is None else stated

    @property
    def above_m2K_W(self) -> float:
        """The layers above the pipes."""
        return sum(layer.resistance_m2K_W for layer in self.floor.layers[: self.heated_floor.pipes_after_layer])

    @property
    def beside_pipes(self) -> tuple[Layer, Layer]:
        """The layers above and below the plane of the pipes."""
        after = self.heated_floor.pipes_after_layer
        return self.floor.layers[after - 1], self.floor.layers[after]

    @property
    def screed_W_mK(self) -> float:
        """Conductivity around the pipes."""
        above, below = self.beside_pipes
        return (above.conductivity_W_mK + below.conductivity_W_mK) / 2

    @property
    def facades(self) -> dict[str, Facade]:
        """One entry per direction from which the sun matters."""
        directions = [part.facade for part in self.parts]
        return {facade_name(facade): facade for facade in directions if facade is not None}


def facade_name(facade: Facade) -> str:
    behind = f" panes {facade.panes}" if facade.panes else ""
    return f"azimuth {facade.azimuth_deg:g} tilt {facade.tilt_deg:g}{behind}"


def _problems(room: RoomDescription) -> Iterator[str]:
    yield from (
        f"name '{name}' is used {n} times" for name, n in Counter(part.name for part in room.parts).items() if n > 1
    )
    yield from _floor_problems(room)
    if all(surface.facing == "floor" for surface in room.surfaces):
        yield "a room needs a wall or a ceiling besides its floor"
    weights = [part.operative_weight for part in room.parts]
    if any(w is None for w in weights) and any(w is not None for w in weights):
        yield "operative_weight: give it for every surface and window, or for none"
    if None not in weights and not any(weights):
        yield "operative_weight: not all of them can be 0"
    yield from _boundary_problems(room)


def _floor_problems(room: RoomDescription) -> Iterator[str]:
    wanted, after = room.heated_floor.surface, room.heated_floor.pipes_after_layer
    named = [surface for surface in room.surfaces if surface.name == wanted]
    if not named:
        names = ", ".join(surface.name for surface in room.surfaces)
        yield f"heated_floor: no surface '{wanted}' (surfaces: {names})"
        return
    floor = named[0]
    if floor.facing != "floor":
        yield f"heated_floor: surface '{wanted}' faces '{floor.facing}', not 'floor'"
    if after >= len(floor.layers):
        yield (
            f"pipes_after_layer = {after}: one of the {len(floor.layers)} layers of '{wanted}' must lie below the pipes"
        )
    elif not any(layer.density_kg_m3 for layer in floor.layers[after - 1 : after + 1]):
        yield f"the layers of '{wanted}' above and below the pipes have no mass"


def _boundary_problems(room: RoomDescription) -> Iterator[str]:
    for surface in room.surfaces:
        if surface.boundary == "ground" and room.ground_temperature_C is None:
            yield f"surface '{surface.name}' lies on the ground: ground_temperature_C is missing"
        if surface.solar_absorptance and (surface.boundary != "outdoors" or surface.azimuth_deg is None):
            yield f"surface '{surface.name}' takes sun outside: it needs boundary 'outdoors' and azimuth_deg"
    for window in room.windows:
        if window.U_W_m2K * room.films.interior_m2K_W("wall") >= 1:
            yield f"window '{window.name}': U_W_m2K = {window.U_W_m2K:g} is above that of its inner film alone"
    air = room.air
    leaks = air.ventilation_L_s + air.infiltration_L_s + air.thermal_bridges_W_K
    if not leaks and not room.windows and all(surface.boundary == "adiabatic" for surface in room.surfaces):
        yield "no heat can leave the room"


def _design_problems(room: RoomDescription) -> Iterator[str]:
    try:
        exchange_W_m2K(room.circuit, room.cover_m2K_W, room.screed_W_mK, np.ones(1))
    except ValueError as error:
        yield str(error)


def states_curve(p: Any) -> bool:
    """Return whether a room's circuit is that of Table 3, or states a heating curve."""
    return "circuit" not in p.model_fields_set or "heating_curve_C" in p.circuit.model_fields_set
