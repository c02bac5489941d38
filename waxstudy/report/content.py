"""Everything that a report says, gathered once and rendered in any format."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.plugin import Reference
from waxstudy.plugin.registry import installed
from waxstudy.report.activation import Activation, activations
from waxstudy.report.against import Against, published
from waxstudy.report.comparison import Row, comparison, member_values
from waxstudy.report.other_run import other_run
from waxstudy.report.season import Comfort, Months, by_month, comfort
from waxstudy.report.spread import Spread, spreads
from waxstudy.report.words import counted
from waxstudy.results.comfort import Reached, reached
from waxstudy.results.run import Run
from waxstudy.study.model import Study

ALIKE = 1e-6  # spread of a difference, in %, below which members have not differed at all


@dataclass(frozen=True)
class Starts:
    """Starts from a closed valve over all members and weeks of a case, and how many took over 300 s to open."""

    case: str
    starts: int
    over_300_s: int

    @property
    def share(self) -> float:
        return self.over_300_s / self.starts if self.starts else np.nan


@dataclass(frozen=True)
class Content:
    """A report: the comparison always, the rest where it was asked for."""

    run: Run
    study: Study
    members: int
    rows: Sequence[Row]
    activations: Sequence[Activation] = ()
    starts: Sequence[Starts] = ()
    against: Against | None = None
    notes: Sequence[str] = ()
    spreads: Sequence[Spread] = ()
    months: Sequence[Months] = ()
    comfort: Sequence[Comfort] = ()

    def members_told(self, week: str) -> str:
        """Return the number of members of a week, and the starts and weathers that they are."""
        weathers, starts = len(self.study.weathers(week)), self.study.ensemble.members
        told = counted(weathers * starts, "member")
        return f"{told} ({counted(starts, 'start')} in each of {weathers} weathers)" if weathers > 1 else told


def gather(run: Run, study: Study, against: str | Run | None = None) -> Content:
    """Return the content of a run's report, optionally against a registered reference, by name, or another run.

    Raises `PluginError` for a reference that is unknown or breaks its contract, `RunError` for a run whose figures
    cannot be read.
    """
    rows = comparison(run)
    members = int(run.kpis["member"].nunique())
    return Content(
        run=run,
        study=study,
        members=members,
        rows=rows,
        activations=activations(study),
        starts=starts(run),
        against=None if against is None else _against(run, rows, against),
        notes=[*_off_comfort(run, study.comfort.hours_below_per_week), *_notes(study, rows, members)],
        spreads=spreads(run),
        months=by_month(run),
        comfort=comfort(run),
    )


def _against(run: Run, rows: Sequence[Row], against: str | Run) -> Against:
    if isinstance(against, Run):
        return other_run(run, rows, against)
    reference = installed().get("reference", against)
    assert issubclass(reference, Reference)
    return published(reference, run, rows)


def starts(run: Run) -> list[Starts]:
    """Count the starts of every case that has binary starts at all."""
    found = []
    for case in dict.fromkeys(case.case for case in run.cases):
        total, slow = (
            sum(int(np.sum(member_values(run.kpis, case, week, column))) for week in run.weeks)
            for column in ("starts", "starts_over_300_s")
        )
        if total:
            found.append(Starts(case, total, slow))
    return found


def _notes(study: Study, rows: Sequence[Row], members: int) -> list[str]:
    """What the reader must know: heat that is not known, unresolved differences, a single member."""
    notes = []
    if any(np.isnan(row.heat_corrected_kWh_m2_week.mean) for row in rows):
        notes.append("the engine of this room does not say what heat it stores: corrected heat is not known")
    if members == 1:
        return [*notes, "one member per case: no spread, so no difference can be called resolved"]
    alike = [
        f"{row.case} ({row.week})" for row in rows if row.resolved and row.heat_vs_most_detailed_percent.sd < ALIKE
    ]
    if alike:
        notes.append(f"all members meet in one course, so that their interval says nothing: {', '.join(alike)}")
    weak = [f"{row.case} ({row.week})" for row in rows if row.resolved is False]
    if weak:
        told = "the" if study.drawn else members
        notes.append(f"differences that {told} members do not resolve: {', '.join(weak)}")
    return notes


def _off_comfort(run: Run, target_h: float) -> list[str]:
    """Why a case is not at equal comfort, or only by a very large shift."""
    told = (each.warning(target_h) or _jumped(each, target_h) for each in reached(run.kpis))
    return [text for text in told if text]


def _jumped(at: Reached, target_h: float) -> str:
    """What is said of hours that change so fast with the setpoint that the target lies between two shifts."""
    if not at.is_off(target_h):
        return ""
    said = f"{at.case}, {at.week}: {target_h:g} h below the limit are jumped over as the setpoint shifts"
    return f"{said}; it has {at.hours:.1f} h"
