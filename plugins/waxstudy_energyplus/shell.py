"""The room's shell: every surface a square of its area with its layers and films, every window a pane in a wall.

EnergyPlus takes from the geometry which surfaces see each other (all but those that look the same way), no more: sun
and volume are given, films too.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import Any

import numpy as np

from waxstudy_energyplus.objects import ZONE, Object, Objects, schedule, sun_on, sun_outside
from waxstudy_paper.room.construction import Layer, Surface, Window
from waxstudy_paper.room.description import RoomDescription

BLACK_W_M2K4 = 5.670374e-8
MEAN_K = 293.15  # at which a film of 5.13 W/(m2 K) is an emissivity of 0.9
FRAME_SHARE = 1e-3
ASIDE_DEG = 15.0  # EnergyPlus takes up to 10 for the same way
LIGHT_SHARE = 0.1  # of the heat that the floor holds
NO_EMISSION = 1e-5  # outside: the film is convective and radiative in one, towards the outdoor air


def shell(room: RoomDescription) -> Objects:
    """Return zone, constructions, surfaces and windows."""
    yield "Zone", ZONE, {"volume": room.air.volume_m3, "floor_area": room.floor.area_m2}
    frames, hosts = _frames(room), window_hosts(room)
    azimuths = _azimuths_deg((*room.surfaces, *frames))
    for surface in (*room.surfaces, *frames):
        windows = [window for window in room.windows if hosts[window.name] == surface.name]
        gross_m2 = surface.area_m2 + sum(window.area_m2 for window in windows)
        yield from _construction(room, surface)
        yield from _surface(room, surface, gross_m2, azimuths.get(surface.name, 0.0))
        side_m, left_m = sqrt(gross_m2), 0.0
        for window in windows:  # side by side
            yield from _window(room, window, surface, azimuths.get(surface.name, 0.0), side_m, left_m)
            left_m += window.area_m2 / side_m
    if room.ground_temperature_C is not None:
        film = {"combined_convective_radiative_film_coefficient": 1 / room.ground_resistance_m2K_W}
        ground = {"constant_temperature": room.ground_temperature_C, "constant_temperature_coefficient": 1.0}
        yield "SurfaceProperty:OtherSideCoefficients", "ground", {**film, **ground}


def refuse_names(room: RoomDescription) -> None:
    """Raise `ValueError` for names that differ in case only."""
    seen: dict[str, str] = {}
    for part in room.parts:
        other = seen.setdefault(part.name.upper(), part.name)
        if other != part.name:
            raise ValueError(f"EnergyPlus does not tell the names '{other}' and '{part.name}' apart")


def pane_m2K_W(room: RoomDescription, window: Window) -> float:
    """Return the resistance that a window's U leaves between the films."""
    return 1 / window.U_W_m2K - room.films.interior_m2K_W("wall") - 1 / room.films.exterior_W_m2K


def refuse_windows(room: RoomDescription) -> None:
    """Raise `ValueError` for a window whose films alone let through less heat than its U says."""
    films_W_m2K = 1 / (room.films.interior_m2K_W("wall") + 1 / room.films.exterior_W_m2K)
    for window in room.windows:
        if pane_m2K_W(room, window) <= 0:
            wrong = f"must be below {films_W_m2K:.3g} in EnergyPlus, where the films alone let through as much"
            raise ValueError(f"window '{window.name}': U_W_m2K = {window.U_W_m2K:g} {wrong}")


def _azimuths_deg(surfaces: Sequence[Surface]) -> dict[str, float]:
    """Return where the walls look to, which in EnergyPlus says which see each other: those that look one way do not.

    Walls without a direction stand round the room, clockwise from the south, each a little aside of those before.
    """
    walls = [surface for surface in surfaces if surface.facing == "wall"]
    azimuths = {wall.name: wall.azimuth_deg for wall in walls if wall.azimuth_deg is not None}
    for number, wall in enumerate(wall for wall in walls if wall.azimuth_deg is None):
        azimuth = 180.0 + 90.0 * number
        while any(_apart_deg(azimuth, other) < ASIDE_DEG for other in azimuths.values()):
            azimuth += ASIDE_DEG
        azimuths[wall.name] = azimuth % 360.0
    return azimuths


def _apart_deg(one: float, other: float) -> float:
    return abs((one - other + 180.0) % 360.0 - 180.0)


def window_hosts(room: RoomDescription) -> dict[str, str]:
    """Return for each window the wall that it is cut into: of those to outdoors the one turned most like it."""
    azimuths = _azimuths_deg(room.surfaces)
    walls = [s.name for s in room.surfaces if s.facing == "wall" and s.boundary == "outdoors"]

    def nearest(window: Window) -> str:
        return min(
            walls, key=lambda wall: _apart_deg(azimuths[wall], window.azimuth_deg), default=f"frame of {window.name}"
        )

    return {window.name: nearest(window) for window in room.windows}


def _frames(room: RoomDescription) -> list[Surface]:
    """Return a narrow wall round each window for which the room has no wall to outdoors; it lets no heat through."""
    names, hosts = {surface.name for surface in room.surfaces}, window_hosts(room)
    tight = {"thickness_m": 1.0, "conductivity_W_mK": 0.01, "density_kg_m3": 0.0, "heat_capacity_J_kgK": 1000.0}
    return [
        Surface(
            name=hosts[window.name],
            area_m2=FRAME_SHARE * window.area_m2,
            boundary="outdoors",
            azimuth_deg=window.azimuth_deg,
            layers=(Layer(**tight),),
        )
        for window in room.windows
        if hosts[window.name] not in names
    ]


def emissivity(room: RoomDescription) -> float:
    """Return the emissivity of the room's surfaces: h_r / (4 sigma T^3)."""
    return room.films.radiative_W_m2K / (4 * BLACK_W_M2K4 * MEAN_K**3)


def layers(room: RoomDescription, surface: Surface) -> list[Layer]:
    """Return a surface's layers as EnergyPlus is given them, room side first.

    A thick light layer under the heated floor would stretch the step of its transfer functions to many minutes (9 for
    the paper's 430 mm of polystyrene, with heat at the surface in the first): such layers keep their resistance only,
    but for one beside the pipes, where EnergyPlus needs mass.
    """
    given = list(surface.layers)
    if surface.name == room.floor.name:
        least = LIGHT_SHARE * sum(layer.capacity_J_m2K for layer in given)
        pipes = room.heated_floor.pipes_after_layer
        light = [n > pipes and layer.capacity_J_m2K < least for n, layer in enumerate(given)]
        return [_massless(layer) if is_light else layer for layer, is_light in zip(given, light, strict=True)]
    if len(given) == 1:  # inside and outside radiate differently, and a material has one emissivity
        half = given[0].model_copy(update={"thickness_m": given[0].thickness_m / 2})
        return [half, half]
    return given


def _massless(layer: Layer) -> Layer:
    return layer.model_copy(update={"density_kg_m3": 0.0})


def _construction(room: RoomDescription, surface: Surface) -> Objects:
    names, last = [], len(layers(room, surface)) - 1
    for number, layer in enumerate(layers(room, surface)):
        emits = NO_EMISSION if number == last and surface.boundary == "outdoors" else emissivity(room)
        name = f"{surface.name} layer {number + 1}"
        names.append(name)
        yield _material(name, layer, emits)
    heated = surface.name == room.floor.name
    name = f"layers of {surface.name}"
    keys = ["outside_layer", *(f"layer_{n}" for n in range(2, len(names) + 1))]
    yield "Construction", name, dict(zip(keys, reversed(names), strict=True))
    if heated:
        below = len(names) - room.heated_floor.pipes_after_layer
        yield (
            "ConstructionProperty:InternalHeatSource",
            "pipes",
            {
                "construction_name": name,
                "thermal_source_present_after_layer_number": below,
                "temperature_calculation_requested_after_layer_number": below,
                "dimensions_for_the_ctf_calculation": 1,
                "tube_spacing": room.circuit.spacing_m,
            },
        )


def _material(name: str, layer: Layer, emits: float) -> Object:
    common = {"roughness": "Smooth", "thermal_absorptance": emits}
    if layer.density_kg_m3 == 0:
        return "Material:NoMass", name, {**common, "thermal_resistance": layer.resistance_m2K_W}
    solid = {"conductivity": layer.conductivity_W_mK, "density": layer.density_kg_m3}
    return (
        "Material",
        name,
        {**common, **solid, "thickness": layer.thickness_m, "specific_heat": layer.heat_capacity_J_kgK},
    )


def _surface(room: RoomDescription, surface: Surface, gross_m2: float, azimuth_deg: float) -> Objects:
    side_m = sqrt(gross_m2)
    boundaries = {"outdoors": "Outdoors", "adiabatic": "Adiabatic", "ground": "OtherSideCoefficients"}
    kinds = {"wall": "Wall", "floor": "Floor", "ceiling": "Roof" if surface.boundary == "outdoors" else "Ceiling"}
    fields = {
        "surface_type": kinds[surface.facing],
        "construction_name": f"layers of {surface.name}",
        "zone_name": ZONE,
        "outside_boundary_condition": boundaries[surface.boundary],
        "sun_exposure": "NoSun",
        "wind_exposure": "NoWind",
        "vertices": [_vertex(c) for c in _corners(surface.facing, azimuth_deg, side_m, 0.0, side_m)],
    }
    if surface.boundary == "ground":
        fields["outside_boundary_condition_object"] = "ground"
    yield "BuildingSurface:Detailed", surface.name, fields
    outside = room.films.exterior_W_m2K if surface.boundary == "outdoors" else None
    yield _films(surface.name, room.films.convective_W_m2K(surface.facing), outside)
    yield schedule(sun_on(surface.name))
    sun = {"surface_name": surface.name, "inside_face_heat_source_term_schedule_name": sun_on(surface.name)}
    if surface.facade is not None:
        yield schedule(sun_outside(surface.name))
        sun["outside_face_heat_source_term_schedule_name"] = sun_outside(surface.name)
    yield "SurfaceProperty:HeatBalanceSourceTerm", f"sun of {surface.name}", sun


def _films(name: str, inside_W_m2K: float, outside_W_m2K: float | None) -> Object:
    fields: dict[str, Any] = {"surface_name": name}
    films = {"Inside": inside_W_m2K, "Outside": outside_W_m2K}
    for number, (side, film) in enumerate(((s, f) for s, f in films.items() if f is not None), start=1):
        key = f"convection_coefficient_{number}"
        fields |= {f"{key}_location": side, f"{key}_type": "Value", key: film}
    return "SurfaceProperty:ConvectionCoefficients", f"films of {name}", fields


def _corners(facing: str, azimuth_deg: float, side_m: float, left_m: float, right_m: float) -> list[tuple[float, ...]]:
    """Return the corners of a strip of a square, seen from outside, counterclockwise from the lower left."""
    plane = [(left_m, 0.0), (right_m, 0.0), (right_m, side_m), (left_m, side_m)]
    if facing == "floor":
        return [(y, x, 0.0) for x, y in plane]
    if facing == "ceiling":
        return [(x, y, side_m) for x, y in plane]
    turn = np.radians(azimuth_deg)
    away, right = 10.0 * np.array([np.sin(turn), np.cos(turn)]), np.array([-np.cos(turn), np.sin(turn)])
    return [(*map(float, away + along * right), up) for along, up in plane]


def _named(corner: tuple[float, ...]) -> dict[str, float]:
    return {f"{axis}_coordinate": value for axis, value in zip("xyz", corner, strict=True)}


def _vertex(corner: tuple[float, ...]) -> dict[str, float]:
    return {f"vertex_{key}": value for key, value in _named(corner).items()}


def _window(
    room: RoomDescription, window: Window, host: Surface, azimuth_deg: float, side_m: float, left_m: float
) -> Objects:
    """A single opaque pane with the resistance that U leaves between the films; its sun is an input."""
    pane = {
        "optical_data_type": "SpectralAverage",
        "thickness": 0.01,
        "conductivity": 0.01 / pane_m2K_W(room, window),
        "solar_transmittance_at_normal_incidence": 0.0,
        "front_side_solar_reflectance_at_normal_incidence": 0.9,
        "back_side_solar_reflectance_at_normal_incidence": 0.9,
        "visible_transmittance_at_normal_incidence": 0.0,
        "front_side_visible_reflectance_at_normal_incidence": 0.9,
        "back_side_visible_reflectance_at_normal_incidence": 0.9,
        "front_side_infrared_hemispherical_emissivity": NO_EMISSION,
        "back_side_infrared_hemispherical_emissivity": emissivity(room),
    }
    yield "WindowMaterial:Glazing", f"pane of {window.name}", pane
    yield "Construction", f"layers of {window.name}", {"outside_layer": f"pane of {window.name}"}
    corners = _corners(host.facing, azimuth_deg, side_m, left_m, left_m + window.area_m2 / side_m)
    places = {f"vertex_{n}_{key}": value for n, c in enumerate(corners, start=1) for key, value in _named(c).items()}
    named = {"surface_type": "Window", "construction_name": f"layers of {window.name}"}
    yield "FenestrationSurface:Detailed", window.name, {**named, "building_surface_name": host.name, **places}
    yield _films(window.name, room.films.wall_W_m2K, room.films.exterior_W_m2K)
