"""Figures with their 95 % intervals: shares by Wilson, medians and means by resampling."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

DRAWS = 2000
RANGE = (2.5, 97.5)


@dataclass(frozen=True)
class Figure:
    """A figure of `of` cases; no number where there are none."""

    value: float | None
    low: float | None
    high: float | None
    of: int
    count: int | None = None  # of a share

    def described(self) -> dict[str, Any]:
        return asdict(self)


NOTHING = Figure(None, None, None, 0)


def share(hits: Sequence[bool]) -> Figure:
    """Return a share with its Wilson interval.

    >>> share([True] * 9 + [False]).value
    0.9
    """
    from scipy.stats import binomtest

    if not hits:
        return NOTHING
    count = sum(map(bool, hits))
    interval = binomtest(count, len(hits)).proportion_ci(method="wilson")
    return Figure(count / len(hits), float(interval.low), float(interval.high), len(hits), count)


def median(values: Sequence[float]) -> Figure:
    return _drawn(values, np.median)


def mean(values: Sequence[float]) -> Figure:
    return _drawn(values, np.mean)


def _drawn(values: Sequence[float], of: Any) -> Figure:
    """Return a figure with the interval of cases drawn again."""
    if not values:
        return NOTHING
    seen = np.asarray(values, dtype=float)
    random = np.random.default_rng(1)
    drawn = of(random.choice(seen, (DRAWS, len(seen))), axis=1)
    low, high = np.percentile(drawn, RANGE)
    return Figure(float(of(seen)), float(low), float(high), len(seen))
