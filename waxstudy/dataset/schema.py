"""The JSON Schema of dataset.toml, for editors: what the reader knows, as far as a schema can tell."""

from __future__ import annotations

from typing import Any

from waxstudy.dataset.building import describable
from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.neighbours import AIR, GAIN, SUN, RoomTable
from waxstudy.dataset.tables import Column, DatasetTable, Nominal, Site
from waxstudy.plugin import CHAIN
from waxstudy.plugin.registry import Registry
from waxstudy.study.schema import DIALECT, Json, any_of, definitions_of, parameters, ref, table

TEXT: Json = {"type": "string"}
BASELINE = "A record of the same loop when it was healthy."
COLUMNS = "Which column of the data file each channel is, where it has another name or unit."
IMPORTED = "What `waxstudy import` decided and why; it is not read."
BELIEVED = "What `waxstudy believe` asked and was answered; only it reads that."
NEIGHBOURS = "Rooms that were measured beside each other, by name."


def dataset_schema(registry: Registry) -> Json:
    """Return the JSON Schema (draft-07) of descriptions of datasets, with the components of a registry."""
    nominal = parameters(Nominal)
    nominal["properties"] |= {kind: ref(kind) for kind in CHAIN}
    return {
        "$schema": DIALECT,
        "title": "dataset.toml of waxstudy",
        **table("A record of measured channels, and what is believed of the room that it comes from."),
        "properties": {
            "dataset": parameters(DatasetTable),
            "nominal": nominal | {"description": "The chain that is believed; empty, if nothing is."},
            "room": ref("room"),
            "building": _building(registry),
            "noise": _by_channel("Standard deviation of a channel's noise.", {"type": "number", "minimum": 0}),
            "site": parameters(Site) | {"description": "Where the room is."},
            "columns": _columns(),
            "baseline": table(BASELINE) | {"properties": {"path": TEXT | {"description": "Its folder, from here."}}},
            "neighbours": _neighbours(),
            "import": {"description": IMPORTED, "type": "object"},
            "believe": {"description": BELIEVED, "type": "object"},
        },
        "definitions": definitions_of(registry, (*CHAIN, "room")),
    }


def _by_channel(description: str, entry: Json) -> Json:
    properties = {name: {"description": f"[{channel.unit}]", **entry} for name, channel in CHANNELS.items()}
    return table(description) | {"properties": properties}


def _columns() -> Json:
    made = _by_channel(COLUMNS, _column())
    made["properties"]["time"] = TEXT | {"description": "The column of stamps."}
    return made


def _column() -> Json:
    mean = {"type": "array", "items": {"anyOf": [TEXT, {"type": "object"}]}, "minItems": 1}
    return {"anyOf": [TEXT, mean, parameters(Column)]}


def _building(registry: Registry) -> Json:
    """Return the room in numbers: keys of all rooms that can be told so; what else is a text is for people."""
    rooms = describable(registry)
    models: Any = [room.Building for room in rooms.values()]
    known = any_of([parameters(model) for model in models]).get("properties", {})
    use = {"use": {"description": "The room that reads these numbers.", "enum": list(rooms)}}
    made = {"description": "The room in numbers.", "type": "object", "properties": use | known}
    return made | {"additionalProperties": TEXT}


def _neighbours() -> Json:
    room = parameters(RoomTable)
    room["properties"] |= {name: _column() for name in (AIR, GAIN)}
    sun = {"description": "Columns of irradiance.", "type": "array", "items": TEXT}
    rooms = {"anyOf": [TEXT, {"type": "array"}, room]}
    return {"description": NEIGHBOURS, "type": "object", "properties": {SUN: sun}, "additionalProperties": rooms}
