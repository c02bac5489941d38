"""Rooms: `nzeb`, the paper's own, and `surfaces`, which a study describes.

Both become a `RoomDescription`, from which one builder makes the linear room.
"""

from waxstudy_paper.room.description import RoomDescription
from waxstudy_paper.room.nzeb import NzebRoom
from waxstudy_paper.room.surfaces import SurfacesRoom

__all__ = ["NzebRoom", "RoomDescription", "SurfacesRoom"]
