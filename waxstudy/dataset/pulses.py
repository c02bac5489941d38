"""A flow that was counted in pulses: each tells what flowed since the one before it, not when."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pandas as pd

from waxstudy.dataset.limits import (
    FEWEST_SPANS,
    MOST_PULSES,
    NEVER_OPEN,
    ODD_PULSES,
    OPEN_FOR_PULSES,
    OPEN_SPANS,
    PEAK_FLOW,
    PULSES_CHANGE,
    SPAN_SAMPLES,
    WHOLE_PULSE,
    WHOLLY_OPEN,
)
from waxstudy.plugin import FloatArray

# standard deviation [samples] of the time between two pulses, each of which came anywhere within its sample
UNSURE_SAMPLES = 6.0**-0.5


@dataclass(frozen=True)
class Pulses:
    """Spans from pulse to pulse, so long that it matters little when within its sample a pulse came."""

    pulse_L_h: float  # flow that one pulse in a sample is written as
    usual_L_h: float  # flow with the valve open
    span: np.ndarray  # number of the span of each sample (n,); the first and last may lack a pulse at one end
    ends: np.ndarray  # samples (n,) with which a span ends that has a pulse at both ends, and no sample lost

    @classmethod
    def of(cls, flow: FloatArray, opening: FloatArray) -> Pulses | None:
        """Return the spans of a flow [L/h] (n,) through a valve that is so far open (n,).

        None where the flow was not counted in pulses, or in too few of them.
        """
        one_L_h = pulse_L_h(flow, opening)
        if not one_L_h:
            return None
        has_end = np.zeros(len(flow), dtype=bool)
        last = -SPAN_SAMPLES
        for at in np.flatnonzero(flow > 0.0).tolist():
            if at - last >= SPAN_SAMPLES:
                has_end[at], last = True, at
        span: np.ndarray = np.concatenate(([0], np.cumsum(has_end)[:-1]))
        lost = _sums(span, ~np.isfinite(flow)) > 0
        ends = has_end & (span > 0) & ~lost
        if ends.sum() < FEWEST_SPANS:
            return None
        usual_L_h = _usual_L_h(flow, opening, span, ends)
        return cls(one_L_h, usual_L_h, span, ends) if usual_L_h > 0.0 else None

    @cached_property
    def samples(self) -> np.ndarray:
        """How many samples the span of each sample has (n,)."""
        return self.sums(np.ones(len(self.span)))

    @cached_property
    def noise(self) -> FloatArray:
        """Standard deviation of the mean flow over the span of each sample (n,): nobody knows when a pulse came.

        Where several come in a sample, no more than one of them may belong to the next.
        """
        return np.asarray(min(self.usual_L_h, self.pulse_L_h) * UNSURE_SAMPLES / self.samples)

    def sums(self, values: FloatArray) -> FloatArray:
        """Return the sum of values (n,) over the span of each sample."""
        return _sums(self.span, values)

    def means(self, values: FloatArray) -> FloatArray:
        """Return the mean of each row of values (..., n) over the span of each sample."""
        rows = values.reshape(-1, values.shape[-1])
        return np.array([self.sums(row) / self.samples for row in rows]).reshape(values.shape)

    def spread(self, flow: FloatArray, opening: FloatArray) -> FloatArray:
        """Return a counted flow (n,) as what flowed between pulses, shared out by how far a valve is open (n,).

        What would be more than the open valve lets through flowed all over its span. Half of the first pulse is taken
        to have flowed before the record, and half of one more behind the last pulse. NaN where samples are missing.
        """
        known = np.isfinite(flow)
        weight = np.where(known, opening, 0.0)
        weight = np.where(self.sums(weight) > 0.0, weight, known)
        flowed, half = self.sums(np.where(known, flow, 0.0)), 0.5 * self.pulse_L_h
        flowed = np.where(self.span == 0, np.maximum(flowed - half, 0.0), flowed)
        is_open_ended = (self.span == self.span[-1]) & (not flow[-1] > 0.0)
        flowed += np.where(is_open_ended, np.minimum(half, self.usual_L_h * self.sums(weight)), 0.0)
        found = flowed * weight / np.maximum(self.sums(weight), 1e-9)
        most = PEAK_FLOW * self.usual_L_h
        rest = self.sums(np.maximum(found - most, 0.0)) / np.maximum(self.sums(known), 1.0)
        return np.where(known, np.minimum(found, most) + rest, np.nan)


def _sums(span: np.ndarray, values: np.ndarray) -> FloatArray:
    return np.asarray(np.bincount(span, values)[span])


def _usual_L_h(flow: FloatArray, opening: FloatArray, span: np.ndarray, ends: np.ndarray) -> float:
    """Return the mean flow [L/h] with the valve open: of spans without a pause, else of all that flowed."""
    is_open = opening > OPEN_FOR_PULSES * np.max(opening)
    samples, open_ = _sums(span, np.ones(len(span))), _sums(span, is_open)
    # a span that lost a sample has no end, and does not count
    volume = _sums(span, np.where(np.isfinite(flow), flow, 0.0))
    whole = ends & (open_ >= WHOLLY_OPEN * samples)
    if whole.sum() >= OPEN_SPANS:
        return float(volume[whole].sum() / samples[whole].sum())
    return float(volume[ends].sum() / max(1.0, float(open_[ends].sum())))


def pulses_of(values: pd.DataFrame) -> Pulses | None:
    """Return the pulses in which the flow of a record (a column per channel) was counted, None where it was not."""
    flow, told_by = np.asarray(values["flow_L_h"], dtype=float), opening_channel(values)
    opening = values[told_by].ffill().bfill().to_numpy(dtype=float) if told_by else np.ones(len(flow))
    return Pulses.of(flow, opening)


def opening_channel(values: Mapping[str, Any] | pd.DataFrame) -> str:
    """Return the channel that tells when water may flow: how far a valve is open, else what its motor is told.

    "" where no such channel is there, or none ever opens. An output that runs on tells nothing of when.
    """
    for name in ("displacement", "heating_signal", "control_output"):
        column = np.asarray(values[name], dtype=float) if name in values else np.zeros(1)
        switches = name != "control_output" or bool(np.isin(column[np.isfinite(column)], (0.0, 1.0)).all())
        if switches and np.nanmax(column, initial=0.0) > NEVER_OPEN:
            return name
    return ""


def pulse_L_h(flow: FloatArray, opening: FloatArray) -> float:
    """Return the flow that one pulse in a sample is written as, 0 where flow (n,) was not counted so.

    Nearly every value is a small whole number of pulses, and while the valve is open it changes from sample to sample,
    more often than once each time that it opens.
    """
    flows = flow[flow > 0.0]
    if not len(flows) or np.nanmin(flow) < 0.0:
        return 0.0
    one_L_h = _common_step(flows)
    if not one_L_h:
        return 0.0
    is_open = opening > OPEN_FOR_PULSES * np.max(opening)
    pairs = is_open[1:] & is_open[:-1] & ((flow[1:] > 0.0) | (flow[:-1] > 0.0)) & np.isfinite(np.diff(flow))
    opened = np.count_nonzero(is_open[1:] & ~is_open[:-1]) + 1
    changes = np.count_nonzero(np.abs(np.diff(flow)[pairs]) > 0.5 * one_L_h) - opened
    return one_L_h if changes > PULSES_CHANGE * np.count_nonzero(pairs) else 0.0


def _common_step(flows: FloatArray) -> float:
    """Return the largest flow [L/h] of which nearly all others (n,) are whole multiples, few of them; 0 without one."""
    most = float(np.quantile(flows, 1.0 - ODD_PULSES, method="higher"))
    for step in (most / count for count in range(1, MOST_PULSES + 1)):
        for _ in range(2):  # the largest flow has noise on top: what is counted most often tells the step best
            step = float(np.median(flows / np.maximum(np.round(flows / step), 1.0)))
        if np.mean(np.abs(flows / step - np.round(flows / step)) > WHOLE_PULSE) <= ODD_PULSES:
            return step
    return 0.0
