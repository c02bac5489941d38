"""Zones of a model, what heats each with water, and what stands against it as the room of a study."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.plugin import Refused
from waxstudy.plugin.registry import hint
from waxstudy_energyplus.users.file import UsersModel

VARIABLE = "ZoneHVAC:LowTemperatureRadiant:VariableFlow"
CONSTANT = "ZoneHVAC:LowTemperatureRadiant:ConstantFlow"
BASEBOARD = "ZoneHVAC:Baseboard:Convective:Water"
RADIATOR = "ZoneHVAC:Baseboard:RadiantConvective:Water"
RADIANT, BASEBOARDS = (VARIABLE, CONSTANT), (BASEBOARD, RADIATOR)
HYDRONIC = (*RADIANT, *BASEBOARDS)
ACTUATORS = {VARIABLE: "Hydronic Low Temp Radiant", CONSTANT: "Constant Flow Low Temp Radiant"}


@dataclass(frozen=True)
class Unit:
    """What heats a zone with water."""

    kind: str
    name: str
    fields: Mapping[str, Any]

    def __str__(self) -> str:
        return f"{self.kind} '{self.name}'"


@dataclass(frozen=True)
class Zone:
    """A zone, its units, what stands against it ("" if nothing), and what should be known."""

    name: str
    units: tuple[Unit, ...]
    others: tuple[str, ...]
    floor_area_m2: float
    against: str

    @property
    def known(self) -> str:
        return f"also served by {', '.join(self.others)}" if self.others else ""


def zones(model: UsersModel) -> list[Zone]:
    """Return the zones of a model in its order."""
    return [_zone(model, name) for name, _ in model.each("Zone")]


def unit_of(model: UsersModel, zone: str, unit: str | None) -> tuple[Zone, Unit]:
    """Return the zone and the unit that a study names; raise `Refused` for what cannot be its room."""
    every = zones(model)
    found = next((each for each in every if each.name.upper() == zone.upper()), None)
    names = [each.name for each in every]
    if found is None:
        raise Refused("room.zone", zone, f"is no zone of {model.path.name}{hint(zone, names)}; it has {_listed(names)}")
    if unit is None:
        if len(found.units) > 1:
            two = ", ".join(f"'{each.name}'" for each in found.units)
            raise Refused("room.zone", zone, f"is heated by {two}: say which by unit")
        if found.against:
            able = [each.name for each in every if not each.against]
            instead = f"; these can be the room: {_listed(able)}" if able else ""
            raise Refused("room.zone", zone, f"{found.against}{instead}")
        return found, found.units[0]
    chosen = next((each for each in found.units if each.name.upper() == unit.upper()), None)
    if chosen is None:
        raise Refused("room.unit", unit, f"does not heat {found.name}; it has {_listed([u.name for u in found.units])}")
    if against := _against(model, chosen) or _against_baseboard(model, found.name, chosen, _rest(found, chosen)):
        raise Refused("room.unit", unit, against)
    return found, chosen


def surfaces(model: UsersModel, unit: Unit) -> dict[str, float]:
    """Return the surfaces that a unit heats, with the shares of their areas; none of a baseboard."""
    if unit.kind in BASEBOARDS:
        return {}
    name = unit.fields.get("surface_name_or_radiant_surface_group_name", "")
    group = model.named("ZoneHVAC:LowTemperatureRadiant:SurfaceGroup", name)
    names = [str(name)] if group is None else [str(each["surface_name"]) for each in group[1]["surface_fractions"]]
    areas = {each: _area_m2(model, each) or 1.0 for each in names}
    return {each: area_m2 / sum(areas.values()) for each, area_m2 in areas.items()}


def of_unit(unit: Unit) -> dict[str, tuple[str, str]]:
    """Return the output variables of a unit's water, with their keys."""
    if unit.kind in RADIANT:
        names = {"water_heat_W": "Heating Rate", "supply_C": "Inlet Temperature", "return_C": "Outlet Temperature"}
        return {name: (f"Zone Radiant HVAC {what}", unit.name) for name, what in names.items()}
    nodes = {"supply_C": str(unit.fields["inlet_node_name"]), "return_C": str(unit.fields["outlet_node_name"])}
    heat = {"water_heat_W": ("Baseboard Total Heating Rate", unit.name)}
    return heat | {name: ("System Node Temperature", node) for name, node in nodes.items()}


def _rest(zone: Zone, unit: Unit) -> list[str]:
    return [*zone.others, *(str(each) for each in zone.units if each != unit)]


def _listed(names: list[str]) -> str:
    return ", ".join(names) or "none"


def _zone(model: UsersModel, name: str) -> Zone:
    equipment = list(_equipment(model, name))
    units: list[Unit] = []
    others: list[str] = []
    for kind, item in equipment:
        found = model.named(kind, item) if kind in HYDRONIC else None
        if found is None:
            others.append(f"{kind} '{item}'")
        else:
            units.append(Unit(kind, *found))
    against = "nothing in it is heated by water, as ZoneHVAC:LowTemperatureRadiant:VariableFlow does"
    if len(units) > 1:
        against = f"{len(units)} units heat it with water: say which by unit"
    elif units:
        against = _against(model, units[0]) or _against_baseboard(model, name, units[0], others)
    return Zone(name, tuple(units), tuple(others), _floor_area_m2(model, name), against)


def _equipment(model: UsersModel, zone: str) -> Iterator[tuple[str, str]]:
    """Yield kind and name of each piece of equipment on a zone's list."""
    for _, connection in model.each("ZoneHVAC:EquipmentConnections"):
        if str(connection.get("zone_name", "")).upper() != zone.upper():
            continue
        listed = model.named("ZoneHVAC:EquipmentList", connection.get("zone_conditioning_equipment_list_name", ""))
        for item in listed[1].get("equipment", []) if listed is not None else []:
            kind = str(item.get("zone_equipment_object_type", ""))
            known = {each.upper(): each for each in HYDRONIC}
            yield known.get(kind.upper(), kind), str(item.get("zone_equipment_name", ""))


def _against(model: UsersModel, unit: Unit) -> str:
    """Return what keeps a unit from being driven, "" if nothing."""
    if unit.kind in BASEBOARDS:
        return ""
    if not unit.fields.get("heating_water_inlet_node_name"):
        return f"{unit} has no hot water: it only cools"
    for name, actuator in model.each("EnergyManagementSystem:Actuator"):
        same = str(actuator.get("actuated_component_unique_name", "")).upper() == unit.name.upper()
        if same and str(actuator.get("actuated_component_type", "")).upper() == ACTUATORS[unit.kind].upper():
            return f"the model's own EnergyManagementSystem:Actuator '{name}' sets the flow of {unit} already"
    return ""


def _against_baseboard(model: UsersModel, zone: str, unit: Unit, others: list[str]) -> str:
    """Return what keeps a baseboard from being driven: it is asked for heat by the thermostat of its zone."""
    if unit.kind in RADIANT:
        return ""
    if others:
        return f"{unit} is driven through the zone's thermostat, which {', '.join(others)} would follow"
    controlled = [
        str(each.get("zone_or_zonelist_name", "")).upper() for _, each in model.each("ZoneControl:Thermostat")
    ]
    lists = (fields for name, fields in model.each("ZoneList") if name.upper() in controlled)
    within = [str(each.get("zone_name", "")).upper() for fields in lists for each in fields.get("zones", [])]
    if zone.upper() not in (*controlled, *within):
        return f"{unit} is driven through the zone's thermostat, and it has none"
    return ""


def _floor_area_m2(model: UsersModel, zone: str) -> float:
    """Return a zone's floor, 0 where the model does not give it by corners or as a number."""
    found = model.named("Zone", zone)
    given = found[1].get("floor_area") if found is not None else None
    if isinstance(given, int | float):
        return float(given)
    total_m2 = 0.0
    for kind in ("BuildingSurface:Detailed", "Floor:Detailed"):
        for name, fields in model.each(kind):
            is_floor = kind == "Floor:Detailed" or str(fields.get("surface_type", "")).upper() == "FLOOR"
            if is_floor and str(fields.get("zone_name", "")).upper() == zone.upper():
                total_m2 += _area_m2(model, name)
    return total_m2


def _area_m2(model: UsersModel, surface: str) -> float:
    """Return the area within a surface's corners, 0 where it has none."""
    kinds = ("BuildingSurface:Detailed", "Floor:Detailed", "RoofCeiling:Detailed", "Wall:Detailed")
    found = next((each for each in (model.named(kind, surface) for kind in kinds) if each is not None), None)
    corners = found[1].get("vertices", []) if found is not None else []
    points = np.array([[each[f"vertex_{axis}_coordinate"] for axis in "xyz"] for each in corners], dtype=float)
    if len(points) < 3:
        return 0.0
    return float(np.linalg.norm(np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)) / 2.0)
