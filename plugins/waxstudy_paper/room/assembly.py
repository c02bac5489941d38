"""From a room's description to its linear model."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache, partial
from math import ceil, sqrt

import numpy as np

from waxstudy.plugin import ROOM_OUTPUTS, FloatArray, LinearRoom, Role, RoomInput, WeatherRecord
from waxstudy_paper.room.construction import Layer, Part, Surface, Window
from waxstudy_paper.room.description import RoomDescription, facade_name
from waxstudy_paper.room.hydronics import WATER_J_L_K, floor_conductance_W_K, full_flow_L_h, supply_C
from waxstudy_paper.room.network import Network, System, without_massless

AIR_J_L_K = 1.206  # density times specific heat of air at 20 C


@dataclass
class Assembly:
    """The network of a room under construction, and where its parts are."""

    room: RoomDescription
    network: Network
    air: int
    star: int  # massless node at which all surfaces exchange long-wave radiation
    faces: dict[str, int] = field(default_factory=dict)  # surface or window -> node at the room side
    layer: int = -1  # in the plane of the pipes
    floor_nodes: range = range(0)  # all nodes of the heated floor


def linear_room(room: RoomDescription) -> LinearRoom:
    """Return the linear room of a description, without the massless nodes."""
    assembly = assemble(room)
    system = without_massless(full_system(assembly))
    floor = room.floor
    floor_names = {assembly.network.nodes[node] for node in assembly.floor_nodes}
    return LinearRoom(
        floor_area_m2=floor.area_m2,
        nodes=system.nodes,
        capacity_J_K=system.capacity_J_K,
        conductance_W_K=system.conductance_W_K,
        inputs=[RoomInput(name, role) for name, role in inputs_of(room).items()],
        input_matrix=system.input_matrix,
        floor_heat_share=system.heat_share,
        output_matrix=system.output_matrix,
        feedthrough=system.feedthrough,
        air_nodes=np.array([float(name not in floor_names) for name in system.nodes]),
        facades=room.facades,
        full_flow_L_h=full_flow_L_h(room.circuit, floor.area_m2),
        water_J_L_K=WATER_J_L_K,
        floor_conductance_W_K=partial(
            floor_conductance_W_K, room.circuit, floor.area_m2, room.cover_m2K_W, room.screed_W_mK
        ),
        drive=partial(drive, room),
    )


def inputs_of(room: RoomDescription) -> dict[str, Role]:
    """Return the slow inputs with their roles."""
    ground = {} if room.ground_temperature_C is None else {"ground_C": Role.OWN}
    sky = {"sky_C": Role.SKY} if room.films.sky_W_m2K else {}
    air = {"outdoor_C": Role.OUTDOOR, "ventilation_supply_C": Role.SUPPLY_AIR}
    sun = dict.fromkeys([*map(irradiance, room.facades), *map(behind_shading, _shaded(room))], Role.SUN)
    return {**air, **ground, **sky, "gains_W": Role.GAINS, **sun}


def irradiance(facade: str) -> str:
    return f"irradiance {facade} W_m2"


def behind_shading(facade: str) -> str:
    return f"irradiance {facade} behind shading W_m2"


def _shaded(room: RoomDescription) -> list[str]:
    """The facades whose windows see the sun through shading: only the windows do, not the walls beside them."""
    names = dict.fromkeys(facade_name(window.facade) for window in room.windows)
    return list(names) if room.shading.passes < 1.0 else []


def drive(room: RoomDescription, weather: WeatherRecord) -> tuple[FloatArray, FloatArray]:
    """Return the slow inputs (intervals, m) and the supply temperature [C]; gains by the hour of the midpoint.

    Raises `ValueError` if the room radiates to a sky that the weather does not know.
    """
    if room.films.sky_W_m2K and weather.sky_C is None:
        raise ValueError(
            "it has no sky temperature, which films.sky_W_m2K of the room needs: use epw, or set that to 0"
        )
    count = len(weather.outdoor_C)
    hour = _hours(count, weather.interval_s)
    factors = np.array(room.gains.schedule) / np.mean(room.gains.schedule)
    values: dict[str, FloatArray | float | None] = {
        "outdoor_C": weather.outdoor_C,
        "ventilation_supply_C": room.air.ventilation_supply_C,
        "ground_C": room.ground_temperature_C,
        "sky_C": weather.sky_C,
        "gains_W": room.gains.mean_W_m2 * room.floor.area_m2 * factors[hour],
        **{irradiance(facade): weather.irradiance_W_m2[facade] for facade in room.facades},
        **{behind_shading(facade): room.shading.passed(weather, facade) for facade in _shaded(room)},
    }
    columns = [np.broadcast_to(np.asarray(values[name], dtype=float), count) for name in inputs_of(room)]
    return np.column_stack(columns), supply_C(room.circuit, weather.outdoor_C)


@lru_cache(maxsize=4)
def _hours(count: int, interval_s: float) -> np.ndarray:
    """Return the hour of the day of the middle of each interval (count,); read-only."""
    hours = ((np.arange(count) + 0.5) * interval_s % 86_400 // 3600).astype(int)
    hours.flags.writeable = False
    return hours


def assemble(room: RoomDescription) -> Assembly:
    """Return the full network of a room."""
    network = Network(tuple(inputs_of(room)))
    air = network.node("air", AIR_J_L_K * 1000 * room.air.volume_m3 * room.air.capacity_multiplier)
    assembly = Assembly(room, network, air, network.node("radiation"))
    _add_air_exchange(assembly)
    for surface in room.surfaces:
        _add_surface(assembly, surface)
    for window in room.windows:
        _add_window(assembly, window)
    _add_radiation(assembly)
    network.heat(air, "gains_W", 1 - room.gains.radiant_share)
    network.heat(assembly.star, "gains_W", room.gains.radiant_share)
    return assembly


def _add_air_exchange(assembly: Assembly) -> None:
    air = assembly.room.air
    outdoors_W_K = air.infiltration_L_s * AIR_J_L_K + air.thermal_bridges_W_K
    assembly.network.hold(assembly.air, "outdoor_C", outdoors_W_K)
    assembly.network.hold(assembly.air, "ventilation_supply_C", air.ventilation_L_s * AIR_J_L_K)


def _add_surface(assembly: Assembly, surface: Surface) -> None:
    room, network = assembly.room, assembly.network
    first = len(network.nodes)
    borders = add_layers(network, surface.name, surface.layers, surface.area_m2, room.cell_time_s)
    network.join(borders[0], assembly.air, surface.area_m2 * room.films.convective_W_m2K(surface.facing))
    assembly.faces[surface.name] = borders[0]
    if surface.boundary == "outdoors":
        _hold_outdoors(assembly, borders[-1], surface, surface.area_m2 * room.films.exterior_W_m2K)
    elif surface.boundary == "ground":
        network.hold(borders[-1], "ground_C", surface.area_m2 / room.ground_resistance_m2K_W)
    if surface.facade is not None:
        absorbed_m2 = surface.area_m2 * surface.solar_absorptance
        network.heat(borders[-1], irradiance(facade_name(surface.facade)), absorbed_m2)
    if surface.name == room.heated_floor.surface:
        assembly.layer = borders[room.heated_floor.pipes_after_layer]
        assembly.floor_nodes = range(first, len(network.nodes))


def _hold_outdoors(assembly: Assembly, node: int, part: Part, conductance_W_K: float) -> None:
    """Join a node to the air outside and to the sky through a film whose radiative part is shared between them."""
    sky = assembly.room.films.sky_share(part.tilt_deg)
    assembly.network.hold(node, "outdoor_C", conductance_W_K * (1 - sky))
    if sky:
        assembly.network.hold(node, "sky_C", conductance_W_K * sky)


def add_layers(network: Network, name: str, layers: tuple[Layer, ...], area_m2: float, cell_time_s: float) -> list[int]:
    """Add a chain of nodes through the layers and return those at the borders of the layers, room side first.

    Finite volumes around nodes: a layer of n cells of width dx has n + 1 nodes, half a cell at each border,
    joined by lambda A / dx; n is the least number with dx <= sqrt(diffusivity * cell_time).
    """
    borders = [network.node(f"{name} 0")]
    for number, layer in enumerate(layers, start=1):
        cells = _cells(layer, cell_time_s)
        for cell in range(1, cells + 1):
            node = network.node(f"{name} {number}" if cell == cells else f"{name} {number - 1}+{cell}/{cells}")
            network.join(node - 1, node, cells * area_m2 / layer.resistance_m2K_W)
            for end in (node - 1, node):
                network.load(end, layer.capacity_J_m2K * area_m2 / cells / 2)
        borders.append(node)
    return borders


def _cells(layer: Layer, cell_time_s: float) -> int:
    if layer.density_kg_m3 == 0:
        return 1
    # R C of the whole layer is thickness^2 / diffusivity
    return max(1, ceil(sqrt(layer.resistance_m2K_W * layer.capacity_J_m2K / cell_time_s)))


def _add_window(assembly: Assembly, window: Window) -> None:
    """A massless inner pane; heat put there is divided by 1 - U R_si, so that g is what reaches the room."""
    room, network, area = assembly.room, assembly.network, window.area_m2
    inner_m2K_W = room.films.interior_m2K_W("wall")
    pane = network.node(window.name)
    assembly.faces[window.name] = pane
    _hold_outdoors(assembly, pane, window, area / (1 / window.U_W_m2K - inner_m2K_W))
    network.join(pane, assembly.air, area * room.films.wall_W_m2K)
    facade = facade_name(window.facade)
    sun = behind_shading(facade) if facade in _shaded(room) else irradiance(facade)
    secondary = window.g * window.secondary_share
    network.heat(pane, sun, area * secondary / (1 - window.U_W_m2K * inner_m2K_W))
    through_m2 = area * (window.g - secondary) * (1 - room.sun.reflected_share)
    network.heat(assembly.air, sun, through_m2 * room.sun.air_share)
    for surface, share in sun_shares(room).items():
        network.heat(assembly.faces[surface], sun, through_m2 * (1 - room.sun.air_share) * share)


def sun_shares(room: RoomDescription) -> dict[str, float]:
    """Return how the sun on surfaces is shared out: floors as stated, the others the rest, both by area."""
    floors = sum(surface.area_m2 for surface in room.surfaces if surface.facing == "floor")
    others = sum(surface.area_m2 for surface in room.surfaces) - floors
    of_floors, of_others = room.sun.floor_share / floors, (1 - room.sun.floor_share) / others
    return {s.name: s.area_m2 * (of_floors if s.facing == "floor" else of_others) for s in room.surfaces}


def _add_radiation(assembly: Assembly) -> None:
    for name, conductance in radiant_conductance_W_K(assembly.room).items():
        assembly.network.join(assembly.faces[name], assembly.star, conductance)


def radiant_conductance_W_K(room: RoomDescription) -> dict[str, float]:
    """Return the conductance from each surface to the star node, A h_r / (1 - A / sum of A).

    The denominator takes out that a flat surface would see itself in a star weighted by area alone:
    one step of Carroll's MRT method (1980). What reaches the others is A h_r, in the paper's room within 1.1 %.
    """
    areas = {part.name: part.area_m2 for part in room.parts}
    total = sum(areas.values())
    return {name: area * room.films.radiative_W_m2K / (1 - area / total) for name, area in areas.items()}


def full_system(assembly: Assembly) -> System:
    """Return the matrices with all nodes; outputs in the order of `ROOM_OUTPUTS`."""
    room, air, face = assembly.room, assembly.air, assembly.faces[assembly.room.floor.name]
    row = assembly.network.row
    radiant = row(_radiant_weights(assembly))
    air_row = row({air: 1.0})
    sensor, operative = room.sensing.sensor_radiant_share, room.sensing.operative_air_share
    to_air = room.films.floor_W_m2K
    to_star = radiant_conductance_W_K(room)[room.floor.name] / room.floor.area_m2
    outputs = {
        "sensed_C": (1 - sensor) * air_row + sensor * radiant,
        "layer_C": row({assembly.layer: 1.0}),
        "operative_C": operative * air_row + (1 - operative) * radiant,
        "air_C": air_row,
        "floor_surface_C": row({face: 1.0}),
        "floor_heat_W_m2": row({face: to_air + to_star, air: -to_air, assembly.star: -to_star}),
    }
    return assembly.network.system(assembly.layer, [outputs[name] for name in ROOM_OUTPUTS])


def _radiant_weights(assembly: Assembly) -> dict[int, float]:
    """Weights of the surfaces in the mean radiant temperature at the operative point."""
    parts = assembly.room.parts
    weights = [part.area_m2 if part.operative_weight is None else part.operative_weight for part in parts]
    return {assembly.faces[p.name]: weight / sum(weights) for p, weight in zip(parts, weights, strict=True)}
