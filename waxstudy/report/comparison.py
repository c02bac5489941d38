"""The comparison in the style of Table 5: every case against the reference of its ladder, with its spread."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.special import stdtrit

from waxstudy.plugin import FloatArray
from waxstudy.report.split import Split
from waxstudy.report.table import Column
from waxstudy.report.words import with_spread
from waxstudy.results.kpis import WEATHER
from waxstudy.results.run import Run
from waxstudy.study.model import Ladder, Study

CONFIDENCE = 0.95


@dataclass(frozen=True)
class Estimate:
    """Mean over the ensemble, standard deviation of single runs, 95 % interval of the mean (NaN with one member).

    `runs` is of how many independent single runs the mean is worth, NaN where that is the number of members.
    """

    mean: float
    sd: float
    low: float
    high: float
    runs: float = np.nan

    @property
    def excludes_zero(self) -> bool:
        return bool(self.low > 0.0 or self.high < 0.0)

    @property
    def resolved(self) -> bool | None:
        """Whether that interval excludes zero; None without a spread."""
        return None if np.isnan(self.low) else self.excludes_zero

    @property
    def half_width(self) -> float:
        """Half of it."""
        return (self.high - self.low) / 2.0

    def __format__(self, form: str) -> str:
        """Mean and standard deviation, each as the form says."""
        return with_spread(self.mean, self.sd, form)


def estimate(values: FloatArray, error: float = 0.0) -> Estimate:
    """Return the estimate from one value per member (members,) or (weathers, starts); all NaN where one value is.

    The interval (Student's t) is wider by an error that all members have in common.
    """
    mean = float(np.mean(values))
    if values.size < 2:
        return Estimate(mean, np.nan, np.nan, np.nan)
    if values.ndim == 2:
        split = Split.of(values)
        half = float(stdtrit(split.freedom, 0.5 + CONFIDENCE / 2.0)) * split.mean_error + error
        return Estimate(mean, split.sd, float(mean - half), float(mean + half), split.runs)
    sd, n = float(np.std(values, ddof=1)), len(values)
    half = float(stdtrit(n - 1, 0.5 + CONFIDENCE / 2.0)) * sd / np.sqrt(n) + error
    return Estimate(mean, sd, float(mean - half), float(mean + half))


def unpaired_interval(a: Estimate, n: int, b: Estimate, m: int) -> tuple[float, float]:
    """Return the 95 % interval of the difference a - b of two means (Welch's t); NaN where one is of a single member.

    Unequal spreads and numbers of members n and m are allowed; degrees of freedom after Welch and Satterthwaite.
    Members that share their weather count as what their mean is worth. Where neither spreads, both ends are the
    difference itself.
    """
    if n < 2 or m < 2:
        return np.nan, np.nan
    of_n, of_m = (count if np.isnan(each.runs) else each.runs for each, count in ((a, n), (b, m)))
    own, other = a.sd**2 / of_n, b.sd**2 / of_m
    difference, variance = a.mean - b.mean, own + other
    if variance == 0.0:
        return difference, difference
    freedom = variance**2 / (own**2 / max(of_n - 1.0, 1.0) + other**2 / max(of_m - 1.0, 1.0))
    half = float(stdtrit(freedom, 0.5 + CONFIDENCE / 2.0)) * float(np.sqrt(variance))
    return difference - half, difference + half


@dataclass(frozen=True)
class Row:
    """One case in one week.

    `setpoint_shift_K` is the shift that all members share, with the spread of single runs' own shifts around it.
    `heat_vs_most_detailed_percent` is against the ladder's reference, paired by member; `resolved` says whether its
    interval excludes zero, None for the reference and where a member's reference has no heat. `single_run_share` is
    the share of single runs that differ the way the mean does. Corrected heat is less what the room holds more of it
    at the end of the week; NaN where that is not known.
    """

    ladder: str
    case: str
    week: str
    setpoint_shift_K: Estimate
    mae_K: Estimate
    heat_kWh_m2_week: Estimate
    heat_vs_most_detailed_percent: Estimate
    cycles_per_week: Estimate
    hours_below_per_week: Estimate
    resolved: bool | None
    single_run_share: float
    heat_corrected_kWh_m2_week: Estimate
    heat_corrected_vs_most_detailed_percent: Estimate
    corrected_resolved: bool | None
    corrected_single_run_share: float


HEAT, CORRECTED = "heat_kWh_m2_week", "heat_corrected_kWh_m2_week"
DIFFERENCE, CORRECTED_DIFFERENCE = "heat_vs_most_detailed_percent", "heat_corrected_vs_most_detailed_percent"
FIGURES: Sequence[Column[Row]] = (  # of Table 5
    Column("setpoint_shift_K", heading="shift", unit="K", form=".2f"),
    Column("mae_K", heading="MAE", unit="K", form=".3f"),
    Column(HEAT, heading="heat", unit="kWh/m²", form=".2f"),
    Column(DIFFERENCE, lambda row: _difference(row, DIFFERENCE), ".2f", "difference", "%"),
)
CORRECTED_FIGURES: Sequence[Column[Row]] = (
    Column(CORRECTED, lambda row: _known(row, CORRECTED), ".2f", "corrected heat", "kWh/m²"),
    Column(CORRECTED_DIFFERENCE, lambda row: _known(row, CORRECTED_DIFFERENCE), ".2f", "corrected difference", "%"),
)
COLUMNS = tuple(figure.key for figure in (*FIGURES, *CORRECTED_FIGURES))
# what of a published row, whose heat is never corrected, stands beside
BESIDE = {CORRECTED: HEAT, CORRECTED_DIFFERENCE: DIFFERENCE}


def comparison(run: Run) -> list[Row]:
    """Return the rows in the order of the study: weeks, then ladders, then cases."""
    return [_row(run.kpis, ladder, case, week) for week in run.weeks for ladder in run.ladders for case in ladder.cases]


def members_by_week(run: Run) -> dict[str, int]:
    """Return how many members each week has: one may have several weathers."""
    return {str(week): int(rows["member"].nunique()) for week, rows in run.kpis.groupby("week")}


def member_values(kpis: pd.DataFrame, case: str, week: str, column: str) -> FloatArray:
    """Return one KPI of a case in a week, in the order of the members (members,).

    Where the week has several weathers, (weathers, starts).
    """
    rows = kpis[(kpis["case"] == case) & (kpis["week"] == week)].sort_values("member")
    values = rows[column].to_numpy(dtype=float)
    several = WEATHER in rows and rows[WEATHER].nunique() > 1
    return values.reshape(rows[WEATHER].nunique(), -1) if several else values


def shifted_setpoint_C(run: Run, study: Study, case: str, week: str) -> float:
    """Return the setpoint at which a case is compared [°C]."""
    return study.comfort.setpoint_C + float(member_values(run.kpis, case, week, "setpoint_shift_K").flat[0])


def differences_percent(kpis: pd.DataFrame, case: str, reference: str, week: str, column: str = HEAT) -> FloatArray:
    """Return each member's heat less the same member's of the reference case [% of that]; NaN where that is none."""
    heat, other = (member_values(kpis, name, week, column) for name in (case, reference))
    return 100.0 * (heat - other) / np.where(other > 0.0, other, np.nan)


def solver_error_percent(kpis: pd.DataFrame, case: str, reference: str, week: str) -> float:
    """Return what the search for the setpoint shifts of two cases left of their difference in heat, at most [%].

    What is left of a shift, to first order, times the heat that a kelvin takes in the long run.
    """
    left_K = 0.0
    for name in {case, reference}:
        shared, alone = (member_values(kpis, name, week, c) for c in ("setpoint_shift_K", "single_run_shift_K"))
        left_K += abs(float(np.mean(alone - shared)))
    per_K, heat = (float(np.mean(member_values(kpis, reference, week, c))) for c in ("heat_per_K_kWh_m2_week", HEAT))
    return 100.0 * left_K * per_K / heat if heat > 0.0 else np.nan


def single_run_share(differences: FloatArray) -> float:
    """Return the share of single runs that differ the way the mean does; NaN where the mean is none."""
    mean = float(np.mean(differences))
    return float(np.mean(differences * mean > 0.0)) if np.isfinite(mean) else np.nan


def resolved_by(row: Row, column: str) -> bool | None:
    """Return whether a difference is resolved by its own column: one may be known where the other is not."""
    return row.corrected_resolved if column == CORRECTED_DIFFERENCE else row.resolved


def _difference(row: Row, column: str) -> Estimate | str:
    """What a table says of a difference: none of the reference, and not known where a member of that has no heat."""
    value: Estimate = getattr(row, column)
    if np.isnan(value.mean):
        return "not known"
    return "0" if resolved_by(row, column) is None else value  # known, and yet not judged: the reference


def _known(row: Row, column: str) -> Estimate | str:
    """What a table says of corrected heat."""
    if np.isnan(row.heat_corrected_kWh_m2_week.mean):
        return "not known"
    return getattr(row, column) if column == CORRECTED else _difference(row, column)


def _row(kpis: pd.DataFrame, ladder: Ladder, case: str, week: str) -> Row:
    def of(column: str) -> Estimate:
        return estimate(member_values(kpis, case, week, column))

    shift = float(member_values(kpis, case, week, "setpoint_shift_K").flat[0])
    singles = of("single_run_shift_K")
    is_reference = case == ladder.reference
    error = solver_error_percent(kpis, case, ladder.reference, week)
    single, of_corrected = (
        differences_percent(kpis, case, ladder.reference, week, column) for column in (HEAT, CORRECTED)
    )
    difference, corrected = (estimate(values, 0.0 if is_reference else error) for values in (single, of_corrected))

    def resolved(of: Estimate) -> bool | None:
        return None if is_reference or np.isnan(of.mean) else of.excludes_zero

    return Row(
        ladder=ladder.name,
        case=case,
        week=week,
        setpoint_shift_K=Estimate(
            shift, singles.sd, shift + singles.low - singles.mean, shift + singles.high - singles.mean, singles.runs
        ),
        mae_K=of("mae_K"),
        heat_kWh_m2_week=of(HEAT),
        heat_vs_most_detailed_percent=difference,
        cycles_per_week=of("cycles_per_week"),
        hours_below_per_week=of("hours_below_per_week"),
        resolved=resolved(difference),
        single_run_share=np.nan if is_reference else single_run_share(single),
        heat_corrected_kWh_m2_week=of(CORRECTED),
        heat_corrected_vs_most_detailed_percent=corrected,
        corrected_resolved=resolved(corrected),
        corrected_single_run_share=np.nan if is_reference else single_run_share(of_corrected),
    )
