"""A room's description as an epJSON model: the layers, films and exchange of the fast room, EnergyPlus' own physics.

What EnergyPlus does by itself: conduction (transfer functions), long-wave exchange between grey surfaces, the air's
balance, the radiant floor and its water loop. What it is told each minute (`inputs.py`): outdoor temperature, sun,
gains, exchange of air, supply temperature, flow.
"""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from waxstudy_energyplus.objects import (
    ALWAYS,
    ALWAYS_WARM,
    ANY_NUMBER,
    EXCHANGE,
    GAINS,
    RADIANT_FLOOR,
    SUN_TO_AIR,
    SUN_TO_PANES,
    SUPPLY,
    ZONE,
    Objects,
    schedule,
)
from waxstudy_energyplus.plant import CONDUCTIVITY_W_MK, LAMINAR_NUSSELT, WIDE_M, full_flow_kg_s, plant
from waxstudy_energyplus.shell import shell
from waxstudy_paper.room.assembly import AIR_J_L_K
from waxstudy_paper.room.description import RoomDescription
from waxstudy_paper.room.hydronics import exchange_W_m2K, full_flow_L_h

Model = dict[str, dict[str, dict[str, Any]]]

VERSION = "25.2"
STEPS_PER_HOUR = 60
MINUTE_S = 3600.0 / STEPS_PER_HOUR
PRECONDITIONING_DAYS = 1
FIRST_YEAR = 2001  # neither it nor the next is a leap year

UNWANTED = (
    *("csv", "mtr", "eso", "tabular", "sqlite", "json", "audit", "space_sizing", "zone_sizing", "system_sizing", "dxf"),
    *("bnd", "rdd", "mdd", "mtd", "shd", "dfs", "edd", "dbg", "perflog", "sln", "sci", "wrl", "screen"),
    "plant_component_sizing",
)


def model(room: RoomDescription, days: int) -> Model:
    """Return the model of a room for a run of so many days, a year or two at most."""
    objects: Model = {}
    for kind, name, fields in (*_settings(days), *shell(room), *_air(room), *_heating(room)):
        objects.setdefault(kind, {})[name] = fields
    return objects


def _settings(days: int) -> Objects:
    yield "Version", "version", {"version_identifier": VERSION}
    yield "SimulationControl", "control", {"run_simulation_for_sizing_periods": "No"}
    yield (
        "Building",
        "building",
        {
            "solar_distribution": "MinimalShadowing",
            # the engine's own warm-up only brings the room near its start
            "minimum_number_of_warmup_days": PRECONDITIONING_DAYS,
            "maximum_number_of_warmup_days": PRECONDITIONING_DAYS,
            "loads_convergence_tolerance_value": 0.5,
            "temperature_convergence_tolerance_value": 0.5,
        },
    )
    yield "Timestep", "timestep", {"number_of_timesteps_per_hour": STEPS_PER_HOUR}
    yield (
        "Site:HeightVariation",
        "heights",
        {"wind_speed_profile_exponent": 0.0, "air_temperature_gradient_coefficient": 0.0},
    )
    rules = {"starting_vertex_position": "LowerLeftCorner", "vertex_entry_direction": "Counterclockwise"}
    yield "GlobalGeometryRules", "rules", {**rules, "coordinate_system": "World"}
    last = np.datetime64(f"{FIRST_YEAR}-01-01") + np.timedelta64(days - 1, "D")
    year, month, day = (int(part) for part in str(last).split("-"))
    period = {"begin_month": 1, "begin_day_of_month": 1, "begin_year": FIRST_YEAR}
    yield "RunPeriod", "run", {**period, "end_month": month, "end_day_of_month": day, "end_year": year}
    yield "ScheduleTypeLimits", ANY_NUMBER, {"numeric_type": "Continuous"}
    for name, value in ((ALWAYS, 1.0), (ALWAYS_WARM, 99.0), (SUPPLY, 20.0)):
        yield schedule(name, value)
    yield "Output:Constructions", "constructions", {"details_type_1": "Constructions"}
    yield "OutputControl:Files", "files", {f"output_{name}": "No" for name in UNWANTED}


def _air(room: RoomDescription) -> Objects:
    """Ventilation, leaks and thermal bridges are one exchange; its flow and temperature are inputs."""
    capacity = {"zone_or_zonelist_name": ZONE, "temperature_capacity_multiplier": room.air.capacity_multiplier}
    yield "ZoneCapacitanceMultiplier:ResearchSpecial", "furniture", capacity
    zone = {"zone_or_zonelist_or_space_or_spacelist_name": ZONE}
    flow = {
        "design_flow_rate_calculation_method": "Flow/Zone",
        "design_flow_rate": exchange_W_K(room) / AIR_J_L_K / 1000,
    }
    yield "ZoneInfiltration:DesignFlowRate", EXCHANGE, {**zone, "schedule_name": ALWAYS, **flow}
    for name, radiant in (
        (GAINS, room.gains.radiant_share),
        (SUN_TO_AIR, 0.0),
        (SUN_TO_PANES, pane_radiant_share(room)),
    ):
        yield schedule(name)
        heat = {"fuel_type": "None", "schedule_name": name, "design_level": 1.0, "fraction_radiant": radiant}
        yield "OtherEquipment", name, {**zone, **heat}


def exchange_W_K(room: RoomDescription) -> float:
    """Return what the air loses per kelvin by ventilation, leaks and thermal bridges."""
    return (room.air.ventilation_L_s + room.air.infiltration_L_s) * AIR_J_L_K + room.air.thermal_bridges_W_K


def pane_radiant_share(room: RoomDescription) -> float:
    """Return the share of radiation in what a window pane gives to the room."""
    return room.films.radiative_W_m2K * room.films.interior_m2K_W("wall")


def tube_length_m(room: RoomDescription) -> float:
    """Return the length of laminar tube whose exchange is that of the fast room, k A = pi lambda Nu L.

    EnergyPlus has two tube models. `ISOStandard` gives other resistances than EN 1264 and ours; `ConvectionOnly` has
    a film only, which for laminar flow depends neither on flow nor on diameter: the one number that is needed.
    """
    full_L_s = np.array([full_flow_L_h(room.circuit, room.floor.area_m2) / 3600.0])
    exchange = float(exchange_W_m2K(room.circuit, room.cover_m2K_W, room.screed_W_mK, full_L_s)[0])
    return exchange * room.floor.area_m2 / (pi * CONDUCTIVITY_W_MK * LAMINAR_NUSSELT)


def _heating(room: RoomDescription) -> Objects:
    # a tenth above full flow, which the run sets in kg/s: EnergyPlus takes this with the density of hot water
    flow_m3_s = 1.1 * full_flow_kg_s(room) / 1000.0
    tube = {
        "fluid_to_radiant_surface_heat_transfer_model": "ConvectionOnly",
        "hydronic_tubing_inside_diameter": WIDE_M,
        "hydronic_tubing_outside_diameter": WIDE_M * 1.01,
    }
    # it asks for heat always; how much flows is an input
    control = {"heating_control_temperature_schedule_name": ALWAYS_WARM, "heating_control_throttling_range": 0.5}
    yield "ZoneHVAC:LowTemperatureRadiant:VariableFlow:Design", "tube", {**tube, **control}
    radiant = {
        "design_object": "tube",
        "availability_schedule_name": ALWAYS,
        "zone_name": ZONE,
        "surface_name_or_radiant_surface_group_name": room.floor.name,
        "hydronic_tubing_length": tube_length_m(room),
        "heating_design_capacity": 1e5,
        "maximum_hot_water_flow": flow_m3_s,
        "heating_water_inlet_node_name": "floor inlet",
        "heating_water_outlet_node_name": "floor outlet",
    }
    yield "ZoneHVAC:LowTemperatureRadiant:VariableFlow", RADIANT_FLOOR, radiant
    floor = {
        "zone_equipment_object_type": "ZoneHVAC:LowTemperatureRadiant:VariableFlow",
        "zone_equipment_name": RADIANT_FLOOR,
        "zone_equipment_cooling_sequence": 1,
        "zone_equipment_heating_or_no_load_sequence": 1,
    }
    yield "ZoneHVAC:EquipmentList", "equipment", {"equipment": [floor]}
    zone = {"zone_name": ZONE, "zone_conditioning_equipment_list_name": "equipment", "zone_air_node_name": "air"}
    yield "ZoneHVAC:EquipmentConnections", "equipment", zone
    yield from plant(flow_m3_s)
