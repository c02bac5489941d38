"""Room `surfaces`: a study describes a room of its own."""

from __future__ import annotations

from collections.abc import Sequence

from waxstudy.plugin import LinearRoom, Room, Uncertainty
from waxstudy_paper.room.assembly import linear_room
from waxstudy_paper.room.corner import NzebParameters, describe, described
from waxstudy_paper.room.description import RoomDescription
from waxstudy_paper.room.uncertain import uncertainties


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

    @classmethod
    def uncertainties(cls, p: RoomDescription) -> Sequence[Uncertainty]:
        """Return what nobody knows of this room exactly."""
        return uncertainties(described, SurfacesRoom)
