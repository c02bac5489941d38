"""A run against another run: each mean with its own spread, and the sign of each step of a ladder."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

from waxstudy.report.against import Against
from waxstudy.report.behind import differing_inputs
from waxstudy.report.comparison import Estimate, Row, comparison, differences_percent, estimate
from waxstudy.report.score import Cell, cells, scores
from waxstudy.report.words import HEADINGS, Table, counted, decimals, with_spread
from waxstudy.results.run import Run

DIFFERENCE = "heat_vs_most_detailed_percent"


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
    missing: Sequence[str] = ()

    csv_suffixes = ("other", "other_sd")
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

    @property
    def notes(self) -> Sequence[str]:
        alone = "a run with one member per case: no difference between the two runs can be called resolved"
        return [*self.missing, *([alone] if self.cells and not self.judged else [])]

    def csv_figures(self, cell: Cell) -> tuple[str, str]:
        return decimals(cell.theirs.mean), decimals(cell.theirs.sd)

    def described_cell(self, cell: Cell) -> dict[str, Any]:
        low, high = cell.interval
        theirs = {"other": asdict(cell.theirs), "other_members": cell.their_members}
        return theirs | {"difference_low": low, "difference_high": high, "resolved": cell.resolved}

    def described(self) -> dict[str, Any]:
        steps = [asdict(step) | {"verdict": step.verdict} for step in self.steps]
        return super().described() | {"folder": self.folder, "members": self.members, "steps": steps}

    def tables(self) -> list[Table]:
        return [*super().tables(), self._difference_table(), self._step_table()]

    def _difference_table(self) -> Table:
        columns = [f"{name} {unit}" for name, unit, _ in HEADINGS.values()]
        keys = dict.fromkeys((cell.case, cell.week) for cell in self.cells)
        rows = [self._differences(case, week) for case, week in keys]
        title = f"this run minus {self.name}: difference of the means ± half its 95 % interval, and which are resolved"
        return title, ["case", "week", *columns, "resolved"], rows

    def _differences(self, case: str, week: str) -> list[str]:
        found = {cell.column: cell for cell in self.cells if (cell.case, cell.week) == (case, week)}
        texts = [_difference(found[c], HEADINGS[c][2]) if c in found else "" for c in HEADINGS]
        resolved = [HEADINGS[column][0] for column, cell in found.items() if cell.resolved]
        none = "no" if any(cell.resolved is False for cell in found.values()) else ""
        return [case, week, *texts, ", ".join(resolved) or none]

    def _step_table(self) -> Table:
        rows = [[s.name, s.week, _percent(s.ours), _percent(s.theirs), s.verdict] for s in self.steps]
        title = f"{self._signs()}; heat against the case before"
        return title, ["step", "week", "this run %", self.name, "verdict"], rows

    def _signs(self) -> str:
        """How many steps change the heat in the same direction, and which do not."""
        verdicts = [step.verdict for step in self.steps]
        agree, other = verdicts.count("agrees"), [s for s in self.steps if s.verdict == "differs"]
        differ = f"{len(other)} {'differs' if len(other) == 1 else 'differ'}"
        named = ", ".join(f"{step.name} ({step.week})" for step in other)
        said = f"{agree} {'agrees' if agree == 1 else 'agree'}, {differ}{': ' if named else ''}{named}"
        return f"sign of resolved steps: {said}"


def _difference(cell: Cell, digits: int) -> str:
    low, high = cell.interval
    return with_spread(cell.difference, (high - low) / 2.0, digits)


def _percent(value: Estimate) -> str:
    return with_spread(value.mean, value.sd, HEADINGS[DIFFERENCE][2])


# --- pairing two runs --------------------------------------------------------------------------------


def other_run(run: Run, rows: Sequence[Row], members: int, other: Run) -> OtherRun:
    """Hold a run against another; raise `RunError` where its key figures cannot be read."""
    their_members = int(other.kpis["member"].nunique())
    paired = _comparable(cells(rows, comparison(other), members, their_members), _references(run), _references(other))
    return OtherRun(
        name=_name(run, other),
        cells=paired,
        scores=scores(paired),
        folder=str(other.folder),
        members=their_members,
        steps=list(_steps(run, other)) if min(members, their_members) > 1 else (),
        missing=[*_missing(run, other), *differing_inputs(run, other)],
    )


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
        if cell.column != DIFFERENCE or (ours[cell.case] == theirs[cell.case] and math.isfinite(cell.theirs.mean))
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
    notes = [
        *_only("this run", ours, theirs, run.weeks, other.weeks),
        *_only("the other run", theirs, ours, other.weeks, run.weeks),
    ]
    moved = [f"{case} ({ours[case]}, {theirs[case]})" for case in ours if theirs.get(case, ours[case]) != ours[case]]
    if moved:
        notes.append(f"differences not compared, as their reference case here and there differs: {', '.join(moved)}")
    return notes


def _only(
    who: str, cases: Mapping[str, str], their_cases: Mapping[str, str], weeks: Sequence[str], their_weeks: Sequence[str]
) -> list[str]:
    alone = {
        "cases": [case for case in cases if case not in their_cases],
        "weeks": [week for week in weeks if week not in their_weeks],
    }
    return [f"{what} that only {who} has: {', '.join(names)}" for what, names in alone.items() if names]
