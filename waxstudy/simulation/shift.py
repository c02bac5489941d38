"""The setpoint shift that gives every case equal comfort, solved on the ensemble's mean hours."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy.results.comfort import LIMIT_K

TOLERANCE_H = 0.25  # half of what is asked for, +- 0.5 h
TOLERANCE_K = 2e-4  # where the curve jumps there is nothing to gain from a closer shift
FIRST_STEP_K = 0.1


@dataclass(frozen=True)
class Shift:
    """The shift found, the members' hours at it, and the local slope of the mean hours [h/K] (never positive)."""

    shift_K: float
    hours: FloatArray
    slope_h_K: float

    def single_run_shifts_K(self, target_h: float) -> FloatArray:
        """Return the shift that each member alone would have needed, to first order in its own hours."""
        if self.slope_h_K >= 0.0:
            return np.full(len(self.hours), self.shift_K)
        return self.shift_K + (target_h - self.hours) / self.slope_h_K


def solve(
    hours_at: Callable[[float], FloatArray], target_h: float, near_K: float = 0.0, step_K: float = FIRST_STEP_K
) -> Shift:
    """Find the shift at which the mean of `hours_at(shift)` (members,) is `target_h`, looking outwards from `near_K`.

    Where the target is never reached within `LIMIT_K`, or the curve jumps over it, the nearest point is returned;
    its hours tell the residual.
    """
    seen: dict[float, FloatArray] = {}

    def residual(shift_K: float) -> float:
        if shift_K not in seen:
            seen[shift_K] = hours_at(shift_K)
        off = float(np.mean(seen[shift_K])) - target_h
        return 0.0 if abs(off) <= TOLERANCE_H else off

    low, high = _bracket(residual, near_K, step_K)
    if residual(low) * residual(high) < 0.0:
        from scipy.optimize import brentq  # a study without equal comfort does without it

        brentq(residual, low, high, xtol=TOLERANCE_K)
    # among equals the last: where the curve jumps it is the one nearest to the jump
    best = min(reversed(seen), key=lambda shift_K: abs(float(np.mean(seen[shift_K])) - target_h))
    if len(seen) == 1:
        residual(best + step_K)  # a second point, for the slope
    return Shift(best, seen[best], _slope(best, {shift_K: float(np.mean(h)) for shift_K, h in seen.items()}))


def _bracket(residual: Callable[[float], float], here: float, step: float) -> tuple[float, float]:
    """Step away in growing steps until the sign changes or the limit is reached."""
    off = residual(here)
    direction = 1.0 if off > 0.0 else -1.0
    while off != 0.0 and direction * here < LIMIT_K:
        there = direction * min(LIMIT_K, direction * here + step)
        next_off = residual(there)
        if next_off * off <= 0.0:
            return min(here, there), max(here, there)
        here, off, step = there, next_off, 2.0 * step
    return here, here


def _slope(best: float, mean_hours: dict[float, float]) -> float:
    """Slope of the mean hours between the best shift and the nearest one that is far enough to tell."""
    others = [shift_K for shift_K in mean_hours if abs(shift_K - best) >= 0.01]
    if not others:
        return 0.0
    near = min(others, key=lambda shift_K: abs(shift_K - best))
    return min(0.0, (mean_hours[near] - mean_hours[best]) / (near - best))
