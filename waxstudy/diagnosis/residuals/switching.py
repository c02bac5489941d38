"""A channel that switches: judged by the seconds around each measured switch in which model and record differ."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Residual
from waxstudy.diagnosis.model.room_response import Predicted
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.observations.record import CONTINUOUS, OUTPUT, Record
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray

SOFT = 3.0  # standard deviations beyond which an error of a switch counts straight


class Past(NamedTuple):
    """How far a thermostat's reading goes on past a switch, from one sample up to another."""

    reading_K: float = 0.0
    begin: int = 0
    end: int = 0


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
        edges = np.flatnonzero(np.diff(self.measured) != 0) + 1
        self.is_by_switch = len(edges) > 1
        # (n,) number of the measured switch that is nearest, of the day where there are fewer than two
        self.windows = _nearest(edges, len(record)) if self.is_by_switch else record.day - record.day[0]
        self._moved_s: list[FloatArray] = []  # how far each draw of noise moves each switch
        self._noise_past_K = 0.0
        self.known = ~record.is_gap(channel) & ~record.is_gap(segment.driven_by) & record.settled

    @property
    def is_moved(self) -> bool:
        """Whether noise of the drive counts."""
        return True

    def see(self, moved: Predicted) -> None:
        """Take one draw more of what noise of the drive does."""
        assert self.still
        still = self.still[self.channel]
        self._moved_s.append(self._off_s(np.abs(moved[self.channel] - still)))
        if self.reads:
            pasts_K = [each.reading_K for each in self._past(moved[self.channel], still)]
            self._noise_past_K = max([self._noise_past_K, *pasts_K])

    @cached_property
    def scale_s(self) -> FloatArray:
        """Standard deviation of what each measured switch is missed by with nothing amiss (switches,).

        As a root mean square over draws of noise, and none is surer than most.
        """
        own_s = np.sqrt(np.mean(self.moved_s**2, axis=0))
        return np.asarray(self.more * np.maximum(own_s, max(self.least_s, float(np.median(own_s)))))

    @property
    def draws(self) -> int:
        return len(self._moved_s)

    @property
    def moved_s(self) -> FloatArray:
        """How far each draw of noise moves each measured switch (draws, switches)."""
        return np.array(self._moved_s) if self._moved_s else np.zeros((1, self.windows.max() + 1))

    @property
    def least_s(self) -> float:
        """How far sampling alone moves a switch."""
        return float(self.record.interval_s * 12.0**-0.5)

    @property
    def typical_s(self) -> float:
        """How far noise moves switches as a root mean square, with its exceptions: the floor."""
        return self.more * max(self.least_s, float(np.sqrt(np.mean(self.moved_s**2))))

    @property
    def reads(self) -> str:
        """The channel that tells what a thermostat reads, "" of what is switched otherwise."""
        if self.channel != OUTPUT:
            return ""
        names = ("sensor_temperature_C", self.segment.driven_by)
        return next((name for name in names if name in CONTINUOUS and self.record.has(name)), "")

    def past(self, predicted: Predicted) -> list[Past]:
        """Return where the reading goes on past where one of prediction and record switched alone."""
        return list(self._past(predicted[self.channel], self.measured))

    @property
    def noise_past_K(self) -> float:
        """How far noise and sampling make it go on: they move a switch by hours where the reading hardly moves."""
        noise_K = self.record.noise[self.reads] * self.record.smoothed_noise
        within_K = float(np.sqrt(np.mean(np.diff(self.record.drive(self.reads)) ** 2)))  # a sample
        return max(self._noise_past_K, WEIGHTS.surely_off * noise_K, within_K)

    def _past(self, one: FloatArray, other: FloatArray) -> Iterator[Past]:
        """Yield the same of two outputs (n,), around switches that are judged.

        Where one calls for heat and the other does not, that is how far the reading falls; where one stops, how far it
        rises. That it goes the other way tells nothing: there one missed a switch by a hair.
        """
        reading = self.record.drive(self.reads)
        differs = (np.abs(one - other) > 0.5) & self.known & self.judged[self.windows]
        ends = np.flatnonzero(np.diff(np.concatenate(([False], differs, [False]))))
        for begin, end in ends.reshape(-1, 2).tolist():
            calls = [each[begin] for each in (one, other) if begin and each[begin] != each[begin - 1]]
            if len(calls) == 1:
                way = -1.0 if calls[0] > 0.5 else 1.0
                yield Past(float(np.max(way * (reading[begin:end] - reading[begin]))), begin, end)

    def residual(self, predicted: Predicted) -> Residual:
        """Return how long, around each measured switch, the prediction differs from the record [s]."""
        off_s = np.where(self.judged, self._off_s(np.abs(predicted[self.channel] - self.measured) * self.known), 0.0)
        whitened = softened(off_s / self.scale_s)
        where = self.record.cycle[self.middle], self.parts[self.middle], self.middle
        return Residual(self.channel, "s", off_s, whitened, self.judged, *where)

    def likelihood(self, off_s: FloatArray) -> float:
        """Return the logarithm of how likely switches are missed so far (switches,): by noise, or exceptions anywhere.

        How far, in seconds, is half a normal distribution; of an exception all that is nearest to it is as likely.
        """
        window_s = np.bincount(self.windows) * self.record.interval_s
        near = np.sqrt(2.0 / np.pi) / self.scale_s * np.exp(-0.5 * (off_s / self.scale_s) ** 2)
        return float(np.log(WEIGHTS.ordinary * near + (1.0 - WEIGHTS.ordinary) / window_s)[self.judged].sum())

    @cached_property
    def judged(self) -> np.ndarray:
        """Whether most of the samples that are nearest to a measured switch are known (switches,).

        Before the first switch a block is in a state that nobody knows: a thermostat keeps it within its dead band.
        """
        known = np.bincount(self.windows, weights=self.known) > 0.5 * np.bincount(self.windows)
        known[0] &= not self.is_by_switch
        return np.asarray(known)

    @cached_property
    def middle(self) -> np.ndarray:
        """Place of the sample that stands for each measured switch (switches,)."""
        ends = np.searchsorted(self.windows, np.arange(self.windows.max() + 2))
        return np.asarray((ends[:-1] + ends[1:] - 1) // 2)

    def _off_s(self, differs: FloatArray) -> FloatArray:
        return np.asarray(np.bincount(self.windows, weights=differs) * self.record.interval_s)


def softened(whitened: FloatArray) -> FloatArray:
    """Return errors whose square grows straight beyond a few standard deviations.

    That is the pseudo-Huber loss (Charbonnier et al. 1997, doi:10.1109/83.551699), one missed cycle is no verdict.
    """
    return np.asarray(SOFT * np.sqrt(2.0 * (np.sqrt(1.0 + (whitened / SOFT) ** 2) - 1.0)))


def _nearest(edges: np.ndarray, count: int) -> np.ndarray:
    middles = (edges[1:] + edges[:-1]) // 2
    return np.searchsorted(middles, np.arange(count), side="right")
