"""What a run is held against: published figures here, another run in `other_run`; every format asks these classes."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from operator import attrgetter
from typing import Any, ClassVar

from waxstudy.plugin import Finding, PublishedRow, Reference
from waxstudy.plugin.registry import PluginError, one_line, told
from waxstudy.plugin.shapes import findings_problems, rows_problems
from waxstudy.report.comparison import Row
from waxstudy.report.score import Cell, ColumnScore, cells, scores
from waxstudy.report.words import HEADINGS, Table, counted, with_spread
from waxstudy.results.run import Run


@dataclass(frozen=True)
class Against(ABC):
    """The other side's name and figures, and how well the two agree; what differs by kind is below."""

    name: str
    cells: Sequence[Cell]
    scores: Sequence[ColumnScore]
    findings: Sequence[Finding] = ()

    csv_suffixes: ClassVar[tuple[str, str]]
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

    @property
    @abstractmethod
    def notes(self) -> Sequence[str]:
        """What keeps a figure from being compared."""

    @abstractmethod
    def csv_figures(self, cell: Cell) -> tuple[str, str]:
        """Return what stands in the columns of `csv_suffixes`."""

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

    def tables(self) -> list[Table]:
        """Return the agreement by column, then what only this kind has."""
        return [self._score_table()]

    def of(self, row: Row) -> dict[str, Cell]:
        """Return the cells of one of our rows by column."""
        return {cell.column: cell for cell in self.cells if (cell.case, cell.week) == (row.case, row.week)}

    def _score_table(self) -> Table:
        headings = ["column", "week", "RMSE", "RMSE of median", "mean error", "correlation", "in range", "range width"]
        rows = [
            [
                f"{HEADINGS[s.column][0]} {HEADINGS[s.column][1]}",
                s.week,
                f"{s.rmse:.3f}",
                f"{s.null_rmse:.3f}",
                f"{s.mean_error:+.3f}",
                with_spread(s.correlation, math.nan, 2),
                "" if s.within_range is None else f"{s.within_range} of {s.n}",
                with_spread(s.mean_range_width, math.nan, 3),
            ]
            for s in self.scores
        ]
        title = (
            f"against {self.name}: agreement by column; `RMSE of median` is a model that predicts each "
            f"column's median, `in range` the {self.cells_word} cells within the 95 % range of our single runs"
        )
        return title, headings, rows


@dataclass(frozen=True)
class Published(Against):
    """A registered reference: one published run per case, and findings; `lacking` says why there are none."""

    lacking: str = ""
    missing: Sequence[str] = ()

    csv_suffixes = ("published", "published_difference")
    reading = (
        "Dim columns are published figures. A finding is not resolved where single runs spread more than the "
        "distance to the nearest limit of the finding."
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

    @property
    def notes(self) -> Sequence[str]:
        return [*self.missing, *([self.lacking] if self.lacking else [])]

    def csv_figures(self, cell: Cell) -> tuple[str, str]:
        published, difference = (
            "" if math.isnan(value) else f"{value:.5g}" for value in (cell.theirs.mean, cell.difference)
        )
        return published, difference

    def described_cell(self, cell: Cell) -> dict[str, Any]:
        return {"published": cell.theirs.mean}

    def tables(self) -> list[Table]:
        rows = [[f.id, f.statement, f.verdict, f.figure] for f in self.findings]
        title = f"findings: {self._verdicts()}; `not resolved`: single runs spread beyond a limit of the finding"
        return [*super().tables(), (title, ["id", "finding", "verdict", "our figure"], rows)]

    def _verdicts(self) -> str:
        verdicts = [finding.verdict for finding in self.findings]
        return ", ".join(f"{verdicts.count(verdict)} {verdict}" for verdict in ("held", "not held", "not resolved"))


def published(reference: type[Reference], run: Run, rows: Sequence[Row], members: int) -> Published:
    """Hold a run against a registered reference; raise `PluginError` where that breaks its contract."""
    name = reference.name
    with told(f"reference '{name}': rows failed"):
        figures = list(reference.rows())
    _keeps_its_contract(name, rows_problems(figures))
    paired, missing = cells(rows, figures, members), list(_missing(name, rows, figures))
    try:
        with told(f"reference '{name}': findings failed", ValueError):
            found = list(reference.findings(run))
    except ValueError as error:
        return Published(name, paired, scores(paired), lacking=one_line(str(error)), missing=missing)
    _keeps_its_contract(name, findings_problems(found))
    return Published(name, paired, scores(paired), found, missing=missing)


def _missing(name: str, rows: Sequence[Row], figures: Sequence[PublishedRow]) -> Iterator[str]:
    """Say of which of our cases and weeks nothing was published."""
    for what, of in (("cases", attrgetter("case")), ("weeks", attrgetter("week"))):
        known = set(map(of, figures))
        if alone := [word for word in dict.fromkeys(map(of, rows)) if word not in known]:
            yield f"{what} of which {name} has no figures: {', '.join(alone)}"


def _keeps_its_contract(reference: str, problems: Iterable[str]) -> None:
    for problem in problems:
        raise PluginError(f"reference '{reference}': {problem}")
