"""Which days of a record parameters are fitted to, and which are held out to see how far the gap shrinks."""

from __future__ import annotations

import numpy as np

from waxstudy.diagnosis.observations.record import DAY_S, Record

FIT, HELD_OUT = 0, 1
ALL = (FIT, HELD_OUT)
SHORT_DAYS = 6
LEAST_HELD_DAYS = 3
HELD_SHARE = 0.3


def parts_of(record: Record) -> np.ndarray:
    """Return the part of each sample (n,): the last 30 %, at least three days, are held out; of a short record none."""
    days = len(record) * record.interval_s / DAY_S
    if days < SHORT_DAYS:
        return np.full(len(record), FIT)
    at = (np.arange(len(record)) + 0.5) * record.interval_s / DAY_S
    return np.where(at >= days - max(LEAST_HELD_DAYS, HELD_SHARE * days), HELD_OUT, FIT)
