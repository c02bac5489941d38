"""Hours of the day, as effects act in them and as people read them."""

from __future__ import annotations

import numpy as np

from waxstudy.plugin.contracts import FloatArray
from waxstudy.plugin.effect import Inputs

DAY_H = 24.0


def open_h(from_h: float, to_h: float) -> float:
    """Return the hours of a day between two hours of it; none where they are the same.

    >>> open_h(22.0, 6.0), open_h(5.0, 5.0), open_h(0.0, 24.0)
    (8.0, 0.0, 24.0)
    """
    return DAY_H if to_h - from_h >= DAY_H else (to_h - from_h) % DAY_H


def open_share(inputs: Inputs, from_h: float, to_h: float) -> FloatArray:
    """Return the share of each interval of a record between two hours of the day (n,); none where they are the same."""
    half_h, length_h = inputs.interval_s / 7200.0, open_h(from_h, to_h)
    # hours since it was opened, at the middle of an interval; the window of the day before and after reach over it
    since_h = (inputs.hour - from_h) % DAY_H
    overlap_h = np.zeros(len(since_h))
    for day_h in (-DAY_H, 0.0, DAY_H):
        begin, end = since_h + day_h - half_h, since_h + day_h + half_h
        overlap_h += np.clip(np.minimum(end, length_h) - np.maximum(begin, 0.0), 0.0, None)
    return np.asarray(overlap_h / (2.0 * half_h))


def clock(hour: float) -> str:
    """Return an hour of the day as on a clock.

    >>> clock(7.5)
    '07:30'
    """
    minutes = round(hour * 60.0)
    return f"{minutes // 60 % 24:02d}:{minutes % 60:02d}"
