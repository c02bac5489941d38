"""Rooms on one coarse grid: means over half an hour, first-order responses, and what rooms have in common."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd

from waxstudy.diagnosis.neighbours.limits import DAYTIME_H, LEAST_KNOWN, SUNNY
from waxstudy.plugin import FloatArray


@dataclass(frozen=True)
class RoomSeries:
    """A room's air (n,) [C] and, where recorded, its own heat (n,) [W]; NaN where nothing is known."""

    name: str
    air_C: FloatArray
    gain_W: FloatArray | None = None
    capacity_Wh_K: float | None = None  # assumed
    samples_C: FloatArray | None = None  # the air as it was sampled


@dataclass(frozen=True)
class House:
    """All rooms and what drives them together, on steps of equal length."""

    rooms: Sequence[RoomSeries]
    outdoor_C: FloatArray | None  # (n,)
    sun: Mapping[str, FloatArray]  # (n,) by the name of its column, in its unit
    begin: pd.Timestamp  # of the first step, local standard time
    step_s: float
    per_step: int = 1  # samples

    def __len__(self) -> int:
        return len(self.rooms[0].air_C)

    @property
    def step_h(self) -> float:
        return self.step_s / 3600.0

    @cached_property
    def begins(self) -> pd.DatetimeIndex:
        """The beginning of each step."""
        return self.begin + pd.to_timedelta(np.arange(len(self)) * self.step_s, "s")

    @cached_property
    def is_day(self) -> np.ndarray:
        """Whether the sun shines at a step (n,), by the clock where it was not recorded."""
        if not self.sun:
            return np.asarray((self.hour >= DAYTIME_H[0]) & (self.hour < DAYTIME_H[1]))
        strength = [bridged(each) / max(float(np.nanmax(each)), 1.0) for each in self.sun.values()]
        return np.asarray(np.max(strength, axis=0) > SUNNY)

    @cached_property
    def days(self) -> np.ndarray:
        """The day of each step (n,), 0 on the first."""
        return np.asarray((self.begins.normalize() - self.begin.normalize()).days)

    @cached_property
    def hour(self) -> FloatArray:
        """The hour of the day in the middle of each step (n,)."""
        begins = self.begins + pd.Timedelta(0.5 * self.step_s, "s")
        return np.asarray((begins - begins.normalize()).total_seconds() / 3600.0)


def coarse(values: FloatArray, per_step: int) -> FloatArray:
    """Return the means of a channel (samples,) over steps of so many samples; the last may be shorter."""
    padded = np.full(-(-len(values) // per_step) * per_step, np.nan)
    padded[: len(values)] = values
    rows = padded.reshape(-1, per_step)
    known = np.isfinite(rows)
    enough = known.sum(axis=1) >= LEAST_KNOWN * per_step
    sums = np.where(known, rows, 0.0).sum(axis=1)
    return np.where(enough, sums / np.maximum(known.sum(axis=1), 1), np.nan)


def response(values: FloatArray, tau_h: float, step_h: float, start: float = 0.0) -> FloatArray:
    """Return what a first-order store of a time constant makes of its drive (n,): it comes to the drive's value."""
    if tau_h <= 0.0:
        return values
    from scipy.signal import lfilter  # no diagnosis of a single loop waits for it

    kept = float(np.exp(-step_h / tau_h))
    found, _ = lfilter([1.0 - kept], [1.0, -kept], values, zi=[kept * start])
    return np.asarray(found)


def bridged(values: FloatArray) -> FloatArray:
    """Return a drive with straight lines over its gaps, for the memory of responses alone."""
    known = np.isfinite(values)
    if not known.any():
        return np.zeros(len(values))
    places = np.arange(len(values))
    return np.interp(places, places[known], values[known])


def common(others: Sequence[FloatArray]) -> FloatArray:
    """Return what rooms (n,) have in common: the median of their distances from their own middle.

    A median, as an event in one of them must not move what the rest are held against.
    """
    stacked = np.array(others)
    centred = stacked - np.nanmedian(stacked, axis=1, keepdims=True)
    known = np.isfinite(centred).sum(axis=0) > 0
    found = np.full(stacked.shape[1], np.nan)
    found[known] = np.nanmedian(centred[:, known], axis=0)
    return found
