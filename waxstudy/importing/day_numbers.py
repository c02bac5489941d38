"""Day numbers: days and parts of them since a day long ago, as spreadsheets and MATLAB count them."""

from __future__ import annotations

from typing import NamedTuple

import pandas as pd

from waxstudy.importing.limits import LONGEST_STEP_D, LOOKED_AT, MATLAB_DAYS, SPREADSHEET_DAYS


class Counting(NamedTuple):
    """A program's way to count days."""

    program: str
    days: tuple[int, int]  # between which a record lies
    day_0: pd.Timestamp
    number_0: int  # of that day


COUNTINGS = (
    Counting("a spreadsheet", SPREADSHEET_DAYS, pd.Timestamp("1899-12-30"), 0),
    Counting("MATLAB", MATLAB_DAYS, pd.Timestamp("1970-01-01"), 719_529),
)


def counting_of(written: pd.Series) -> Counting | None:
    """Return how a column counts days; None where it does not, or in steps that are rather hours or seconds."""
    first = written.dropna().iloc[:LOOKED_AT]
    if not pd.api.types.is_float_dtype(first) or len(first) < 2:
        return None
    steps = first.diff().abs()
    if not 0.0 < steps[steps > 0.0].median() <= LONGEST_STEP_D:
        return None
    return next((each for each in COUNTINGS if first.between(*each.days).all()), None)


def times_of(written: pd.Series, counting: Counting) -> pd.Series:
    """Return the times of day numbers, to a second: few programs write more digits; NaT for what is none."""
    since = pd.to_timedelta(written - counting.number_0, unit="D", errors="coerce")
    return (counting.day_0 + since).dt.round("s")
