"""The room in EnergyPlus: what is believed of it, how it is, and what EnergyPlus is told of each quarter of an hour."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from waxstudy.plugin import FloatArray, WeatherRecord, changed
from waxstudy_trials.energyplus.blocks import STEP_S
from waxstudy_trials.energyplus.description import House
from waxstudy_trials.plant.weather import DAY_PARTS, PART_S, G, Weather

if TYPE_CHECKING:
    from waxstudy_energyplus.record import Simulated
    from waxstudy_paper.room import RoomDescription

AIR_J_L_K = 1.206
WINDOW_M2 = 5.0
# a corner room of a house, as built; nobody has weighed the furniture
BUILDING: Mapping[str, Any] = {
    "facade_m": {"south": 4.2, "west": 3.6},
    "window_area_m2": {"south": 2.5, "west": 2.5},
    "height_m": 2.7,
    "floor_area_m2": 15.12,
    "window_U_W_m2K": 0.8,
    "window_g": G,
    "wall_U_W_m2K": 0.14,
    "thermal_bridge_W_m2K": 0.03,
    "floor_U_W_m2K": 0.1,
    "screed_above_m": 0.045,
    "screed_below_m": 0.022,
    "concrete_m": 0.08,
    "pipe": {"outer_mm": 17.0, "wall_mm": 2.0, "spacing_mm": 200.0, "conductivity_W_mK": 0.35},
    "air_capacity_multiplier": 3.0,
    "infiltration_L_s": 0.4,
    "ventilation_L_s": 6.5,
    "gain_radiant_share": 0.5,
    "heating_curve_C": [[-22.0, 34.0], [20.0, 22.0]],
}
COVER_W_MK, COVER_KG_M3, COVER_J_KGK = 0.14, 500.0, 1600.0  # wood


def building(full_flow_L_h: float) -> dict[str, Any]:
    """Return what is known of the room."""
    return {**BUILDING, "nominal_flow_L_h": full_flow_L_h}


@cache
def known(full_flow_L_h: float, wall_U: float = 1.0, window_U: float = 1.0) -> RoomDescription:
    """Return the room as it is believed, or with factors on its U-values."""
    from waxstudy_paper.room import NzebRoom

    told = building(full_flow_L_h)
    told |= {name: told[name] * f for name, f in (("wall_U_W_m2K", wall_U), ("window_U_W_m2K", window_U))}
    parameters, _ = NzebRoom.of_building(NzebRoom.Building(**told))
    return NzebRoom.description(NzebRoom.Parameters(**parameters))


def described(house: House) -> RoomDescription:
    """Return the room as it is."""
    room = known(house.full_flow_L_h, house.wall_U, house.window_U)
    surfaces = {surface.name: surface for surface in room.surfaces}
    for name, surface in surfaces.items():
        layers = [
            layer if name == room.floor.name else changed(layer, density_kg_m3=house.mass * layer.density_kg_m3)
            for layer in surface.layers
        ]
        if name == room.floor.name and house.cover_m2K_W:
            layers.insert(0, cover(house.cover_m2K_W))
        surfaces[name] = changed(surface, layers=tuple(layers))
    multiplier = max(1.0, room.air.capacity_multiplier * house.furniture * house.mass)
    after = room.heated_floor.pipes_after_layer + (1 if house.cover_m2K_W else 0)
    return changed(
        room,
        surfaces=tuple(surfaces.values()),
        heated_floor=changed(room.heated_floor, pipes_after_layer=after),
        air=changed(room.air, capacity_multiplier=multiplier),
        circuit=changed(
            room.circuit, full_flow_L_h=house.flow * house.full_flow_L_h, exchange_factor=_exchange(house, room)
        ),
    )


def _exchange(house: House, room: RoomDescription) -> float:
    """Return the factor on the exchange of water and floor, that of a resistance besides at the full flow."""
    from waxstudy_paper.room.hydronics import pipe_exchange_W_m2K

    screed = room.floor.layers[room.heated_floor.pipes_after_layer - 1]
    flow_L_s = np.array(house.full_flow_L_h / 3600.0)
    exchange_W_m2K = float(pipe_exchange_W_m2K(room.circuit, screed.conductivity_W_mK, flow_L_s))
    return house.exchange / (1.0 + house.exchange_m2K_W * exchange_W_m2K)


def cover(resistance_m2K_W: float) -> Any:
    """Return wood of a resistance."""
    from waxstudy_paper.room.construction import Layer

    return Layer(
        thickness_m=resistance_m2K_W * COVER_W_MK,
        conductivity_W_mK=COVER_W_MK,
        density_kg_m3=COVER_KG_M3,
        heat_capacity_J_kgK=COVER_J_KGK,
    )


def run(house: House, weather: Weather, setpoint_C: float, advance: Any) -> Simulated:
    """Return what EnergyPlus makes of a house, from the first day of the weather on; raises as its `simulate` does."""
    from waxstudy_energyplus.run import simulate

    room = described(house)
    irradiance_W_m2 = house.sun * weather.sun_W / (G * WINDOW_M2)
    sun = dict.fromkeys(room.facades, irradiance_W_m2)
    record = WeatherRecord(float(PART_S), "2023-01-01", weather.outdoor_C, sun)
    given = told(house, weather, room, record)
    return simulate(room, record, advance, setpoint_C=setpoint_C, step_s=STEP_S, warm_up_days=0, told=given)


def told(house: House, weather: Weather, room: RoomDescription, record: WeatherRecord) -> dict[str, FloatArray]:
    """Return what EnergyPlus is told otherwise than by the room's description: water, gains, a stove, and air."""
    from waxstudy_energyplus import objects
    from waxstudy_energyplus.described import EXCHANGE_C
    from waxstudy_energyplus.inputs import inputs

    hour = (np.arange(len(weather.sun_W)) + 0.5) * PART_S / 3600.0 % 24.0
    is_lit = (hour >= 18.0) & (hour < 22.0) & (weather.outdoor_C < -2.0)
    later = round(house.gains_later_h * 3600.0 / PART_S)
    exchange_W_K, arriving_C = exchange(house, weather, room)
    return {
        objects.SUPPLY: weather.supply_C + house.supply_K,
        objects.GAINS: house.gains * np.roll(weather.gains_W, later),
        objects.SUN_TO_AIR: inputs(room, record)[objects.SUN_TO_AIR] + house.stove_W * is_lit,
        objects.EXCHANGE: exchange_W_K,
        EXCHANGE_C: arriving_C,
    }


def exchange(house: House, weather: Weather, room: RoomDescription) -> tuple[FloatArray, FloatArray]:
    """Return what the air exchanges per kelvin, and the temperature that it mixes to, of all that comes in."""
    air = room.air
    leaks_L_s = air.infiltration_L_s * house.leaks * (1.0 + house.gust * weather.wind)
    outdoors_W_K = AIR_J_L_K * (leaks_L_s + house.window_L_s * open_share(house, len(leaks_L_s)))
    outdoors_W_K = outdoors_W_K + air.thermal_bridges_W_K
    supplied_W_K, neighbour_W_K = AIR_J_L_K * air.ventilation_L_s, house.neighbour_W_K
    together_W_K = outdoors_W_K + supplied_W_K + neighbour_W_K
    arriving_W = outdoors_W_K * weather.outdoor_C + supplied_W_K * air.ventilation_supply_C
    return together_W_K, (arriving_W + neighbour_W_K * weather.neighbour_C) / together_W_K


def open_share(house: House, count: int) -> FloatArray:
    """Return the share of each part of the days in which the window is open."""
    minutes_h = (np.arange(1440) + 0.5) / 60.0
    is_open = (minutes_h - house.window_from_h) % 24.0 < house.window_hours
    return np.tile(is_open.reshape(DAY_PARTS, -1).mean(axis=1), count // DAY_PARTS)
