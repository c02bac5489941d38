"""A run against another run: each mean with its own spread, and the sign of each step of a ladder."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from itertools import pairwise
from typing import Any

from waxstudy.report.against import Against
from waxstudy.report.comparison import (
    CORRECTED_DIFFERENCE,
    CORRECTED_FIGURES,
    DIFFERENCE,
    FIGURES,
    Estimate,
    Row,
    comparison,
    differences_percent,
    estimate,
    members_by_week,
)
from waxstudy.report.input_differences import differing_inputs
from waxstudy.report.score import Cell, cells, scores
from waxstudy.report.table import Column, Table, text
from waxstudy.report.words import counted
from waxstudy.results.run import Run

COMPARED = (*FIGURES, *CORRECTED_FIGURES)


@dataclass(frozen=True)
class Step:
    """Heat of a case relative to the case before it in our ladder [%], paired by member within each run."""

    before: str
    after: str
    week: str
    ours: Estimate
    theirs: Estimate

    @property
    def verdict(self) -> str:
        if not (self.ours.excludes_zero and self.theirs.excludes_zero):
            return "not resolved"
        return "agrees" if self.ours.mean * self.theirs.mean > 0.0 else "differs"

    @property
    def name(self) -> str:
        return f"{self.before} to {self.after}"


@dataclass(frozen=True)
class OtherRun(Against):
    """Another run's figures beside ours, matched by the ids of cases and the names of weeks."""

    folder: str = ""
    members: int = 1
    steps: Sequence[Step] = ()

    csv_figures = {"other": "theirs.mean", "other_sd": "theirs.sd"}
    csv_form = ".5f"
    cells_word = "other run's"
    reading = (
        "Dim columns are the other run's figures. A difference between the runs is resolved when the 95 % interval "
        "of the difference of the two means, each with its own spread and not paired, excludes zero. A step is the "
        "heat of a case against the one before it, paired by member; its sign is judged where both runs resolve it."
    )

    @property
    def label(self) -> str:
        return f"{self.name} (mean of {counted(self.members, 'member')})"

    @property
    def judged(self) -> Sequence[Cell]:
        """Cells of which both runs have a spread."""
        return [cell for cell in self.cells if cell.resolved is not None]

    @property
    def summary(self) -> str:
        if not self.judged:
            return f"No difference from “{self.name}” can be judged."
        resolved = sum(bool(cell.resolved) for cell in self.judged)
        figures = f"Of {counted(len(self.judged), 'figure')}, {resolved} {'differs' if resolved == 1 else 'differ'}"
        return f"{figures} from “{self.name}” by a resolved amount; {self._signs()}."

    def described_cell(self, cell: Cell) -> dict[str, Any]:
        low, high = cell.interval
        theirs = {"other": asdict(cell.theirs), "other_members": cell.their_members}
        return theirs | {"difference_low": low, "difference_high": high, "resolved": cell.resolved}

    def described(self) -> dict[str, Any]:
        steps = [asdict(step) | {"verdict": step.verdict} for step in self.steps]
        return super().described() | {"folder": self.folder, "members": self.members, "steps": steps}

    def tables(self) -> list[Table[Any]]:
        return [*super().tables(), self._difference_table(), self._step_table()]

    def _difference_table(self) -> Table[Cell]:
        """A row for each case and week, for which its last cell stands."""
        title = f"this run minus {self.name}: difference of the means ± half its 95 % interval, and which are resolved"
        columns: list[Column[Cell]] = [
            text("case"),
            text("week"),
            *(Column(each.key, partial(self.cell, each.key), each.form, each.heading, each.unit) for each in COMPARED),
            text("resolved", self._resolved, "verdict"),
        ]
        return Table(title, columns, list({(cell.case, cell.week): cell for cell in self.cells}.values()))

    def _resolved(self, row: Cell) -> str:
        cells = {figure.heading: self.cell(figure.key, row) for figure in COMPARED}
        resolved = [name for name, cell in cells.items() if cell and cell.resolved]
        none = "no" if any(cell and cell.resolved is False for cell in cells.values()) else ""
        return ", ".join(resolved) or none

    def _step_table(self) -> Table[Step]:
        return Table(
            f"{self._signs()}; heat against the case before",
            [
                text("name", heading="step"),
                text("week"),
                Column("ours", form=".2f", heading="this run", unit="%"),
                Column("theirs", form=".2f", heading=self.name, kind="theirs"),
                text("verdict", kind="verdict"),
            ],
            self.steps,
        )

    def _signs(self) -> str:
        """How many steps change the heat in the same direction, and which do not."""
        verdicts = [step.verdict for step in self.steps]
        agree, other = verdicts.count("agrees"), [s for s in self.steps if s.verdict == "differs"]
        differ = f"{len(other)} {'differs' if len(other) == 1 else 'differ'}"
        named = ", ".join(f"{step.name} ({step.week})" for step in other)
        said = f"{agree} {'agrees' if agree == 1 else 'agree'}, {differ}{': ' if named else ''}{named}"
        return f"sign of resolved steps: {said}"


# --- pairing two runs --------------------------------------------------------------------------------


def other_run(run: Run, rows: Sequence[Row], other: Run) -> OtherRun:
    """Hold a run against another; raise `RunError` where its key figures cannot be read."""
    members, their_members = members_by_week(run), members_by_week(other)
    paired = _comparable(cells(rows, comparison(other), members, their_members), _references(run), _references(other))
    return OtherRun(
        name=_name(run, other),
        cells=paired,
        scores=scores(paired),
        folder=str(other.folder),
        members=max(their_members.values()),
        steps=list(_steps(run, other)) if min(max(members.values()), max(their_members.values())) > 1 else (),
        notes=[*_missing(run, other), *differing_inputs(run, other), *_alone(paired)],
    )


def _alone(paired: Sequence[Cell]) -> list[str]:
    words = "a run with one member per case: no difference between the two runs can be called resolved"
    return [words] if paired and all(cell.resolved is None for cell in paired) else []


def _name(run: Run, other: Run) -> str:
    """The name of its folder, and of the folder around it where ours has the same name."""
    ours, theirs = run.folder.resolve(), other.folder.resolve()
    return theirs.name if theirs.name != ours.name else f"{theirs.parent.name}/{theirs.name}"


def _references(run: Run) -> dict[str, str]:
    """The reference case of each case."""
    return {case: ladder.reference for ladder in run.ladders for case in ladder.cases}


def _comparable(paired: Sequence[Cell], ours: Mapping[str, str], theirs: Mapping[str, str]) -> list[Cell]:
    """Leave out differences that are from another reference case or from none."""
    return [
        cell
        for cell in paired
        if math.isfinite(cell.theirs.mean)
        and (cell.column not in (DIFFERENCE, CORRECTED_DIFFERENCE) or ours[cell.case] == theirs[cell.case])
    ]


def _steps(run: Run, other: Run) -> Iterator[Step]:
    """Every pair of neighbours in our ladders that the other run has too."""
    known = _references(other)
    for week in (week for week in run.weeks if week in other.weeks):
        for before, after in (pair for ladder in run.ladders for pair in pairwise(ladder.cases)):
            if before in known and after in known:
                ours, theirs = (estimate(differences_percent(r.kpis, after, before, week)) for r in (run, other))
                yield Step(before, after, week, ours, theirs)


def _missing(run: Run, other: Run) -> list[str]:
    """Say which cases and weeks only one of the two has, and which cases have another reference case."""
    ours, theirs = _references(run), _references(other)
    notes = [*_only("this run", run, other), *_only("the other run", other, run)]
    moved = [f"{case} ({ours[case]}, {theirs[case]})" for case in ours if theirs.get(case, ours[case]) != ours[case]]
    if moved:
        notes.append(f"differences not compared, as their reference case here and there differs: {', '.join(moved)}")
    return notes


def _only(who: str, run: Run, other: Run) -> list[str]:
    pairs = (("cases", _references(run), _references(other)), ("weeks", run.weeks, other.weeks))
    alone = {what: [name for name in own if name not in there] for what, own, there in pairs}
    return [f"{what} that only {who} has: {', '.join(names)}" for what, names in alone.items() if names]
