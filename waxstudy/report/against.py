"""What a run is held against: published figures here, another run in `other_run`; every format asks these classes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from operator import attrgetter
from typing import Any, ClassVar

from waxstudy.plugin import Finding, PublishedRow, Reference
from waxstudy.plugin.registry import PluginError, one_line, told
from waxstudy.plugin.shapes import findings_problems, rows_problems
from waxstudy.report.comparison import COLUMNS, CORRECTED_FIGURES, FIGURES, Row, members_by_week
from waxstudy.report.score import Cell, ColumnScore, cells, scores
from waxstudy.report.table import Column, Table, text
from waxstudy.report.words import MEAN_DECIDES, SINGLE_RUN, counted, percent
from waxstudy.results.run import Run

MARK = {"held": "good", "not held": "bad", "not resolved": "open"}  # of a verdict on a page


@dataclass(frozen=True)
class Said:
    """A finding as a sentence: its verdict with the mark of a page, and one figure of ours."""

    verdict: str
    statement: str
    figure: str

    @property
    def mark(self) -> str:
        return MARK[self.verdict]


@dataclass(frozen=True)
class Against(ABC):
    """The other side's name and figures, and how well the two agree; what differs by kind is below."""

    name: str
    cells: Sequence[Cell]
    scores: Sequence[ColumnScore]
    findings: Sequence[Finding] = ()
    notes: Sequence[str] = ()  # what keeps a figure from being compared

    csv_figures: ClassVar[Mapping[str, str]]  # by the end of a column's name, what of a cell stands there
    csv_form: ClassVar[str]
    cells_word: ClassVar[str]
    reading: ClassVar[str]  # how to read its part of the page

    @property
    @abstractmethod
    def label(self) -> str:
        """Its name in the legend of a figure."""

    @property
    @abstractmethod
    def summary(self) -> str:
        """One sentence of what came out."""

    @abstractmethod
    def described_cell(self, cell: Cell) -> dict[str, Any]:
        """Return what JSON says of the other side's figure."""

    def described(self) -> dict[str, Any]:
        """Return what JSON says of it all."""
        return {
            "name": self.name,
            "cells": [self._cell(cell) for cell in self.cells],
            "scores": [asdict(score) for score in self.scores],
            "findings": [asdict(finding) for finding in self.findings],
        }

    def _cell(self, cell: Cell) -> dict[str, Any]:
        return {
            "case": cell.case,
            "week": cell.week,
            "column": cell.column,
            "ours": asdict(cell.ours),
            "members": cell.members,
            **self.described_cell(cell),
            "difference": cell.difference,
            "within_single_run_range": cell.within_single_run_range,
        }

    def tables(self) -> list[Table[Any]]:
        """Return the agreement by column, then what only this kind has."""
        return [self._score_table()]

    def sentences(self) -> list[Said]:
        """Return each finding as a sentence with its first figure."""
        return [Said(of.verdict, of.statement, of.figure.split("; ")[0]) for of in self.findings]

    def beside(self, figure: Column[Row]) -> Column[Row]:
        """Return the column of the other side's figures beside one of ours."""
        return Column(self.name, partial(self._part, figure.key, "theirs"), figure.form, kind="theirs")

    def csv_columns(self) -> list[Column[Row]]:
        """Return what CSV says of the other side's figures."""
        return [
            Column(f"{key}_{end}", partial(self._part, key, part), self.csv_form)
            for key in COLUMNS
            for end, part in self.csv_figures.items()
        ]

    def cell(self, column: str, row: Row | Cell) -> Cell | None:
        """Return the cell of a column for the case and week of a row, if there is one."""
        place = row.case, row.week, column
        return next((cell for cell in self.cells if (cell.case, cell.week, cell.column) == place), None)

    def _part(self, column: str, part: str, row: Row) -> Any:
        cell = self.cell(column, row)
        return cell and attrgetter(part)(cell)

    def _score_table(self) -> Table[ColumnScore]:
        names = {figure.key: figure.name for figure in (*FIGURES, *CORRECTED_FIGURES)}
        return Table(
            f"against {self.name}: agreement by column; `RMSE of median` is a model that predicts each "
            f"column's median, `in range` the {self.cells_word} cells within the 95 % range of our single runs",
            [
                text("column", lambda score: names[score.column]),
                text("week"),
                Column("rmse", form=".3f", heading="RMSE"),
                Column("null_rmse", form=".3f", heading="RMSE of median"),
                Column("mean_error", form="+.3f", heading="mean error"),
                Column("correlation", form="z.2f"),
                Column("in range", lambda s: None if s.within_range is None else f"{s.within_range} of {s.n}"),
                Column("mean_range_width", form="z.3f", heading="range width"),
            ],
            self.scores,
        )


@dataclass(frozen=True)
class Published(Against):
    """A registered reference: one published run per case, and findings; `lacking` says why there are none."""

    lacking: str = ""

    csv_figures = {"published": "theirs.mean", "published_difference": "difference"}
    csv_form = ".5g"
    reading = (
        "Dim columns are published figures. The mean decides a finding unless the 95 % interval of the "
        "ensemble's mean reaches over one of its limits; beside it stands the share of single runs that could have "
        "shown it."
    )
    cells_word = "published"

    @property
    def label(self) -> str:
        return f"{self.name} (one published run)"

    @property
    def summary(self) -> str:
        if self.lacking:
            return f"Findings are not judged: {self.lacking}."
        return f"Of the {counted(len(self.findings), 'finding')} of “{self.name}”: {self._verdicts()}."

    def described_cell(self, cell: Cell) -> dict[str, Any]:
        return {"published": cell.theirs.mean}

    def tables(self) -> list[Table[Any]]:
        return [*super().tables(), self._finding_table()]

    def _finding_table(self) -> Table[Finding]:
        corrected: list[Column[Finding]] = [
            text("corrected_verdict", kind="verdict", heading="with corrected heat"),
            Column("corrected_share", _corrected_share, heading=SINGLE_RUN),
        ]
        return Table(
            f"findings: {self._verdicts()}; `{MEAN_DECIDES}`, or not where its 95 % interval reaches over a limit; "
            f"`{SINGLE_RUN}`: share of single runs in which all of it holds",
            [
                text("id"),
                text("statement", _statement, "prose", "finding"),
                text("verdict", kind="verdict", heading=MEAN_DECIDES),
                Column("single_run_share", lambda f: percent(f.single_run_share), heading=SINGLE_RUN),
                *(corrected if self._is_on_heat else ()),
                text("figure", _figures, kind="list", heading="our figure"),
            ],
            self.findings,
        )

    def _verdicts(self) -> str:
        verdicts = [finding.verdict for finding in self.findings]
        if not self._is_on_heat:
            return _counts(verdicts)
        corrected = [finding.corrected_verdict or finding.verdict for finding in self.findings]
        return f"{_counts(verdicts)} (with corrected heat {_counts(corrected)})"

    @property
    def _is_on_heat(self) -> bool:
        return any(finding.corrected_verdict for finding in self.findings)


def _counts(verdicts: Sequence[str]) -> str:
    return ", ".join(f"{verdicts.count(verdict)} {verdict}" for verdict in ("held", "not held", "not resolved"))


def _statement(finding: Finding) -> str:
    return finding.statement + (f" (circular: {finding.circular})" if finding.circular else "")


def _corrected_share(finding: Finding) -> str:
    return percent(finding.corrected_single_run_share)


def _figures(finding: Finding) -> str:
    more = f"; with corrected heat: {finding.corrected_figure}" if finding.corrected_figure else ""
    return finding.figure + more


def published(reference: type[Reference], run: Run, rows: Sequence[Row]) -> Published:
    """Hold a run against a registered reference; raise `PluginError` where that breaks its contract."""
    name = reference.name
    with told(f"reference '{name}': rows failed"):
        figures = list(reference.rows())
    _keeps_its_contract(name, rows_problems(figures))
    paired, missing = cells(rows, figures, members_by_week(run)), list(_missing(name, rows, figures))
    try:
        with told(f"reference '{name}': findings failed", ValueError):
            found = list(reference.findings(run))
    except ValueError as error:
        lacking = one_line(str(error))
        return Published(name, paired, scores(paired), notes=[*missing, lacking], lacking=lacking)
    _keeps_its_contract(name, findings_problems(found))
    return Published(name, paired, scores(paired), found, missing)


def _missing(name: str, rows: Sequence[Row], figures: Sequence[PublishedRow]) -> Iterator[str]:
    """Say of which of our cases and weeks nothing was published."""
    for what, of in (("cases", attrgetter("case")), ("weeks", attrgetter("week"))):
        known = set(map(of, figures))
        if alone := [word for word in dict.fromkeys(map(of, rows)) if word not in known]:
            yield f"{what} of which {name} has no figures: {', '.join(alone)}"


def _keeps_its_contract(reference: str, problems: Iterable[str]) -> None:
    for problem in problems:
        raise PluginError(f"reference '{reference}': {problem}")
