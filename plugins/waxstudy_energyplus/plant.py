"""The water loop: a source at the heating curve's temperature, a pump without heat, and the floor as its only user."""

from __future__ import annotations

from waxstudy_energyplus.objects import ALWAYS, RADIANT_FLOOR, SUPPLY, Objects
from waxstudy_paper.room.description import RoomDescription
from waxstudy_paper.room.hydronics import WATER_J_L_K, full_flow_L_h

# EnergyPlus' own water near 27 C
HEAT_CAPACITY_J_KGK = 4180.0
CONDUCTIVITY_W_MK = 0.607
LAMINAR_NUSSELT = 3.66
WIDE_M = 0.2  # so wide a tube that the flow in it is laminar always

FLOOR = "ZoneHVAC:LowTemperatureRadiant:VariableFlow", RADIANT_FLOOR


def full_flow_kg_s(room: RoomDescription) -> float:
    """Return the mass flow with the valve open that carries as much heat per kelvin as in the fast room."""
    return full_flow_L_h(room.circuit, room.floor.area_m2) / 3600.0 * WATER_J_L_K / HEAT_CAPACITY_J_KGK


def plant(flow_m3_s: float) -> Objects:
    """Return the loop for a flow with the valve open."""
    yield (
        "PlantLoop",
        "water",
        {
            "fluid_type": "Water",
            "plant_equipment_operation_scheme_name": "operation",
            "loop_temperature_setpoint_node_name": "supply outlet",
            "maximum_loop_temperature": 100.0,
            "minimum_loop_temperature": 0.0,
            "maximum_loop_flow_rate": flow_m3_s,
            "plant_loop_volume": 0.0,  # water and pipes hold no heat
            "plant_side_inlet_node_name": "supply inlet",
            "plant_side_outlet_node_name": "supply outlet",
            "plant_side_branch_list_name": "supply branches",
            "demand_side_inlet_node_name": "floor inlet",
            "demand_side_outlet_node_name": "floor outlet",
            "demand_side_branch_list_name": "demand branches",
        },
    )
    yield (
        "SetpointManager:Scheduled",
        "heating curve",
        {
            "control_variable": "Temperature",
            "schedule_name": SUPPLY,
            "setpoint_node_or_nodelist_name": "supply outlet",
        },
    )
    yield from _operation()
    yield from _supply_side(flow_m3_s)
    yield "BranchList", "demand branches", {"branches": [{"branch_name": "floor branch"}]}
    yield "Branch", "floor branch", {"components": [_component(*FLOOR, "floor inlet", "floor outlet")]}


def _operation() -> Objects:
    yield (
        "PlantEquipmentOperationSchemes",
        "operation",
        {
            "control_scheme_1_object_type": "PlantEquipmentOperation:HeatingLoad",
            "control_scheme_1_name": "heat",
            "control_scheme_1_schedule_name": ALWAYS,
        },
    )
    yield (
        "PlantEquipmentOperation:HeatingLoad",
        "heat",
        {
            "load_range_1_lower_limit": 0.0,
            "load_range_1_upper_limit": 1e9,
            "range_1_equipment_list_name": "sources",
        },
    )
    source = {"equipment_object_type": "PlantComponent:TemperatureSource", "equipment_name": "source"}
    yield "PlantEquipmentList", "sources", {"equipment": [source]}


def _supply_side(flow_m3_s: float) -> Objects:
    yield (
        "PlantComponent:TemperatureSource",
        "source",
        {
            "inlet_node": "source inlet",
            "outlet_node": "supply outlet",
            "design_volume_flow_rate": flow_m3_s,
            "temperature_specification_type": "Scheduled",
            "source_temperature_schedule_name": SUPPLY,
        },
    )
    yield (
        "Pump:VariableSpeed",
        "pump",
        {
            "inlet_node_name": "supply inlet",
            "outlet_node_name": "source inlet",
            "design_maximum_flow_rate": flow_m3_s,
            "design_pump_head": 1.0,
            "design_power_consumption": flow_m3_s,
            "motor_efficiency": 1.0,
            "pump_control_type": "Intermittent",
        },
    )
    parts = [
        _component("Pump:VariableSpeed", "pump", "supply inlet", "source inlet"),
        _component("PlantComponent:TemperatureSource", "source", "source inlet", "supply outlet"),
    ]
    yield "BranchList", "supply branches", {"branches": [{"branch_name": "source branch"}]}
    yield "Branch", "source branch", {"components": parts}


def _component(kind: str, name: str, inlet: str, outlet: str) -> dict[str, str]:
    nodes = {"component_inlet_node_name": inlet, "component_outlet_node_name": outlet}
    return {"component_object_type": kind, "component_name": name, **nodes}
