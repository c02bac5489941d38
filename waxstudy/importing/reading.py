"""What a source says: tables as they are written, and readings of entities; and how an import refuses."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import pandas as pd

from waxstudy.study.problems import Problem, StudyError


class Table(NamedTuple):
    """A table as it is written; its index holds the rows as the user counts them."""

    where: str  # the file, with the sheet or table of it
    frame: pd.DataFrame
    notes: tuple[str, ...] = ()  # what was left out of it


class Place(NamedTuple):
    """Where something was measured."""

    latitude: float
    longitude: float
    altitude: float  # m


@dataclass(frozen=True)
class Readings:
    """What was logged of one entity."""

    entity: str
    where: str
    times: pd.DatetimeIndex  # in UTC with its zone, or naive as the clock on the wall showed; ascending
    written: pd.Series  # as written, its index the rows of the source; missing: nothing was read from there on
    unit: str = ""  # as written, "" where it is not
    is_mean: bool = False  # of the interval that ends at its stamp, as the source says
    notes: tuple[str, ...] = field(default=())  # what was assumed of its stamps
    place: Place | None = None  # as the source says


class Logged(NamedTuple):
    """Readings as numbers, in UTC or local standard time."""

    entity: str
    where: str
    ns: np.ndarray  # (n,) int64, ascending
    values: np.ndarray  # (n,) in `unit`; NaN: nothing was read from there on
    rows: np.ndarray  # (n,) rows of the source
    unit: str
    is_words: bool
    is_mean: bool
    said: np.ndarray | None = None  # (n,) as 0 and 1, what words say among numbers, which `values` lack there
    is_of_house: bool = True  # else of a weather station, which says nothing of whether the house's logger lives


class NoStamps(StudyError):
    """A table has no column of stamps: it is none of readings."""


class Unordered(StudyError):
    """Stamps whose days may be their months."""

    forms: tuple[str, ...] = ()  # that they may have


def refusal(where: str, wrong: str, mend: str = "", *, row: Hashable = 0, key: str = "", value: str = "") -> StudyError:
    """Return the error of a source that cannot be used: where, what was seen, what to do next."""
    return StudyError([problem(where, wrong, mend, row=row, key=key, value=value)])


def problem(where: str, wrong: str, mend: str = "", *, row: Hashable = 0, key: str = "", value: str = "") -> Problem:
    line = row if isinstance(row, int) else int(str(row)) if str(row).isdigit() else 0
    return Problem(where, line, "", key, value, wrong, allowed=mend)
