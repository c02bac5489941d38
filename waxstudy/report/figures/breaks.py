"""Lines that stop where nothing is known."""

from __future__ import annotations

import numpy as np

from waxstudy.plugin import FloatArray

BREAK = 3.5  # times what usually lies between two samples: a line through more would be made up
LEVELS = 2  # values of a channel that only switches


def broken(times: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Break a line where nothing was recorded or modelled for long."""
    if len(times) < 2:
        return times, values
    steps = np.diff(times)
    breaks = 1 + np.flatnonzero(steps > BREAK * np.median(steps))
    return np.insert(times, breaks, np.nan), np.insert(values, breaks, np.nan)
