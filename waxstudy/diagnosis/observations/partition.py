"""Which days of a record serve for what."""

from __future__ import annotations

import numpy as np

from waxstudy.diagnosis.observations.record import DAY_S, Record

FIT, SELECT, SHRINK = 0, 1, 2
BOTH = (FIT, SELECT)  # the days on which a cause is looked for
ALL = (*BOTH, SHRINK)
SHORT_DAYS = 6
LEAST_SHRINK_DAYS = 3
FIT_SHARE = 0.57  # of the cycles of a chain that are not kept back
FEWEST_CYCLES = 3


def parts_of(record: Record, days_in_turn: bool = False, holds_out: bool = True) -> np.ndarray:
    """Return the part of each sample (n,): fit, then select, then shrinkage of at least three days.

    A chain is fitted to its first heating cycles: of days without heating it could learn nothing. A room is fitted and
    judged on days in turn: what a few days tell of it would not hold in other weather. A short record has cycles, or
    days, in turn for fit and for the rest, which then serves twice.
    """
    days = len(record) * record.interval_s / DAY_S
    in_turn = np.where((record.day if days_in_turn else record.cycle) % 2 == 0, FIT, SELECT)
    if days < SHORT_DAYS or not holds_out:
        return in_turn
    at = (np.arange(len(record)) + 0.5) * record.interval_s / DAY_S
    kept = at >= days - max(LEAST_SHRINK_DAYS, 0.3 * days)
    return np.where(kept, SHRINK, in_turn if days_in_turn else _first(record, kept))


def _first(record: Record, kept: np.ndarray) -> np.ndarray:
    """Return fit for the first cycles of what is not kept back, or where there are too few, of its samples."""
    cycles = np.unique(record.cycle[~kept])
    if len(cycles) < FEWEST_CYCLES:
        return np.where(np.arange(len(record)) < FIT_SHARE * np.count_nonzero(~kept), FIT, SELECT)
    return np.where(record.cycle < cycles[round(FIT_SHARE * len(cycles))], FIT, SELECT)
