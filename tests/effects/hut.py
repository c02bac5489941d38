"""Rooms of strangers that can be described by surfaces."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from waxstudy.plugin import Choice, LinearRoom, Parameters, Room, changed, parameter
from waxstudy_paper.room import NzebRoom, RoomDescription
from waxstudy_paper.room.assembly import linear_room

WATER_J_L_K = 4161.0


class HutParameters(Parameters):
    """What it is built of, and what flows in its floor."""

    shell: RoomDescription = parameter(
        NzebRoom.description(NzebRoom.Parameters()), unit="", description="what it is built of", source="a plan"
    )
    glycol_J_L_K: float = parameter(
        WATER_J_L_K, unit="J/(L K)", description="heat capacity of the water", source="a data sheet", gt=0, le=5000
    )


class Hut(Room):
    """A stranger's room, which is built from a description and has something beside it."""

    name = "hut"
    api_version = "1.0"
    Parameters = HutParameters

    @classmethod
    def build(cls, p: Any) -> LinearRoom:
        return replace(linear_room(p.shell), water_J_L_K=p.glycol_J_L_K)

    @classmethod
    def description(cls, p: Any) -> Any:
        return p.shell

    @classmethod
    def of_description(cls, p: Any, description: RoomDescription) -> Choice:
        return Choice(cls, changed(p, shell=description))


class Lodge(NzebRoom):
    """A stranger's room with heavier furniture than its description, inherited from `nzeb`, has."""

    name = "lodge"

    @classmethod
    def build(cls, p: Any) -> LinearRoom:
        room = NzebRoom.build(p)
        return replace(room, capacity_J_K=1.5 * room.capacity_J_K)
