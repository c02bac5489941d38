"""The believed room in the words of room `surfaces`, which is how effects change it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from waxstudy.plugin import Belief, Choice, changed
from waxstudy_paper.room import NzebRoom, RoomDescription, SurfacesRoom, hydronics
from waxstudy_paper.room.corner import described

NO_ROOM = "no room is believed"
NOT_DESCRIBED = "this room cannot be described by surfaces"


def room_hindrance(belief: Belief) -> str:
    """Return why the believed room cannot be changed, or an empty text."""
    if belief.room is None:
        return NO_ROOM
    return "" if issubclass(belief.room.component, NzebRoom | SurfacesRoom) else NOT_DESCRIBED


def description(belief: Belief) -> RoomDescription:
    """Return the believed room as surfaces; raise `ValueError` where it cannot be described so."""
    if problem := room_hindrance(belief):
        raise ValueError(problem)
    assert belief.room is not None
    return described(belief.room)


def changed_room(belief: Belief, **parts: Any) -> Belief:
    """Return the belief with parts of the room's description changed; raise `ValueError` with a one-line reason."""
    return replace(belief, room=Choice(SurfacesRoom, changed(description(belief), **parts)))


def changed_circuit(belief: Belief, **values: float) -> Belief:
    """Return the belief with another heating circuit; raise `ValueError` with a one-line reason."""
    return changed_room(belief, circuit=changed(description(belief).circuit, **values))


def full_flow_L_h(belief: Belief) -> float:
    """Return the flow with the valve open [L/h]."""
    room = description(belief)
    return hydronics.full_flow_L_h(room.circuit, room.floor.area_m2)
