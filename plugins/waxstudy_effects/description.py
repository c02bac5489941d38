"""The believed room in the words of room `surfaces`, which is how effects change it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from waxstudy.plugin import Belief, Choice, changed
from waxstudy_paper.room import RoomDescription, hydronics

NO_ROOM = "no room is believed"
NOT_DESCRIBED = "this room cannot be described by surfaces"


def room_hindrance(belief: Belief) -> str:
    """Return why the believed room cannot be changed, or an empty text."""
    if belief.room is None:
        return NO_ROOM
    return "" if _described(belief.room) else NOT_DESCRIBED


def description(belief: Belief) -> RoomDescription:
    """Return the believed room as surfaces; raise `ValueError` where it cannot be described so."""
    if belief.room is None:
        raise ValueError(NO_ROOM)
    if found := _described(belief.room):
        return found
    raise ValueError(NOT_DESCRIBED)


def _described(room: Choice) -> RoomDescription | None:
    component: Any = room.component
    found = component.description(room.parameters)
    return found if isinstance(found, RoomDescription) else None


def changed_room(belief: Belief, **parts: Any) -> Belief:
    """Return the belief with parts of the room's description changed; raise `ValueError` with a one-line reason."""
    other = changed(description(belief), **parts)
    assert belief.room
    component: Any = belief.room.component
    return replace(belief, room=component.of_description(belief.room.parameters, other))


def changed_circuit(belief: Belief, **values: float) -> Belief:
    """Return the belief with another heating circuit; raise `ValueError` with a one-line reason."""
    return changed_room(belief, circuit=changed(description(belief).circuit, **values))


def full_flow_L_h(belief: Belief) -> float:
    """Return the flow with the valve open [L/h]."""
    room = description(belief)
    return hydronics.full_flow_L_h(room.circuit, room.floor.area_m2)
