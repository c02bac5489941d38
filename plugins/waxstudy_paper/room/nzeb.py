"""Room `nzeb`: the corner room of the paper's Table 3, described in the words of room `surfaces`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from waxstudy.plugin import Choice, LinearRoom, ModelError, Room, Uncertainty
from waxstudy_paper.room.assembly import linear_room
from waxstudy_paper.room.building import NzebBuilding, parameters_of
from waxstudy_paper.room.corner import NzebParameters, describe, described
from waxstudy_paper.room.description import RoomDescription, states_curve
from waxstudy_paper.room.model_error import MODEL_ERRORS
from waxstudy_paper.room.panes import solar_readings
from waxstudy_paper.room.surfaces import SurfacesRoom
from waxstudy_paper.room.uncertain import uncertainties


class NzebRoom(Room):
    """The south-west corner room of the nZEB test house (Table 3), heated through its floor."""

    name = "nzeb"
    api_version = "1.0"
    Parameters = NzebParameters
    Building = NzebBuilding

    @classmethod
    def of_building(cls, building: NzebBuilding) -> tuple[Mapping[str, Any], Sequence[str]]:
        """Return the parameters of a room told in words and numbers (docs/datasets-room.md), and what was assumed."""
        return parameters_of(building)

    @classmethod
    def description(cls, p: NzebParameters) -> RoomDescription:
        """Return the room in the words of room `surfaces`; raise `ValueError` where the geometry is impossible."""
        return describe(p)

    @classmethod
    def of_description(cls, p: NzebParameters, description: RoomDescription) -> Choice:
        """Return a room `surfaces`: Table 3 has no words for most of what may be changed."""
        from waxstudy_paper.room.surfaces import SurfacesRoom

        return Choice(SurfacesRoom, description)

    @classmethod
    def states_curve(cls, p: NzebParameters) -> bool:
        """Whether its circuit is that of Table 3, or states a heating curve."""
        return states_curve(p)

    @classmethod
    def solar_readings(cls, p: NzebParameters) -> Mapping[str, float]:
        """Return the ways to mean a recorded solar gain, by the panes of this room."""
        return solar_readings(p.window_g, p.window_U_W_m2K)

    @classmethod
    def model_errors(cls, p: NzebParameters) -> Mapping[str, ModelError]:
        """Return how far the linear model is off by its form."""
        return MODEL_ERRORS

    @classmethod
    def uncertainties(cls, p: NzebParameters) -> Sequence[Uncertainty]:
        """Return what nobody knows of this room exactly; with a departure it becomes a room `surfaces`."""
        return uncertainties(described, SurfacesRoom)

    @classmethod
    def build(cls, p: NzebParameters) -> LinearRoom:
        """Return the linear room of Table 3 (equations and assumptions: docs/room-equations.md)."""
        return linear_room(describe(p))
