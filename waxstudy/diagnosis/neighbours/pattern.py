"""Times at which a room departs, and the course that its air takes then."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from waxstudy.diagnosis.neighbours.series import House, response
from waxstudy.plugin import FloatArray


@dataclass(frozen=True)
class Pattern:
    """Spans in steps, from and to, in which something acts on a room that answers with one or two time constants.

    Two, as a room has at least two stores, and a thermostat that sees to it.
    """

    spans: tuple[tuple[int, int], ...]
    taus_h: tuple[float, ...]

    def shapes(self, house: House) -> FloatArray:
        """Return the course of the air for each time constant (n, k), for 1 K that it would come to in the end."""
        drive = self.inside(len(house)).astype(float)
        return np.column_stack([response(drive, tau_h, house.step_h) for tau_h in self.taus_h])

    def inside(self, count: int) -> np.ndarray:
        """Return whether a step (count,) is in one of the spans."""
        found = np.zeros(count, dtype=bool)
        for begin, end in self.spans:
            found[max(0, begin) : max(0, end)] = True
        return found

    def moved(self, begin: int, end: int) -> Pattern:
        """Return the pattern with all spans beginning and ending so many steps later."""
        return replace(self, spans=tuple((each[0] + begin, each[1] + end) for each in self.spans))

    def overlaps(self, other: Pattern, count: int) -> bool:
        return bool((self.inside(count) & other.inside(count)).any())


@dataclass(frozen=True)
class Scored:
    """A pattern of one time constant, its size [K] in the end, and twice the log likelihood that it gains."""

    pattern: Pattern
    size_K: float
    score: float
