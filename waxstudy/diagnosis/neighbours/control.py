"""What a room would do by its neighbours: the regressors of its air."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.diagnosis.neighbours.limits import BUSY, HARMONICS
from waxstudy.diagnosis.neighbours.noise import Fit, fitted
from waxstudy.diagnosis.neighbours.pattern import Pattern
from waxstudy.diagnosis.neighbours.series import House, RoomSeries, bridged, common, response
from waxstudy.plugin import FloatArray

# chosen: a room answers to each drive at once and later; hours
TAUS_H = {"outdoors": (4.0, 24.0), "sun": (1.0, 8.0), "own heat": (0.3, 1.0, 8.0), "neighbours": (0.0, 6.0)}


@dataclass(frozen=True)
class Control:
    """A room held against its neighbours, with the patterns found in it so far (the last regressors)."""

    house: House
    room: RoomSeries
    patterns: tuple[Pattern, ...]
    names: tuple[str, ...]
    regressors: FloatArray  # (n, p)
    fit: Fit
    healed: Mapping[str, FloatArray]  # the rooms' air without what departs in them

    def without(self, number: int) -> Control:
        """Return the room with all its patterns but one."""
        others = [each for i, each in enumerate(self.patterns) if i != number]
        return controlled(self.house, self.room, self.healed, others)

    def place(self, number: int) -> slice:
        """Return which regressors are those of a pattern."""
        before = len(self.names) + sum(len(each.taus_h) for each in self.patterns[:number])
        return slice(before, before + len(self.patterns[number].taus_h))

    def course_K(self, number: int) -> FloatArray:
        """Return what a pattern makes of the air (n,)."""
        place = self.place(number)
        return np.asarray(self.regressors[:, place] @ self.fit.coefficients[place])

    def mean_K(self, number: int) -> float:
        """Return the mean over its hours of what a pattern makes of the air."""
        inside = self.patterns[number].inside(len(self.house))
        return float(self.course_K(number)[inside].mean()) if inside.any() else 0.0

    @property
    def departure_K(self) -> FloatArray:
        """Return what all patterns make of the air (n,)."""
        return sum((self.course_K(i) for i in range(len(self.patterns))), np.zeros(len(self.house)))

    @property
    def expected_C(self) -> FloatArray:
        """What neighbours and drives say of the air (n,)."""
        return np.asarray(self.regressors[:, : len(self.names)] @ self.fit.coefficients[: len(self.names)])


def controlled(
    house: House, room: RoomSeries, healed: Mapping[str, FloatArray], patterns: Sequence[Pattern] = ()
) -> Control:
    """Return a room by its neighbours' air, `healed` (n,) of what was found in them, and by what drives it."""
    columns, known = {"middle": np.ones(len(house))}, np.ones(len(house), dtype=bool)
    for order in range(1, HARMONICS + 1):
        angle = 2.0 * np.pi * order * house.hour / 24.0
        columns |= {f"day {order} sin": np.sin(angle), f"day {order} cos": np.cos(angle)}
    for kind, name, values in _drives(house, room, healed):
        known &= np.isfinite(values)
        filled = bridged(values)
        start = float(np.mean(filled[: round(24.0 / house.step_h)]))
        columns |= {f"{name} {tau:g} h": response(filled, tau, house.step_h, start) for tau in TAUS_H[kind]}
    rows = np.column_stack([*columns.values(), *(each.shapes(house) for each in patterns)])
    fit = fitted(np.where(known, room.air_C, np.nan), rows, _regimes(house, room))
    return Control(house, room, tuple(patterns), tuple(columns), rows, fit, dict(healed))


def _drives(house: House, room: RoomSeries, healed: Mapping[str, FloatArray]) -> Iterator[tuple[str, str, FloatArray]]:
    """Yield what drives a room: its kind, its name and its course (n,)."""
    if house.outdoor_C is not None:
        yield "outdoors", "outdoors", house.outdoor_C
    for name, values in house.sun.items():
        yield "sun", f"sun {name}", values
    if room.gain_W is not None and np.nanstd(room.gain_W) > 0.0:
        yield "own heat", "own heat", room.gain_W
    yield "neighbours", "neighbours", common([healed[each.name] for each in house.rooms if each is not room])


def _regimes(house: House, room: RoomSeries) -> np.ndarray:
    """Return which hours a room is differently restless in (n,): by day, and where its own heat changes."""
    found = house.is_day.astype(int)
    if room.gain_W is not None:
        gain = bridged(room.gain_W)
        change = np.abs(np.diff(gain, prepend=gain[0]))
        busy = change > BUSY * change.max()
        after = np.concatenate((np.zeros(2, dtype=bool), busy))
        found = found + 2 * (after[2:] | after[1:-1] | after[:-2])
    return found
