"""What a season tells beside a week: heat and its differences month by month, and comfort on the heating days."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.special import stdtrit

from waxstudy.plugin import FloatArray
from waxstudy.report.comparison import CONFIDENCE, HEAT, differences_percent, member_values
from waxstudy.results.kpis import CATEGORIES_C, HEAT_OF_MONTH, IN_CATEGORY, months_of
from waxstudy.results.run import Run
from waxstudy.study.model import Ladder

COLD_SHARE = 0.01  # of the record's heat, from which on a month's difference is told: below, it is one of small numbers


@dataclass(frozen=True)
class Months:
    """Heat of a case by month (YYYY-MM), members' mean [kWh/m2], and its difference from the reference [%].

    `interval_percent` is half the 95 % interval of the whole record's difference over months like these (delete-one
    jackknife): how far it hangs on single months of the one weather. NaN for the reference and for fewer than three.
    """

    case: str
    week: str
    heat_kWh_m2: Mapping[str, float]
    difference_percent: Mapping[str, float]
    whole_percent: float
    interval_percent: float

    @property
    def total_kWh_m2(self) -> float:
        return sum(self.heat_kWh_m2.values())


@dataclass(frozen=True)
class Comfort:
    """A case on the heating days: hours a week below the limit, and shares of the time in categories."""

    case: str
    week: str
    days: float
    hours_below_per_week: float
    mae_K: float
    over_setpoint_1K_share: float
    in_category: Mapping[str, float]


def by_month(run: Run) -> list[Months]:
    """Return a row for each case and week that reaches into several months, in the order of the study."""
    return [
        _months(run, ladder, case, week, names)
        for week in run.weeks
        if (names := _names(run, week))
        for ladder in run.ladders
        for case in ladder.cases
    ]


def _names(run: Run, week: str) -> list[str]:
    rows = run.kpis[run.kpis["week"] == week].dropna(axis=1, how="all")
    return list(months_of(map(str, rows)).values())


def _months(run: Run, ladder: Ladder, case: str, week: str, names: Sequence[str]) -> Months:
    own, other = (_heat(run.kpis, each, week, names) for each in (case, ladder.reference))
    is_reference, told = case == ladder.reference, other > COLD_SHARE * other.sum()
    difference = np.where(told, 100.0 * (own - other) / np.where(told, other, 1.0), np.nan)
    return Months(
        case,
        week,
        dict(zip(names, own.tolist(), strict=True)),
        {} if is_reference else dict(zip(names, difference.tolist(), strict=True)),
        np.nan if is_reference else float(np.mean(differences_percent(run.kpis, case, ladder.reference, week, HEAT))),
        np.nan if is_reference else interval_percent(own[told], other[told]),
    )


def _heat(kpis: pd.DataFrame, case: str, week: str, names: Sequence[str]) -> FloatArray:
    columns = (HEAT_OF_MONTH.format(month=name) for name in names)
    # with several weathers a month may not be of every member's record
    return np.array([float(np.nanmean(member_values(kpis, case, week, column))) for column in columns])


def interval_percent(own: FloatArray, other: FloatArray) -> float:
    """Return half the 95 % interval of 100 (sum of own / sum of other - 1), from leaving out one month at a time."""
    count = len(own)
    if count < 3:
        return np.nan
    without = 100.0 * ((own.sum() - own) / (other.sum() - other) - 1.0)
    error = np.sqrt((count - 1) / count * np.sum((without - without.mean()) ** 2))
    return float(stdtrit(count - 1, 0.5 + CONFIDENCE / 2.0) * error)


def comfort(run: Run) -> list[Comfort]:
    """Return a row for each case and week in which comfort is counted on heating days."""
    if "counted_days" not in run.kpis:
        return []
    return [_comfort(run.kpis, case, week) for week in run.weeks for ladder in run.ladders for case in ladder.cases]


def _comfort(kpis: pd.DataFrame, case: str, week: str) -> Comfort:
    def mean(column: str) -> float:
        return float(np.mean(member_values(kpis, case, week, column)))

    return Comfort(
        case,
        week,
        days=mean("counted_days"),
        hours_below_per_week=mean("hours_below_per_week"),
        mae_K=mean("mae_K"),
        over_setpoint_1K_share=mean("over_setpoint_1K_share"),
        in_category={name: mean(IN_CATEGORY[name]) for name in CATEGORIES_C},
    )
