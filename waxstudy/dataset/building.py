"""The room that a dataset tells of: in a study's words, or built as [building] says."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from waxstudy.dataset.notes import Notes
from waxstudy.plugin import Component, OutsideRoom, Parameters, Room
from waxstudy.plugin.registry import PluginError, Registry, hint, nearest, told
from waxstudy.study.check import Check
from waxstudy.study.fragment import table_of
from waxstudy.study.model import Choice
from waxstudy.study.problems import listed
from waxstudy.study.spots import RawTable, Spot, Written

T = TypeVar("T")
ROOM, BUILDING = Spot.table("room"), Spot.table("building")


def read_room(check: Check, notes: Notes) -> Choice | None:
    """Return the room of [room] or of [building]; None if there is neither."""
    room, building = check.table(ROOM), check.table(BUILDING)
    if room and building:
        check.problem(BUILDING, "there is [room] already: tell the room in one of them")
        return None
    if room:
        table = table_of(check, "room", room, ROOM)
        return check.choice("room", table) if table else None
    return _built(check, building, notes) if building else None


def _built(check: Check, values: dict[str, Any], notes: Notes) -> Choice | None:
    """Return the room that can be told in words and numbers, with the numbers given."""
    room = _chosen(check, values)
    if room is None:
        return None
    numbers = {key: value for key, value in values.items() if key != "use"}
    parameters = noted(check, BUILDING, room, lambda: _parameters(check, room, numbers, notes))
    return Choice(room, parameters) if parameters else None


def noted(check: Check, spot: Spot, room: type[Component], build: Callable[[], T]) -> T | None:
    """Return what a room makes; note what it refuses, and faults of its plugin."""
    try:
        with told(f"room '{room.name}'", ValueError):
            return build()
    except ValueError as error:
        check.problem(spot, str(error))
    except PluginError as error:
        check.problem(spot, str(error), of_plugin=True)
    return None


def _chosen(check: Check, values: dict[str, Any]) -> type[Room] | None:
    """Return the room that is named, or the only one that can be told so."""
    rooms = describable(check.registry)
    if not rooms:
        check.problem(BUILDING, "no room is installed that can be told in words and numbers", allowed="give [room]")
    elif "use" in values:
        name = str(values["use"])
        if name in rooms:
            return rooms[name]
        near, allowed = nearest(name, rooms), f"rooms that can: {listed(rooms)}"
        wrong = "no room of this name can be told in words and numbers"
        check.problem(BUILDING.at("use"), wrong, value=values["use"], near=near, allowed=allowed)
    elif len(rooms) > 1:
        wrong = "several rooms can be told in words and numbers, and none is named"
        check.problem(BUILDING.at("use"), wrong, allowed=f"give one of {listed(rooms)}")
    else:
        return next(iter(rooms.values()))
    return None


def _parameters(check: Check, room: type[Room], values: dict[str, Any], notes: Notes) -> Parameters | None:
    """Return the room's parameters; what is wrong with them is noted where [building] has the key, or has itself."""
    model: type[Parameters] = room.Building  # type: ignore[assignment]
    known, words = _sorted(check, model, values, notes)
    building = check.parameters(model, RawTable.of(known, BUILDING))
    if building is None:
        return None
    parameters, assumptions = room.of_building(building)
    notes.assume(f"The room is '{room.name}' with the numbers of [building].")
    for sentence in assumptions:
        notes.assume(sentence)
    if words:
        notes.assume(f"Words in [building] are for people and are not read: {', '.join(words)}.")
    written = {key: Written(value, BUILDING.at(key)) for key, value in parameters.items()}
    return check.parameters(room.Parameters, RawTable(written, BUILDING, BUILDING))


def describable(registry: Registry) -> dict[str, type[Room]]:
    """Return the rooms that take [building] by name, the fast ones only, as a diagnosis asks for many runs."""
    rooms = (entry.component for entry in registry.components.values())
    fast = (room for room in rooms if issubclass(room, Room) and not issubclass(room, OutsideRoom))
    return {room.name: room for room in fast if room.Building is not None}


def _sorted(
    check: Check, model: type[Parameters], values: dict[str, Any], notes: Notes
) -> tuple[dict[str, Any], list[str]]:
    """Return what the room knows, and the keys that only hold words; warn of numbers that it does not know."""
    known, words = {}, []
    for key, value in values.items():
        if key in model.model_fields:
            known[key] = value
        elif isinstance(value, str):
            words.append(key)
        else:
            place = f"{check.source.file}:{check.source.line(BUILDING.at(key).path)}"
            notes.warn(f"{place}: [building] {key} is not known and not read{hint(key, model.model_fields)}")
    return known, words
