"""A channel that switches: judged by the seconds around each measured switch in which model and record differ."""

from __future__ import annotations

from collections.abc import Sequence

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
        perturbed: Sequence[Predicted],
        more: float = 1.0,
    ) -> None:
        self.channel, self.segment, self.record, self.parts = channel, segment, record, parts
        self.measured = record.filled(channel)
        self.windows = _windows(record, channel)  # (n,) number of the measured switch that is nearest
        self.scale_s = more * self._scale_s(perturbed)  # of each of them
        self.known = ~record.is_gap(channel) & ~record.is_gap(segment.driven_by) & record.settled

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

    def _scale_s(self, perturbed: Sequence[Predicted]) -> FloatArray:
        least_s = self.record.interval_s * 12.0**-0.5
        if not perturbed:
            return np.full(self.windows.max() + 1, least_s)
        still = perturbed[0][self.channel]
        off = [self._off_s(np.abs(each[self.channel] - still)) for each in perturbed[1:]]
        own_s = np.sqrt(np.mean(np.square(off), axis=0))
        typical_s = float(np.sqrt(np.mean(np.minimum(own_s, np.quantile(own_s, 0.9)) ** 2)))
        return np.asarray(np.maximum(own_s, max(least_s, typical_s)))

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
