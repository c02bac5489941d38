"""Room `surfaces`: a study describes a room of its own."""

from __future__ import annotations

from waxstudy.plugin import LinearRoom, Room
from waxstudy_paper.room.assembly import linear_room
from waxstudy_paper.room.description import RoomDescription


class SurfacesRoom(Room):
    """A room of surfaces, windows, air and one heated floor, as the study describes it."""

    name = "surfaces"
    Parameters = RoomDescription

    @classmethod
    def build(cls, p: RoomDescription) -> LinearRoom:
        """Return the linear room of the description (equations: docs/room.md)."""
        return linear_room(p)
