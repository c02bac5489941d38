"""A flow that was counted in pulses: each tells what flowed since the one before it, not when."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from waxstudy.dataset.limits import (
    MOST_PULSES,
    NEVER_OPEN,
    OPEN_FOR_PULSES,
    PULSES_CHANGE,
    RARE_PULSES,
    SPAN_SAMPLES,
    WHOLE_PULSE,
    WHOLLY_OPEN,
)
from waxstudy.plugin import FloatArray

CAME = 6.0**-0.5  # samples: standard deviation of the time between two pulses, each anywhere in its sample


@dataclass(frozen=True)
class Pulses:
    """Spans from pulse to pulse, so long that it matters little when within its sample a pulse came."""

    step_L_h: float  # flow that one pulse in a sample is written as
    span: np.ndarray  # number of the span of each sample (n,)
    ends: np.ndarray  # whether a span ends there that a pulse began (n,)

    @classmethod
    def of(cls, flow: FloatArray, is_open: FloatArray) -> Pulses | None:
        """Return the spans of a flow [L/h] (n,) through a valve that is so far open (n,).

        None where the flow was not counted in pulses, or in too few of them.
        """
        step_L_h = pulse_L_h(flow, is_open)
        if not step_L_h:
            return None
        ends = np.zeros(len(flow), dtype=bool)
        last = -SPAN_SAMPLES
        for at in np.flatnonzero(flow > 0.0).tolist():
            if at - last >= SPAN_SAMPLES:
                ends[at], last = True, at
        span: np.ndarray = np.concatenate(([0], np.cumsum(ends)[:-1]))
        lost = np.bincount(span, ~np.isfinite(flow))[span] > 0
        found = cls(step_L_h, span, ends & (span > 0) & ~lost)
        return found if found.ends.any() else None

    @cached_property
    def samples(self) -> np.ndarray:
        """How many samples the span of each sample has (n,)."""
        return np.asarray(np.bincount(self.span)[self.span])

    def sums(self, values: FloatArray) -> FloatArray:
        """Return the sum of values (n,) over the span of each sample."""
        return np.asarray(np.bincount(self.span, values)[self.span])

    def means(self, values: FloatArray) -> FloatArray:
        """Return the mean of each row of values (..., n) over the span of each sample."""
        rows = values.reshape(-1, values.shape[-1])
        return np.array([self.sums(row) / self.samples for row in rows]).reshape(values.shape)

    def spread(self, flow: FloatArray, is_open: FloatArray) -> FloatArray:
        """Return a counted flow (n,) as what flowed between pulses, shared out by how far a valve is open (n,).

        Before the first pulse and behind the last one there was less than one. NaN where samples are missing.
        """
        known = np.isfinite(flow)
        at_end = (self.span == 0) | (self.span == self.span[-1])
        flowed = np.where(at_end, 0.5 * self.step_L_h, self.sums(np.where(known, flow, 0.0)))
        weight = np.where(known, is_open, 0.0)
        weight = np.where(self.sums(weight) > 0.0, weight, known)
        whole = self.sums(weight)
        return np.where(known, flowed * weight / np.where(known, whole, 1.0), np.nan)

    def usual_L_h(self, flow: FloatArray) -> float:
        """Return the mean flow [L/h] of spans in which the valve was open throughout; `flow` as it was spread."""
        means, count = self.means(flow)[self.ends], self.samples[self.ends]
        open_ = means > WHOLLY_OPEN * np.max(means, initial=0.0)
        return float(np.average(means[open_], weights=count[open_])) if open_.any() else 0.0

    def noise(self, flow_L_h: float) -> FloatArray:
        """Return the standard deviation of each sample's mean (n,), where so much flows while pulses come."""
        return np.asarray(flow_L_h * CAME / self.samples)


def is_counted(values: Mapping[str, Any]) -> bool:
    """Whether the flow of some channels (a column each) was counted in pulses."""
    flow, told_by = np.asarray(values["flow_L_h"], dtype=float), shows_opening(values)
    opening = np.nan_to_num(np.asarray(values[told_by], dtype=float)) if told_by else np.ones(len(flow))
    return pulse_L_h(flow, opening) > 0.0


def shows_opening(values: Mapping[str, Any]) -> str:
    """Return the channel that tells when water may flow: how far a valve is open, else when its motor is told to open.

    "" where no such channel is there, or none ever opens.
    """
    channels = [name for name in ("displacement", "heating_signal") if name in values]
    return next((name for name in channels if np.nanmax(np.asarray(values[name]), initial=0.0) > NEVER_OPEN), "")


def pulse_L_h(flow: FloatArray, is_open: FloatArray) -> float:
    """Return the flow that one pulse in a sample is written as, 0 where flow was not counted so.

    Every value is a whole number of pulses, a small one, and it changes from sample to sample while the valve is open.
    """
    known = flow[np.isfinite(flow)]
    if not (known > 0.0).any() or known.min() < 0.0:
        return 0.0
    least = float(known[known > 0.0].min())
    pulses, open_ = flow / least, is_open > OPEN_FOR_PULSES * np.max(is_open)
    steady = open_[1:] & open_[:-1] & np.isfinite(np.diff(flow))
    is_whole = bool(np.all(np.abs(known / least - np.round(known / least)) <= WHOLE_PULSE))
    if not is_whole or not steady.any() or np.nanquantile(pulses[flow > 0.0], RARE_PULSES) > MOST_PULSES:
        return 0.0
    changes = float(np.mean(np.abs(np.diff(pulses)[steady]) > 0.5))
    return least if changes > PULSES_CHANGE else 0.0
