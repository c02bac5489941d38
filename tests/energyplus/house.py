"""A house as somebody may have modelled it in EnergyPlus: four zones in a row, each heated in its own way by water.

Living has a floor of variable flow, Bedroom one of constant flow, Bath a baseboard, Store nothing.
"""

from __future__ import annotations

from typing import Any

Model = dict[str, dict[str, dict[str, Any]]]

ZONES = ("Living", "Bedroom", "Bath", "Store")
WIDE_M, DEEP_M, HIGH_M = 5.0, 4.0, 2.7
FLOW_M3_S = 3e-5
SUPPLY_C = 38.0


def house() -> Model:
    """Return the model, in the words of epJSON."""
    objects: Model = {}
    for kind, name, fields in (*_settings(), *_fabric(), *_rooms(), *_units(), *_plant()):
        objects.setdefault(kind, {})[name] = fields
    return objects


Objects = list[tuple[str, str, dict[str, Any]]]


def _settings() -> Objects:
    period = {"begin_month": 1, "begin_day_of_month": 1, "end_month": 12, "end_day_of_month": 31}
    constants = {"on": 1.0, "supply": SUPPLY_C, "wanted": 20.0, "cool": 26.0, "hot": 60.0, "control": 1.0, "low": 10.0}
    return [
        ("Version", "version", {"version_identifier": "25.2"}),
        ("SimulationControl", "control", {"run_simulation_for_sizing_periods": "No"}),
        ("Building", "house", {"minimum_number_of_warmup_days": 2, "maximum_number_of_warmup_days": 6}),
        ("Timestep", "step", {"number_of_timesteps_per_hour": 6}),
        ("RunPeriod", "year", {**period, "day_of_week_for_start_day": "Tuesday"}),
        ("Site:Location", "Chicago", {"latitude": 41.98, "longitude": -87.92, "time_zone": -6.0, "elevation": 201.0}),
        (
            "GlobalGeometryRules",
            "rules",
            {
                "starting_vertex_position": "LowerLeftCorner",
                "vertex_entry_direction": "Counterclockwise",
                "coordinate_system": "World",
            },
        ),
        ("ScheduleTypeLimits", "any", {"numeric_type": "Continuous"}),
        *(
            ("Schedule:Constant", name, {"schedule_type_limits_name": "any", "hourly_value": value})
            for name, value in constants.items()
        ),
        (
            "Schedule:Compact",
            "people",
            {
                "schedule_type_limits_name": "any",
                "data": [
                    {"field": field}
                    for field in ("Through: 12/31", "For: Weekdays", "Until: 08:00", 0.2, "Until: 24:00", 1.0)
                ]
                + [{"field": field} for field in ("For: AllOtherDays", "Until: 24:00", 0.5)],
            },
        ),
    ]


def _material(thickness: float, conductivity: float, density: float) -> dict[str, Any]:
    return {
        "roughness": "Rough",
        "thickness": thickness,
        "conductivity": conductivity,
        "density": density,
        "specific_heat": 900.0,
    }


def _fabric() -> Objects:
    layers = ["insulation", "screed below", "screed"]
    return [
        ("Material", "brick", _material(0.12, 0.6, 1700.0)),
        ("Material", "insulation", _material(0.15, 0.04, 30.0)),
        ("Material", "screed below", _material(0.03, 1.4, 2000.0)),
        ("Material", "screed", _material(0.05, 1.4, 2000.0)),
        ("Construction", "wall", {"outside_layer": "insulation", "layer_2": "brick"}),
        ("Construction", "roof", {"outside_layer": "insulation", "layer_2": "brick"}),
        ("Construction", "plain floor", dict(zip(("outside_layer", "layer_2", "layer_3"), layers, strict=True))),
        ("Construction", "warm floor", dict(zip(("outside_layer", "layer_2", "layer_3"), layers, strict=True))),
        (
            "ConstructionProperty:InternalHeatSource",
            "pipes",
            {
                "construction_name": "warm floor",
                "thermal_source_present_after_layer_number": 2,
                "temperature_calculation_requested_after_layer_number": 2,
                "dimensions_for_the_ctf_calculation": 1,
                "tube_spacing": 0.2,
            },
        ),
        (
            "WindowMaterial:SimpleGlazingSystem",
            "panes",
            {"u_factor": 1.3, "solar_heat_gain_coefficient": 0.5},
        ),
        ("Construction", "window", {"outside_layer": "panes"}),
    ]


def _rooms() -> Objects:
    objects: Objects = []
    for number, zone in enumerate(ZONES):
        objects += [("Zone", zone, {}), *_surfaces(zone, number * WIDE_M)]
        flow = {"design_flow_rate_calculation_method": "AirChanges/Hour", "air_changes_per_hour": 0.5}
        place = {"zone_or_zonelist_or_space_or_spacelist_name": zone}
        objects += [("ZoneInfiltration:DesignFlowRate", f"leaks of {zone}", {**place, "schedule_name": "on", **flow})]
        heat = {"fuel_type": "None", "schedule_name": "people", "design_level": 100.0, "fraction_radiant": 0.5}
        objects += [("OtherEquipment", f"people in {zone}", {**place, **heat})]
    return objects


def _surfaces(zone: str, x_m: float) -> Objects:
    a, b, d, h = x_m, x_m + WIDE_M, DEEP_M, HIGH_M
    faces = {
        "south": ("Wall", "wall", [(a, 0, 0), (b, 0, 0), (b, 0, h), (a, 0, h)]),
        "north": ("Wall", "wall", [(b, d, 0), (a, d, 0), (a, d, h), (b, d, h)]),
        "roof": ("Roof", "roof", [(a, 0, h), (b, 0, h), (b, d, h), (a, d, h)]),
        "floor": ("Floor", "warm floor" if zone in ("Living", "Bedroom") else "plain floor", []),
    }
    objects: Objects = []
    for face, (kind, construction, corners) in faces.items():
        corners = corners or [(a, d, 0), (b, d, 0), (b, 0, 0), (a, 0, 0)]
        fields = {
            "surface_type": kind,
            "construction_name": construction,
            "zone_name": zone,
            "outside_boundary_condition": "Adiabatic" if face == "floor" else "Outdoors",
            "sun_exposure": "NoSun" if face == "floor" else "SunExposed",
            "wind_exposure": "NoWind" if face == "floor" else "WindExposed",
            "vertices": [
                {f"vertex_{axis}_coordinate": float(v) for axis, v in zip("xyz", c, strict=True)} for c in corners
            ],
        }
        objects.append(("BuildingSurface:Detailed", f"{zone} {face}", fields))
    pane = [(a + 1, 0, 0.9), (a + 3, 0, 0.9), (a + 3, 0, 2.1), (a + 1, 0, 2.1)]
    places = {
        f"vertex_{n}_{axis}_coordinate": float(v)
        for n, corner in enumerate(pane, start=1)
        for axis, v in zip("xyz", corner, strict=True)
    }
    window = {"surface_type": "Window", "construction_name": "window", "building_surface_name": f"{zone} south"}
    return [*objects, ("FenestrationSurface:Detailed", f"{zone} window", {**window, **places})]


def _units() -> Objects:
    variable, constant = "ZoneHVAC:LowTemperatureRadiant:VariableFlow", "ZoneHVAC:LowTemperatureRadiant:ConstantFlow"
    baseboard = "ZoneHVAC:Baseboard:Convective:Water"
    of_zone = {"availability_schedule_name": "on", "hydronic_tubing_length": 100.0}
    return [
        (f"{variable}:Design", "curve", {"heating_control_temperature_schedule_name": "wanted"}),
        (
            variable,
            "Living floor heating",
            {
                **of_zone,
                "design_object": "curve",
                "zone_name": "Living",
                "surface_name_or_radiant_surface_group_name": "Living floor",
                "heating_design_capacity": 3000.0,
                "maximum_hot_water_flow": FLOW_M3_S,
                **_nodes("Living", "heating_water_{}_node_name"),
            },
        ),
        (f"{constant}:Design", "mixing", {}),
        (
            constant,
            "Bedroom floor heating",
            {
                **of_zone,
                "design_object": "mixing",
                "zone_name": "Bedroom",
                "surface_name_or_radiant_surface_group_name": "Bedroom floor",
                "rated_flow_rate": FLOW_M3_S,
                "rated_pump_head": 30000.0,
                "rated_power_consumption": 10.0,
                **_nodes("Bedroom", "heating_water_{}_node_name"),
                "heating_high_water_temperature_schedule_name": "supply",
                "heating_low_water_temperature_schedule_name": "low",
                "heating_high_control_temperature_schedule_name": "wanted",
                "heating_low_control_temperature_schedule_name": "low",
            },
        ),
        (
            baseboard,
            "Bath baseboard",
            {
                "availability_schedule_name": "on",
                "heating_design_capacity": 1500.0,
                "u_factor_times_area_value": 60.0,
                "maximum_water_flow_rate": FLOW_M3_S,
                **_nodes("Bath", "{}_node_name"),
            },
        ),
        *_equipment("Living", variable, "Living floor heating"),
        *_equipment("Bedroom", constant, "Bedroom floor heating"),
        *_equipment("Bath", baseboard, "Bath baseboard"),
        (
            "ZoneControl:Thermostat",
            "Bath thermostat",
            {
                "zone_or_zonelist_name": "Bath",
                "control_type_schedule_name": "control",
                "control_1_object_type": "ThermostatSetpoint:SingleHeating",
                "control_1_name": "Bath setpoint",
            },
        ),
        ("ThermostatSetpoint:SingleHeating", "Bath setpoint", {"setpoint_temperature_schedule_name": "wanted"}),
    ]


def _nodes(zone: str, pattern: str) -> dict[str, str]:
    return {pattern.format(side): f"{zone} {side}" for side in ("inlet", "outlet")}


def _equipment(zone: str, kind: str, name: str) -> Objects:
    item = {
        "zone_equipment_object_type": kind,
        "zone_equipment_name": name,
        "zone_equipment_cooling_sequence": 1,
        "zone_equipment_heating_or_no_load_sequence": 1,
    }
    connection = {
        "zone_name": zone,
        "zone_conditioning_equipment_list_name": f"equipment of {zone}",
        "zone_air_node_name": f"air of {zone}",
    }
    return [
        ("ZoneHVAC:EquipmentList", f"equipment of {zone}", {"equipment": [item]}),
        ("ZoneHVAC:EquipmentConnections", f"connections of {zone}", connection),
    ]


def _plant() -> Objects:
    heated = {
        "Living": ("ZoneHVAC:LowTemperatureRadiant:VariableFlow", "Living floor heating"),
        "Bedroom": ("ZoneHVAC:LowTemperatureRadiant:ConstantFlow", "Bedroom floor heating"),
        "Bath": ("ZoneHVAC:Baseboard:Convective:Water", "Bath baseboard"),
    }
    pipe = "Pipe:Adiabatic"
    branches = {
        "pump branch": ("Pump:VariableSpeed", "pump", "supply inlet", "pump outlet"),
        "source branch": ("DistrictHeating:Water", "network", "source inlet", "source outlet"),
        "out branch": (pipe, "out", "out inlet", "supply outlet"),
        "to rooms": (pipe, "to", "demand inlet", "to outlet"),
        **{f"to {zone}": (*unit, f"{zone} inlet", f"{zone} outlet") for zone, unit in heated.items()},
        "from rooms": (pipe, "from", "from inlet", "demand outlet"),
    }
    sides = {"supply": list(branches)[:3], "demand": list(branches)[3:]}
    objects: Objects = [
        (
            "PlantLoop",
            "water",
            {
                "plant_equipment_operation_scheme_name": "operation",
                "loop_temperature_setpoint_node_name": "supply outlet",
                "maximum_loop_temperature": 90.0,
                "minimum_loop_temperature": 5.0,
                "maximum_loop_flow_rate": 4 * FLOW_M3_S,
                "plant_side_inlet_node_name": "supply inlet",
                "plant_side_outlet_node_name": "supply outlet",
                "plant_side_branch_list_name": "supply branches",
                "plant_side_connector_list_name": "supply connectors",
                "demand_side_inlet_node_name": "demand inlet",
                "demand_side_outlet_node_name": "demand outlet",
                "demand_side_branch_list_name": "demand branches",
                "demand_side_connector_list_name": "demand connectors",
            },
        ),
        (
            "SetpointManager:Scheduled",
            "hot water",
            {
                "control_variable": "Temperature",
                "schedule_name": "supply",
                "setpoint_node_or_nodelist_name": "supply outlet",
            },
        ),
        (
            "PlantEquipmentOperationSchemes",
            "operation",
            {
                "control_scheme_1_object_type": "PlantEquipmentOperation:HeatingLoad",
                "control_scheme_1_name": "heat",
                "control_scheme_1_schedule_name": "on",
            },
        ),
        (
            "PlantEquipmentOperation:HeatingLoad",
            "heat",
            {
                "load_range_1_lower_limit": 0.0,
                "load_range_1_upper_limit": 1e9,
                "range_1_equipment_list_name": "sources",
            },
        ),
        (
            "PlantEquipmentList",
            "sources",
            {"equipment": [{"equipment_object_type": "DistrictHeating:Water", "equipment_name": "network"}]},
        ),
        (
            "DistrictHeating:Water",
            "network",
            {
                "hot_water_inlet_node_name": "source inlet",
                "hot_water_outlet_node_name": "source outlet",
                "nominal_capacity": 20000.0,
            },
        ),
        (
            "Pump:VariableSpeed",
            "pump",
            {
                "inlet_node_name": "supply inlet",
                "outlet_node_name": "pump outlet",
                "design_maximum_flow_rate": 4 * FLOW_M3_S,
                "design_pump_head": 20000.0,
                "design_power_consumption": 20.0,
                "pump_control_type": "Intermittent",
            },
        ),
    ]
    for name, (kind, component, inlet, outlet) in branches.items():
        if kind == pipe:
            objects.append((pipe, component, {"inlet_node_name": inlet, "outlet_node_name": outlet}))
        part = {"component_object_type": kind, "component_name": component}
        nodes = {"component_inlet_node_name": inlet, "component_outlet_node_name": outlet}
        objects.append(("Branch", name, {"components": [{**part, **nodes}]}))
    for side, names in sides.items():
        objects += [
            ("BranchList", f"{side} branches", {"branches": [{"branch_name": name} for name in names]}),
            (
                "ConnectorList",
                f"{side} connectors",
                {
                    "connector_1_object_type": "Connector:Splitter",
                    "connector_1_name": f"{side} splitter",
                    "connector_2_object_type": "Connector:Mixer",
                    "connector_2_name": f"{side} mixer",
                },
            ),
            (
                "Connector:Splitter",
                f"{side} splitter",
                {"inlet_branch_name": names[0], "branches": [{"outlet_branch_name": n} for n in names[1:-1]]},
            ),
            (
                "Connector:Mixer",
                f"{side} mixer",
                {"outlet_branch_name": names[-1], "branches": [{"inlet_branch_name": n} for n in names[1:-1]]},
            ),
        ]
    return objects
