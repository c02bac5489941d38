"""Room `surfaces`: a study describes a room of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from waxstudy.plugin import Choice, LinearRoom, ModelError, Room, Uncertainty
from waxstudy_paper.room.assembly import linear_room
from waxstudy_paper.room.corner import NzebParameters, describe, described
from waxstudy_paper.room.description import RoomDescription, states_curve
from waxstudy_paper.room.model_error import MODEL_ERRORS
from waxstudy_paper.room.uncertain import uncertainties


class SurfacesRoom(Room):
    """A room of surfaces, windows, air and one heated floor, as the study describes it."""

    name = "surfaces"
    api_version = "1.0"
    Parameters = RoomDescription
    examples = {"the room of Table 3": describe(NzebParameters()).model_dump(mode="json", exclude_none=True)}

    @classmethod
    def description(cls, p: RoomDescription) -> RoomDescription:
        """Return the parameters, which are the description."""
        return p

    @classmethod
    def of_description(cls, p: RoomDescription, description: RoomDescription) -> Choice:
        """Return the room of another description."""
        return Choice(cls, description)

    @classmethod
    def states_curve(cls, p: RoomDescription) -> bool:
        """Whether its circuit is that of Table 3, or states a heating curve."""
        return states_curve(p)

    @classmethod
    def build(cls, p: RoomDescription) -> LinearRoom:
        """Return the linear room of the description (equations: docs/room-equations.md)."""
        return linear_room(p)

    @classmethod
    def model_errors(cls, p: RoomDescription) -> Mapping[str, ModelError]:
        """Return how far the linear model is off by its form."""
        return MODEL_ERRORS

    @classmethod
    def uncertainties(cls, p: RoomDescription) -> Sequence[Uncertainty]:
        """Return what nobody knows of this room exactly."""
        return uncertainties(described, SurfacesRoom)
