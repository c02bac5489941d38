"""Counters: what they rise by in a while is a rate; they begin anew, and sometimes jump."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from waxstudy.importing.limits import BEGUN_ANEW, FEWEST_RISES, JUMP, RISING, USUAL, WHOLE
from waxstudy.plugin import FloatArray

HOUR_NS = 3_600_000_000_000


@dataclass(frozen=True)
class Rises:
    """What a counter rose by between readings (n - 1,); NaN where that is not known."""

    ns: np.ndarray  # (n,) of the readings
    amounts: FloatArray
    resets: np.ndarray  # places of readings that begin anew
    jumps: np.ndarray  # places of readings that jump, up or down
    resolution: float


def is_counter(values: FloatArray) -> bool:
    """Whether readings only rise, but for resets, and rise often."""
    steps = np.diff(values[np.isfinite(values)])
    up, down = int((steps > 0.0).sum()), int((steps < 0.0).sum())
    return up >= FEWEST_RISES and up >= RISING * (up + down)


def rises(ns: np.ndarray, values: FloatArray) -> Rises:
    """Return what a counter rose by; readings (n,) ascending in time, in any unit."""
    known = np.isfinite(values)
    ns, values = ns[known], values[known]
    amounts = np.diff(values)
    falls = amounts < 0.0
    resets = falls & (values[1:] < BEGUN_ANEW * values[:-1])
    amounts[resets] = values[1:][resets]
    rates = amounts / (np.diff(ns) / HOUR_NS)
    moving = rates[amounts > 0.0]
    usual = float(np.quantile(moving, USUAL)) if len(moving) >= FEWEST_RISES else np.inf
    jumps = (falls & ~resets) | (rates > JUMP * usual)
    amounts[jumps] = np.nan
    up = amounts[amounts > 0.0]
    places = np.flatnonzero(known)[1:]
    return Rises(ns, amounts, places[resets], places[jumps], float(up.min()) if len(up) else 0.0)


def rates_on(found: Rises, ends_ns: np.ndarray, step_ns: int, longest_ns: int) -> FloatArray:
    """Return the rate per hour in each interval (m,), NaN where it is not known all through.

    Between two readings at most `longest_ns` apart a counter is taken to rise evenly.
    """
    lasted = np.diff(found.ns)
    is_known = np.isfinite(found.amounts) & (lasted <= longest_ns)
    amount = np.concatenate(([0.0], np.cumsum(np.where(is_known, found.amounts, 0.0))))
    known = np.concatenate(([0.0], np.cumsum(np.where(is_known, lasted, 0))))
    at = [np.interp(edges, found.ns, each) for each in (amount, known) for edges in (ends_ns - step_ns, ends_ns)]
    return np.where(at[3] - at[2] > WHOLE * step_ns, (at[1] - at[0]) / (step_ns / HOUR_NS), np.nan)
