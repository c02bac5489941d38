"""How noisy a channel is, told by its own samples."""

from __future__ import annotations

import numpy as np

from waxstudy.dataset.limits import FEWEST_CHANGES, FINE_CHANGE, OFTEN_CHANGED, RARE_CHANGES, WIDEST_BAND
from waxstudy.dataset.resolution import step
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray

ON = 0.5  # of full scale
STROKES = ("displacement", "flow_L_h")  # that move for minutes and rest for hours


def measured(values: FloatArray) -> FloatArray:
    return values[np.isfinite(values)]


def estimated(name: str, values: FloatArray) -> float:
    """Return a robust standard deviation of white noise, of samples that do not rest at the end of a scale."""
    known = measured(values)
    if name in ("control_output", "heating_signal", "setpoint_C", "solar_gain_W", "internal_gain_W") or len(known) < 10:
        return 0.0
    rounding = left_out(name, known)
    if name == "displacement":
        return max(_resting_noise(known), rounding)
    if name == "flow_L_h":
        known = known[known > ON * known.max()] if known.max() > 0 else known
    second = np.diff(known, 2) / np.sqrt(6.0)
    if len(second) < 10:
        return rounding
    spread = 1.4826 * float(np.median(np.abs(second)))
    return max(spread, rounding)


def _resting_noise(known: FloatArray) -> float:
    """Return the noise of a displacement, from how far it strays from its ends while it rests there."""
    low = known[(known > 0.0) & (known < 0.08)]
    high = 1.0 - known[(known < 1.0) & (known > 0.92)]
    rest = low if len(low) >= len(high) else high
    return float(np.sqrt(np.median(rest**2)) / 0.6745) if len(rest) > 20 else 0.01


def left_out(name: str, known: FloatArray) -> float:
    """Return the standard deviation of what a logger leaves out of a channel.

    It rounds; and of an opening or a flow it may write only what has gone farther than a band from what it wrote last.
    """
    return max(of_rounding(known), of_change(known) if name in STROKES else 0.0)


def of_change(known: FloatArray) -> float:
    """Return the standard deviation of what is held between changes, 0 where small changes are written too."""
    changes = np.abs(np.diff(known))
    changes = changes[changes > 1e-9]
    if not FEWEST_CHANGES <= len(changes) <= OFTEN_CHANGED * len(known):
        return 0.0
    band, finest = float(np.quantile(changes, RARE_CHANGES, method="lower")), step(known, FEWEST_CHANGES)
    is_band = FINE_CHANGE * finest < band <= WIDEST_BAND * float(np.ptp(known))
    return band / float(np.sqrt(3.0)) if finest and is_band else 0.0


def of_rounding(known: FloatArray) -> float:
    """Return the standard deviation of rounding, 0 where no step shows."""
    return step(known) / float(np.sqrt(12.0))


def snapped(opening: FloatArray, noise: float) -> FloatArray:
    """Return a displacement that rests at its ends where noise alone keeps it from them.

    A probe that shows 0 at least once in a few samples, and never far from it, rests there: the noise is cut off at 0.
    So does a sample beside these: the last before a move, and the first behind it.
    """
    from scipy.ndimage import maximum_filter1d, minimum_filter1d, uniform_filter1d

    out = np.array(opening, dtype=float)
    for end in (0.0, 1.0):
        away = np.abs(out - end)
        near = minimum_filter1d((away < WEIGHTS.near_rest * noise).astype(float), 3) > 0
        at_end = uniform_filter1d((near & (away <= 1e-9)).astype(float), 31)
        rests = near & (at_end >= 0.2 * uniform_filter1d(near.astype(float), 31))
        is_beside = maximum_filter1d(rests.astype(float), 3) > 0
        out[rests | is_beside & (away < WEIGHTS.beside_rest * noise)] = end
    return out
