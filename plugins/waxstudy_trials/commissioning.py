"""What a commissioning engineer makes of a valve: a three-point curve fitted to its flows."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from waxstudy.plugin import FloatArray


def fitted_valve(flow: Callable[[float], float], lift: float, authority: float) -> dict[str, float]:
    """Return the curve `quick-opening` nearest to opening -> flow by least squares; lift and authority are near."""
    from scipy.optimize import least_squares

    openings = np.linspace(0.0, 1.0, 41)
    seen = np.array([flow(float(opening)) for opening in openings])

    def missed(x: FloatArray) -> FloatArray:
        h_min, h_mid, v_mid, authority = x
        low = v_mid * (openings - h_min) / (h_mid - h_min)
        high = v_mid + (1.0 - v_mid) * (openings - h_mid) / (1.0 - h_mid)
        v = np.clip(np.where(openings < h_mid, low, high), 0.0, 1.0)
        return np.asarray(v / np.sqrt(v * v * (1.0 - authority) + authority) - seen)

    bounds = ([0.0, 0.3, 0.05, 0.02], [0.28, 0.9, 0.95, 1.0])
    best = least_squares(missed, [lift, 0.45, 0.5, authority], bounds=bounds).x
    return {name: round(float(v), 4) for name, v in zip(("h_min", "h_mid", "v_mid", "authority"), best, strict=True)}
