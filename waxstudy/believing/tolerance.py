"""By how much what is guessed widens what a diagnosis may change of a room.

All spreads but that of walls are chosen: of the logarithm of what a room itself says is uncertain. They join the
room's own, as squares.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from math import ceil, sqrt

MOST = 20.0  # as [dataset] allows
BY_YEAR = ("wall_U", "window_U", "floor_U")


@dataclass(frozen=True)
class Spread:
    """What a guess adds to one of the room's uncertainties."""

    key: str  # of the question
    unknown: str  # of the room
    spread: float  # standard deviation
    why: str


SPREADS = (
    Spread("floor_area_m2", "heat-loss", 0.15, "loss and floor go with different parts of a room's size"),
    Spread("height_m", "heat-loss", 0.05, "0.2 m more is 8 % of wall"),
    Spread("outer_walls", "heat-loss", 0.3, "one outer wall more or less is a third of the loss"),
    Spread("windows", "heat-loss", 0.15, "windows are a third of the loss, and twice as large or half"),
    Spread("year", "heat-loss", 0.5, "U-values fall by three from 1980 to 2010"),
    Spread("wall_U", "heat-loss", 0.15, "walls that were measured differ by 0.3 (Li et al. 2015), and are half of it"),
    Spread("window_U", "heat-loss", 0.10, "windows of a year differ by a third, and are a third of it"),
    Spread("floor_U", "heat-loss", 0.10, "floors of a year differ by a third, and are a third of it"),
    Spread("below", "heat-loss", 0.15, "a floor above a warm room loses hardly anything"),
    Spread("above", "heat-loss", 0.2, "a roof is as large as the floor"),
    Spread("ventilation", "heat-loss", 0.15, "heat recovery saves most of a quarter of the loss"),
    Spread("walls", "boards-capacity", 0.8, "masonry stores about ten times what boards do, half of it in an hour"),
    Spread("screed_mm", "floor-capacity", 0.2, "45 to 65 mm are built"),
    Spread("pipe_spacing_mm", "water-exchange", 0.3, "100 to 200 mm are built"),
    Spread("full_flow_L_h", "water-exchange", 0.4, "valves on manifolds are set from 5 to 20 L/h a m2"),
    Spread("covering", "above-pipes", 0.8, "from tiles to wood the resistance above the pipes doubles and more"),
)


@dataclass(frozen=True)
class Widened:
    """One of the room's uncertainties with the guesses in it."""

    unknown: str
    own: float
    with_guesses: float
    guesses: tuple[Spread, ...]

    @property
    def factor(self) -> float:
        return self.with_guesses / self.own


def widened(guessed: Collection[str], own: Mapping[str, float]) -> list[Widened]:
    """Return the uncertainties that guesses widen; `own`: standard deviations by name, as the room has them."""
    counted = set(guessed) if set(guessed) & set(BY_YEAR) else set(guessed) - {"year"}
    found = []
    for unknown, sd in own.items():
        guesses = tuple(each for each in SPREADS if each.unknown == unknown and each.key in counted)
        if guesses:
            found.append(Widened(unknown, sd, sqrt(sd**2 + sum(each.spread**2 for each in guesses)), guesses))
    return found


def tolerance(found: Collection[Widened]) -> float:
    """Return the one factor that covers all of them, as `room_tolerance` multiplies all spreads alike."""
    return min(MOST, ceil(10.0 * max((each.factor for each in found), default=1.0) - 1e-9) / 10.0)
