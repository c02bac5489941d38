"""What a page of traces shows: panels above each other with lines over time, no denser than a reader can see."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from waxstudy.plugin import FloatArray

# a week at a minute is whole (10,080); of more, each of 6,000 pieces keeps its lowest and highest: a screen has 4,000
# columns of pixels at most
MOST_POINTS = 12_000


@dataclass(frozen=True)
class Line:
    """Values over time; its place gives it colour and dash, the same in every panel."""

    name: str
    place: int
    known: pd.Series[float]  # by time, without what is not known
    is_dotted: bool = False  # what is asked for, not what happened


@dataclass(frozen=True)
class Panel:
    """Lines of one quantity."""

    title: str
    unit: str
    lines: Sequence[Line]


@dataclass(frozen=True)
class Traces:
    """A page: its heading, what is shown, and the panels, which share their time."""

    title: str
    summary: str
    panels: Sequence[Panel]

    @property
    def longest(self) -> int:
        """Samples of the longest line."""
        return max(len(line.known) for panel in self.panels for line in panel.lines)


def extremes(values: FloatArray, most: int = MOST_POINTS) -> NDArray[np.intp]:
    """Return the places of what a line keeps: all or, of more than `most`, the lowest and highest of each piece.

    Breaks (NaN) do not count; they and both ends are kept as well.
    """
    n = len(values)
    if n - np.isnan(values).sum() <= most:
        return np.arange(n)
    size = -(-2 * n // most)
    pieces = np.full((-(-n // size), size), np.nan)
    pieces.flat[:n] = values
    gone, first = np.isnan(pieces), size * np.arange(len(pieces))
    low = first + np.where(gone, np.inf, pieces).argmin(axis=1)
    high = first + np.where(gone, -np.inf, pieces).argmax(axis=1)
    kept = np.unique(np.concatenate([low, high, np.flatnonzero(np.isnan(values)), [0, n - 1]]))
    return kept[kept < n]
