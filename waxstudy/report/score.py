"""A run against published figures or another run: cell by cell, and how well each column agrees."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from scipy.special import stdtrit

from waxstudy.plugin import FloatArray, PublishedRow
from waxstudy.report.comparison import (
    BESIDE,
    COLUMNS,
    CONFIDENCE,
    CORRECTED_DIFFERENCE,
    DIFFERENCE,
    Estimate,
    Row,
    resolved_by,
    unpaired_interval,
)
from waxstudy.report.words import telling, with_spread


@dataclass(frozen=True)
class Cell:
    """One figure of the other side beside ours; a published one is a single run without a spread."""

    case: str
    week: str
    column: str
    ours: Estimate
    members: int
    theirs: Estimate
    their_members: int = 1

    @property
    def difference(self) -> float:
        return self.ours.mean - self.theirs.mean

    @property
    def interval(self) -> tuple[float, float]:
        """The 95 % interval of the difference of the two means, unpaired; NaN where one has no spread."""
        return unpaired_interval(self.ours, self.members, self.theirs, self.their_members)

    def __format__(self, form: str) -> str:
        """The difference and half its interval, each as the form says; no zero is called resolved."""
        low, high = self.interval
        if self.resolved:
            form = telling(self.difference, form)
        return with_spread(self.difference, (high - low) / 2.0, form)

    @property
    def resolved(self) -> bool | None:
        """Whether that interval excludes zero; None where there is none."""
        low, high = self.interval
        return None if np.isnan(low) else bool(low > 0.0 or high < 0.0)

    @property
    def single_run_half_width(self) -> float:
        """Half the range in which 95 % of further single runs are expected (t, n - 1, with the mean's own error)."""
        if self.members < 2:
            return np.nan
        t = float(stdtrit(self.members - 1, 0.5 + CONFIDENCE / 2.0))
        return t * self.ours.sd * float(np.sqrt(1.0 + 1.0 / self.members))

    @property
    def within_single_run_range(self) -> bool | None:
        """Whether theirs lies in that range; None where one run has none."""
        half_width = self.single_run_half_width
        return None if np.isnan(half_width) else abs(self.difference) <= half_width


@dataclass(frozen=True)
class ColumnScore:
    """Agreement of one column in one week. The null model predicts the other side's median everywhere."""

    column: str
    week: str
    n: int
    rmse: float
    mean_error: float
    correlation: float
    null_rmse: float
    within_range: int | None
    mean_range_width: float


def cells(
    rows: Sequence[Row],
    theirs: Sequence[PublishedRow | Row],
    members: Mapping[str, int],
    their_members: Mapping[str, int] = MappingProxyType({}),
) -> list[Cell]:
    """Pair every figure of theirs with ours, published heat with corrected heat, too; members are by week.

    The difference of a reference case, zero by definition, is left out, and what is not known of ours.
    """
    known = {(row.case, row.week): row for row in theirs}
    return [
        Cell(
            row.case,
            row.week,
            column,
            getattr(row, column),
            members[row.week],
            _estimate(other, column),
            their_members.get(row.week, 1),
        )
        for row in rows
        if (other := known.get((row.case, row.week)))
        for column in COLUMNS
        if not (column in (DIFFERENCE, CORRECTED_DIFFERENCE) and resolved_by(row, column) is None)
        and not np.isnan(getattr(row, column).mean)
    ]


def _estimate(row: PublishedRow | Row, column: str) -> Estimate:
    value = getattr(row, column if isinstance(row, Row) else BESIDE.get(column, column))
    return value if isinstance(value, Estimate) else Estimate(value, np.nan, np.nan, np.nan)


def scores(all_cells: Sequence[Cell]) -> list[ColumnScore]:
    """Return one score per column and week."""
    keys = dict.fromkeys((cell.column, cell.week) for cell in all_cells)
    return [_score([c for c in all_cells if (c.column, c.week) == key]) for key in keys]


def _score(column: list[Cell]) -> ColumnScore:
    ours = np.array([cell.ours.mean for cell in column])
    ranges = [cell.within_single_run_range for cell in column]
    theirs = np.array([cell.theirs.mean for cell in column])
    return ColumnScore(
        column=column[0].column,
        week=column[0].week,
        n=len(column),
        rmse=_rms(ours - theirs),
        mean_error=float(np.mean(ours - theirs)),
        correlation=_correlation(ours, theirs),
        null_rmse=_rms(np.median(theirs) - theirs),
        within_range=sum(map(bool, ranges)) if None not in ranges else None,
        mean_range_width=float(np.mean([2.0 * cell.single_run_half_width for cell in column])),
    )


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _correlation(a: FloatArray, b: FloatArray) -> float:
    if len(a) < 2 or np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return np.nan
    return float(np.corrcoef(a, b)[0, 1])
