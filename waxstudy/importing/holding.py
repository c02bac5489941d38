"""From readings at any time to a grid: what was read is held, at most for a while, and nothing is made up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from waxstudy.importing.limits import (
    COARSER,
    EVEN,
    FEWEST_TO_TELL,
    FINER,
    HELD,
    LEAST_KNOWN,
    NEARLY,
    ON_GRID,
    REGULAR,
    REPEATS,
    THRESHOLD,
)
from waxstudy.plugin import FloatArray

NS = 1_000_000_000
UNIFORM = 3.0**-0.5  # standard deviation of what lies within 1 of 0, all alike


@dataclass(frozen=True)
class Rhythm:
    """How an entity is logged."""

    usual_s: float
    is_regular: bool


@dataclass(frozen=True)
class Grid:
    """Ends of intervals (m,)."""

    ends_ns: np.ndarray
    step_ns: int


def rhythm(ns: np.ndarray, values: FloatArray) -> Rhythm:
    """Return how often an entity is logged, and whether by the clock or on change."""
    steps = np.diff(ns)
    if len(steps) < FEWEST_TO_TELL:
        return Rhythm(float(np.median(steps)) / NS if len(steps) else 0.0, False)
    usual = float(np.median(steps))
    even = float(np.mean(np.abs(steps - usual) <= EVEN * usual))
    repeats = float(np.mean(np.diff(values) == 0.0))
    return Rhythm(usual / NS, even >= NEARLY or (even >= REGULAR and repeats >= REPEATS))


def threshold(values: FloatArray, is_regular: bool) -> float:
    """Return by how much a value changes before it is logged again."""
    changes = np.abs(np.diff(values[np.isfinite(values)]))
    changes = changes[changes > 0.0]
    return float(np.quantile(changes, 0.5 if is_regular else THRESHOLD)) if len(changes) else 0.0


def on_grid(ns: np.ndarray, values: FloatArray, kind: Rhythm, grid: Grid, hold_s: float, is_mean: bool) -> FloatArray:
    """Return an entity's values at the ends of intervals, or their means, NaN where nothing is known (m,)."""
    usual_ns = kind.usual_s * NS
    if kind.is_regular and FINER * grid.step_ns <= usual_ns <= COARSER * grid.step_ns:
        return _nearest(ns, values, grid)
    limit_ns = int(HELD * usual_ns if kind.is_regular else hold_s * NS)
    off = (ns - grid.ends_ns[0]) % grid.step_ns
    lies_on = np.mean(np.minimum(off, grid.step_ns - off) < NS) >= ON_GRID
    if is_mean and not (lies_on and usual_ns >= FINER * grid.step_ns):
        # by the clock a reading is of the interval that ends at its stamp, on change it is of what comes
        return _means(ns - round(usual_ns) if kind.is_regular else ns, values, grid, limit_ns)
    place = np.searchsorted(ns, grid.ends_ns, side="right") - 1
    is_held = (place >= 0) & (grid.ends_ns - ns[place] <= limit_ns)
    return np.where(is_held, values[place], np.nan)


def silences(ns: np.ndarray, longest_s: float) -> tuple[int, float, int]:
    """Return how often nothing was logged for longer, for how long at most [s], and at which reading that began."""
    steps = np.diff(ns)
    count = int(np.sum(steps > longest_s * NS))
    place = int(np.argmax(steps)) if count else 0
    return count, float(steps[place]) / NS if count else 0.0, place


def _nearest(ns: np.ndarray, values: FloatArray, grid: Grid) -> FloatArray:
    """Return readings at the nearest places of the grid; of two, the nearer."""
    place = (ns - grid.ends_ns[0] + grid.step_ns // 2) // grid.step_ns
    off = np.abs(ns - grid.ends_ns[0] - place * grid.step_ns)
    is_within = (place >= 0) & (place < len(grid.ends_ns))
    order = np.argsort(-off[is_within], kind="stable")  # the nearest comes last, and stays
    found = np.full(len(grid.ends_ns), np.nan)
    found[place[is_within][order]] = values[is_within][order]
    return found


def _means(ns: np.ndarray, values: FloatArray, grid: Grid, limit_ns: int) -> FloatArray:
    """Return means over the intervals, of readings that are held until the next one."""
    until = np.minimum(np.append(ns[1:], ns[-1] + limit_ns), ns + limit_ns)
    lasted = np.where(np.isfinite(values), until - ns, 0)
    knots = np.column_stack([ns, until]).ravel()
    begins_ns = grid.ends_ns - grid.step_ns

    def over_intervals(amounts: FloatArray) -> FloatArray:
        whole = np.repeat(np.concatenate(([0.0], np.cumsum(amounts))), 2)[1:-1]
        return np.asarray(np.interp(grid.ends_ns, knots, whole) - np.interp(begins_ns, knots, whole))

    # what is unknown has lasted for no time: it adds to neither sum, and an interval of little else stays missing
    amounts = np.where(lasted > 0, values, 0.0) * lasted
    total, known = over_intervals(amounts), over_intervals(1.0 * lasted)
    mean = np.full(len(total), np.nan)
    return np.asarray(np.divide(total, known, out=mean, where=known >= LEAST_KNOWN * grid.step_ns))
