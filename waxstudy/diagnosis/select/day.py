"""Between which hours of the day an effect of a room promises most: a room is linear in heat, so that hours add up."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from waxstudy.plugin import FloatArray

BINS = 48  # of a day
SPANS = BINS * (BINS - 1)  # from one of them to another
DAY_H = 24.0
APART_H = 1.0  # between the hours of two spans that are both worth a closer look
TINY = 1e-12


class Span(NamedTuple):
    """Hours of the day, and the log likelihood gained by an effect that acts between them, were all straight."""

    from_h: float
    to_h: float
    gain: float

    def is_near(self, other: Span) -> bool:
        pairs = ((self.from_h, other.from_h), (self.to_h, other.to_h))
        return all(abs((one - two + 0.5 * DAY_H) % DAY_H - 0.5 * DAY_H) <= APART_H for one, two in pairs)


def parts_of_day() -> list[tuple[float, float]]:
    """Return the hours of the day in equal parts."""
    edges = np.linspace(0.0, DAY_H, BINS + 1).tolist()
    return [(start, end % DAY_H) for start, end in pairwise(edges)]


def promising(before: FloatArray, changes: FloatArray, basis: FloatArray, both_ways: bool, most: int) -> list[Span]:
    """Return the best few spans of hours, the best first, that lie apart.

    `before` (m,) is missed and free of the basis (m, k), which nuisances take; `changes` (m, BINS) are what an effect
    does that acts in one part of the day. One that does not act `both_ways` only ever takes as much as it gives.
    """
    taken = basis.T @ changes
    power = _sums(changes.T @ changes - taken.T @ taken)
    along = np.concatenate(([0.0], np.cumsum(np.tile(before @ changes, 2))))
    first = np.repeat(np.arange(BINS), BINS - 1)
    end = first + np.tile(np.arange(1, BINS), BINS)
    pull = along[end] - along[first]
    square = power[end, end] - power[first, end] - power[end, first] + power[first, first]
    gains = np.where(both_ways | (pull < 0.0), 0.5 * pull**2 / np.maximum(square, TINY), 0.0)
    chosen: list[Span] = []
    for place in np.argsort(-gains, kind="stable"):
        from_h, to_h = (float(edge[place]) * DAY_H / BINS % DAY_H for edge in (first, end))
        span = Span(from_h, to_h, float(gains[place]))
        if not any(span.is_near(other) for other in chosen):
            chosen.append(span)
        if len(chosen) == most:
            break
    return chosen


def _sums(gram: FloatArray) -> FloatArray:
    """Return sums from the beginning over two days (2 BINS + 1, 2 BINS + 1), so that spans may hold midnight."""
    found = np.zeros((2 * BINS + 1, 2 * BINS + 1))
    found[1:, 1:] = np.cumsum(np.cumsum(np.tile(gram, (2, 2)), axis=0), axis=1)
    return found
