"""What a room's inputs stand for: a record is applied by an input's role, never by its name."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Role(Enum):
    """What an input of a room is, and with it its unit; several inputs may be the same."""

    SUN = "solar gains"  # W/m2 on a facade
    GAINS = "internal gains"  # W
    OUTDOOR = "outdoor air"  # C
    SUPPLY_AIR = "supply air"  # C, what ventilation brings
    NEIGHBOUR = "neighbour"  # C, a room beside it
    SKY = "sky"  # C, what surfaces outside radiate to
    OWN = "own"  # what no record could know, such as the ground's temperature: always as the room's `drive` gives it


@dataclass(frozen=True)
class RoomInput:
    """An input of a room; the name is for people alone."""

    name: str
    role: Role
