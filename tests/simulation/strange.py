"""Rooms of strangers: room `nzeb` with other names, with two inputs of a role, or with a role overlooked."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from waxstudy.plugin import FloatArray, LinearRoom, Role, Room, RoomInput, WeatherRecord
from waxstudy_paper.room import NzebRoom

PARTS = (0.25, 0.75)  # of a role's input, in two


def nzeb() -> LinearRoom:
    return NzebRoom.build(NzebRoom.Parameters())


def renamed(room: LinearRoom) -> LinearRoom:
    """The same room by a stranger, who calls its inputs otherwise."""
    return replace(room, inputs=[RoomInput(f"u{n}", each.role) for n, each in enumerate(room.inputs)])


def divided(room: LinearRoom, role: Role) -> LinearRoom:
    """The same room with two inputs of a role in the place of one: two conductances, or two parts of the gains."""
    (place,) = room.places(role)
    of_matrix, of_drive = (1.0, PARTS) if role is Role.GAINS else (PARTS, 1.0)

    def split(table: FloatArray, parts: Any) -> FloatArray:
        return np.column_stack((np.delete(table, place, axis=1), table[:, [place]] * np.broadcast_to(parts, 2)))

    def drive(weather: WeatherRecord) -> tuple[FloatArray, FloatArray]:
        own, supply_C = room.drive(weather)
        return split(own, of_drive), supply_C

    kept = [each for n, each in enumerate(room.inputs) if n != place]
    matrices: dict[str, Any] = {n: split(getattr(room, n), of_matrix) for n in ("input_matrix", "feedthrough")}
    return replace(room, inputs=[*kept, RoomInput("one", role), RoomInput("other", role)], drive=drive, **matrices)


def without(room: LinearRoom, role: Role) -> LinearRoom:
    """The room whose author overlooks a role."""
    return replace(room, inputs=[replace(i, role=Role.OWN) if i.role is role else i for i in room.inputs])


class Strange(Room):
    """Room `nzeb` with other names."""

    name = "strange"
    Parameters = NzebRoom.Parameters
    made = staticmethod(renamed)

    @classmethod
    def build(cls, p: Any) -> LinearRoom:
        return cls.made(NzebRoom.build(p))


class InParts(Strange):
    """And with its gains in two parts."""

    made = staticmethod(lambda room: divided(divided(renamed(room), Role.GAINS), Role.SUPPLY_AIR))
