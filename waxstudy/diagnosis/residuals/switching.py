"""A channel that switches: judged by the seconds around each measured switch in which model and record differ."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Residual
from waxstudy.diagnosis.model.room_response import Predicted
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import FloatArray

SOFT = 3.0  # standard deviations beyond which an error of a switch counts straight


class Switching:
    """Seconds off around each switch, over what noise of the drive and sampling move that switch."""

    def __init__(
        self,
        channel: str,
        segment: Segment,
        record: Record,
        parts: np.ndarray,
        still: Predicted | None,
        more: float = 1.0,
    ) -> None:
        self.channel, self.segment, self.record, self.parts = channel, segment, record, parts
        self.still, self.more = still, more
        self.measured = record.filled(channel)
        self.windows = _windows(record, channel)  # (n,) number of the measured switch that is nearest
        self._squares, self._draws = np.zeros(self.windows.max() + 1), 0
        self.known = ~record.is_gap(channel) & ~record.is_gap(segment.driven_by) & record.settled

    @property
    def is_moved(self) -> bool:
        """Whether noise of the drive counts."""
        return True

    def see(self, moved: Predicted) -> None:
        """Take one draw more of what noise of the drive does."""
        assert self.still
        self._squares += self._off_s(np.abs(moved[self.channel] - self.still[self.channel])) ** 2
        self._draws += 1

    @cached_property
    def scale_s(self) -> FloatArray:
        """What each measured switch is weighed by (switches,).

        One that no draw moved may be moved yet: all of them together count as one draw more of each.
        """
        squares = (self._squares + self._squares.mean() / max(1, self._draws)) / (self._draws + 1)
        return np.asarray(self.more * np.maximum(np.sqrt(squares), self.record.interval_s * 12.0**-0.5))

    @property
    def typical_s(self) -> float:
        """How far noise alone moves a switch, typically: the floor."""
        return float(np.sqrt(np.median(self.scale_s**2)))

    def residual(self, predicted: Predicted) -> Residual:
        """Return how long, around each measured switch, the prediction differs from the record [s]."""
        record, windows = self.record, self.windows
        off_s = self._off_s(np.abs(predicted[self.channel] - self.measured) * self.known)
        count = np.bincount(windows)
        judged = np.bincount(windows, weights=self.known) > 0.5 * count
        ends = np.searchsorted(windows, np.arange(len(count) + 1))
        middle = (ends[:-1] + ends[1:] - 1) // 2
        off_s = np.where(judged, off_s, 0.0)
        whitened = softened(off_s / self.scale_s)
        return Residual(self.channel, "s", off_s, whitened, judged, record.cycle[middle], self.parts[middle], middle)

    def _off_s(self, differs: FloatArray) -> FloatArray:
        return np.asarray(np.bincount(self.windows, weights=differs) * self.record.interval_s)


def softened(whitened: FloatArray) -> FloatArray:
    """Return errors whose square grows straight beyond a few standard deviations.

    That is the pseudo-Huber loss (Charbonnier et al. 1997, doi:10.1109/83.551699), one missed cycle is no verdict.
    """
    return np.asarray(SOFT * np.sqrt(2.0 * (np.sqrt(1.0 + (whitened / SOFT) ** 2) - 1.0)))


def _windows(record: Record, channel: str) -> np.ndarray:
    values = record.filled(channel)
    edges = np.flatnonzero(np.diff(values) != 0) + 1
    if len(edges) < 2:
        return np.asarray(record.day - record.day[0])
    middles = (edges[1:] + edges[:-1]) // 2
    return np.searchsorted(middles, np.arange(len(record)), side="right")
