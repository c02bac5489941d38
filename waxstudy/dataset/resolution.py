"""To what a channel is resolved: the distances of the different values that it shows."""

from __future__ import annotations

import numpy as np

from waxstudy.dataset.limits import FEWEST_VALUES
from waxstudy.plugin import FloatArray


def steps(known: FloatArray, fewest: int = FEWEST_VALUES) -> FloatArray:
    """Return the distances of neighbouring values, from the lowest up; none where fewer values are there."""
    values = np.unique(np.round(known, 9))
    found = np.diff(values) if len(values) >= fewest else np.zeros(0)
    return np.asarray(found[found > 1e-9])


def step(known: FloatArray, fewest: int = FEWEST_VALUES) -> float:
    """Return the smallest of these distances, 0 where there is none: what is on or off is not rounded."""
    found = steps(known, fewest)
    return float(np.min(found)) if len(found) else 0.0
