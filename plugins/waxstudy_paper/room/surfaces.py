"""Room `surfaces`: a study describes a room of its own."""

from __future__ import annotations

from waxstudy.plugin import LinearRoom, Room
from waxstudy_paper.room.assembly import linear_room
from waxstudy_paper.room.description import RoomDescription
from waxstudy_paper.room.nzeb import NzebParameters, describe


class SurfacesRoom(Room):
    """A room of surfaces, windows, air and one heated floor, as the study describes it."""

    name = "surfaces"
    api_version = "1.0"
    Parameters = RoomDescription
    examples = {"the room of Table 3": describe(NzebParameters()).model_dump(mode="json", exclude_none=True)}

    @classmethod
    def build(cls, p: RoomDescription) -> LinearRoom:
        """Return the linear room of the description (equations: docs/room.md)."""
        return linear_room(p)
