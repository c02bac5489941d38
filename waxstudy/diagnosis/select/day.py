"""Finds the hours of the day between which an effect of a room promises most.

A room is linear in heat, so that what an effect does in the parts of a day adds up.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from waxstudy.diagnosis.estimate.start_points import TINY
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray
from waxstudy.plugin.hours import DAY_H

BINS = round(WEIGHTS.parts_of_day)
SPANS = BINS * (BINS - 1)  # from the start of one of them to that of another: as many are tried, and paid for
APART_H = 1.0  # between the hours of two spans; nearer ones end at the same place


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


def promising(
    before: FloatArray, changes: FloatArray, basis: FloatArray, strengths: tuple[float, float], most: int
) -> list[Span]:
    """Return the best few spans of hours, the best first, that lie apart.

    `before` (m,) is what is missed, free of the basis (m, k) that nuisances take. `changes` (m, BINS) are what the
    effect does in each part of the day. It may act at any strength between two, as a factor on its changes.
    """
    taken = basis.T @ changes
    power = _sums(changes.T @ changes - taken.T @ taken)
    along = np.concatenate(([0.0], np.cumsum(np.tile(before @ changes, 2))))
    first = np.repeat(np.arange(BINS), BINS - 1)
    end = first + np.tile(np.arange(1, BINS), BINS)
    pull = along[end] - along[first]
    square = np.maximum(power[end, end] - power[first, end] - power[end, first] + power[first, first], TINY)
    strength = np.clip(-pull / square, *strengths)
    gains = -strength * pull - 0.5 * strength**2 * square
    spans = [
        Span(float(one) * DAY_H / BINS, float(other) * DAY_H / BINS % DAY_H, float(gain))
        for one, other, gain in zip(first, end, gains, strict=True)
        if gain > 0.0
    ]
    return apart(spans, most)


def apart(spans: list[Span], most: int) -> list[Span]:
    """Return the best few of these spans, the best first, that lie apart."""
    chosen: list[Span] = []
    for span in sorted(spans, key=lambda each: -each.gain):
        if len(chosen) == most:
            break
        if not any(span.is_near(other) for other in chosen):
            chosen.append(span)
    return chosen


def _sums(gram: FloatArray) -> FloatArray:
    """Return sums from the beginning over two days (2 BINS + 1, 2 BINS + 1), so that spans may hold midnight."""
    found = np.zeros((2 * BINS + 1, 2 * BINS + 1))
    found[1:, 1:] = np.cumsum(np.cumsum(np.tile(gram, (2, 2)), axis=0), axis=1)
    return found
