"""Everything that a report says, gathered once and rendered in any format."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from waxstudy.plugin import Finding, Reference
from waxstudy.plugin.registry import PluginError, installed, one_line, told
from waxstudy.plugin.shapes import findings_problems, rows_problems
from waxstudy.report.activation import Activation, activations
from waxstudy.report.comparison import Row, comparison, member_values
from waxstudy.report.score import Cell, ColumnScore, cells, scores
from waxstudy.results.run import Run
from waxstudy.simulation.shift import LIMIT_K
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
class Against:
    """What published figures say beside ours; `lacking` says why there are no findings."""

    name: str
    cells: Sequence[Cell]
    scores: Sequence[ColumnScore]
    findings: Sequence[Finding]
    lacking: str = ""


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
    notes: Sequence[str] = field(default=())


def gather(run: Run, study: Study, against: str | None = None) -> Content:
    """Return the content of a run's report, optionally against a registered reference.

    Raises `PluginError` for a reference that is unknown or breaks its contract.
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
        against=_against(run, rows, members, against) if against else None,
        notes=_notes(study, rows, members),
    )


def _against(run: Run, rows: Sequence[Row], members: int, name: str) -> Against:
    reference = installed().get("reference", name)
    assert issubclass(reference, Reference)
    with told(f"reference '{name}': rows failed"):
        published = list(reference.rows())
    _keeps_its_contract(name, rows_problems(published))
    paired = cells(rows, published, members)
    try:
        with told(f"reference '{name}': findings failed", ValueError):
            found = list(reference.findings(run))
    except ValueError as error:
        return Against(name, paired, scores(paired), (), lacking=one_line(str(error)))
    _keeps_its_contract(name, findings_problems(found))
    return Against(name, paired, scores(paired), found)


def _keeps_its_contract(reference: str, problems: Iterable[str]) -> None:
    for problem in problems:
        raise PluginError(f"reference '{reference}': {problem}")


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
    """What the reader must know: unsolved shifts, unresolved differences, a single member."""
    target = study.comfort.hours_below_per_week
    notes = [_residual(row, target) for row in rows if abs(row.hours_below_per_week.mean - target) > 0.5]
    if members == 1:
        return [*notes, "one member per case: no spread, so no difference can be called resolved"]
    alike = [
        f"{row.case} ({row.week})" for row in rows if row.resolved and row.heat_vs_most_detailed_percent.sd < ALIKE
    ]
    if alike:
        notes.append(f"all members meet in one course, so that their interval says nothing: {', '.join(alike)}")
    weak = [f"{row.case} ({row.week})" for row in rows if row.resolved is False]
    if weak:
        notes.append(f"differences that {members} members do not resolve: {', '.join(weak)}")
    return notes


def _residual(row: Row, target_h: float) -> str:
    """Why a case is not at equal comfort: out of reach, or a curve that jumps."""
    shift_K, hours = row.setpoint_shift_K.mean, row.hours_below_per_week.mean
    out_of_reach = abs(shift_K) >= LIMIT_K
    why = (
        f"are out of reach within {LIMIT_K:g} K of shift" if out_of_reach else "are jumped over as the setpoint shifts"
    )
    return f"{row.case}, {row.week}: {target_h:g} h below the limit {why}; it has {hours:.1f} h"
