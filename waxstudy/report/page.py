"""The report as one self-contained HTML page: no links to outside, no scripts; figures are inline SVG."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from waxstudy.report.content import Content
from waxstudy.report.figures import PAPER_FIGURES
from waxstudy.report.figures.overview import figure_overview
from waxstudy.report.figures.plot import plots
from waxstudy.report.render import all_notes, tables
from waxstudy.report.words import Table, counted
from waxstudy.results.run import Run

FIGURE_TEXT = re.compile(r"(\(?[-+]?\d|never|$)")


def as_html(content: Content) -> str:
    """Return the report as one page; raise `RunError` where the run's curves or traces cannot be read."""
    comparison, against, activation = _grouped(content)
    return filled(
        "page.html.j2",
        content=content,
        summary=summary(content),
        overview=figure_overview.plot(content),
        comparison=comparison,
        against=against,
        activation=activation,
        figures=plots(PAPER_FIGURES, content),
        provenance=provenance(content.run),
        notes=all_notes(content),
    )


def filled(template: str, **values: Any) -> str:
    """Return one of the page templates with its values; a name that it does not know is an error."""
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        loader=PackageLoader("waxstudy.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["svg"] = Markup
    return environment.get_template(template).render(**values)


def summary(content: Content) -> list[str]:
    """What was studied and what came out, in plain sentences."""
    run = content.run
    cases = sum(len(ladder.cases) for ladder in run.ladders)
    sentences = [
        f"{counted(cases, 'case')} in {counted(len(run.ladders), 'ladder')} "
        f"({', '.join(ladder.name for ladder in run.ladders)}) over {counted(len(run.weeks), 'week')} "
        f"({', '.join(run.weeks)}), with {counted(content.members, 'member')} per case.",
        _resolved(content),
    ]
    return [*sentences, content.against.summary] if content.against else sentences


def _resolved(content: Content) -> str:
    judged = [row for row in content.rows if row.resolved is not None]
    if content.members < 2:
        return "With one member per case there is no spread, so that no difference can be called resolved."
    resolved = sum(bool(row.resolved) for row in judged)
    return (
        f"Of {counted(len(judged), 'difference')} in heat from the reference case, "
        f"{resolved} {'is' if resolved == 1 else 'are'} resolved."
    )


# --- tables ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Cell:
    """Text of a cell and how it is shown: `text` to the left, `published` dim, a verdict marked."""

    text: str
    style: str


@dataclass(frozen=True)
class PageTable:
    title: str
    headings: Sequence[Cell]
    rows: Sequence[tuple[str, Sequence[Cell]]]


def _grouped(content: Content) -> tuple[list[PageTable], list[PageTable], list[PageTable]]:
    """The tables in the order of `render.tables`: one per week, then those of the other side, then activation."""
    other = content.against.name if content.against else None
    shown = [page_table(table, starts_of(content.run), other) for table in tables(content)]
    weeks = len(content.run.weeks)
    after = weeks + (len(content.against.tables()) if content.against else 0)
    groups = shown[:weeks], shown[weeks:after], shown[after:]
    comparison, against, activation = ([table for table in group if table.rows] for group in groups)
    return comparison, against, activation


def starts_of(run: Run) -> set[str]:
    """The cases that ladders start with."""
    return {ladder.cases[0] for ladder in run.ladders}


def page_table(table: Table, starts: Collection[str] = (), published: str | None = None) -> PageTable:
    """Return a table as it is shown: a line above the rows that `starts` names, columns headed `published` dim."""
    title, headings, rows = table
    columns = list(zip(*rows, strict=True)) or [()] * len(headings)
    styles = [_style(heading, column, published) for heading, column in zip(headings, columns, strict=True)]
    return PageTable(
        _heading(title),
        [Cell(text, style) for text, style in zip(headings, styles, strict=True)],
        [
            (
                "starts-ladder" if row[0] in starts else "",
                [Cell(text, _marked(text, style)) for text, style in zip(row, styles, strict=True)],
            )
            for row in rows
        ],
    )


def _heading(title: str) -> str:
    return re.sub(r"`([^`]*)`", r"“\1”", title[0].upper() + title[1:])


def _style(heading: str, texts: Sequence[str], published: str | None) -> str:
    is_text = not all(FIGURE_TEXT.match(text) for text in texts)
    return " ".join(name for name, holds in (("text", is_text), ("published", heading == published)) if holds)


def _marked(text: str, style: str) -> str:
    marks = {
        **dict.fromkeys(("yes", "held", "agrees"), "good"),
        **dict.fromkeys(("not held", "differs"), "bad"),
        **dict.fromkeys(("no", "not resolved"), "open"),
    }
    return f"{style} {marks.get(text, '')}".strip()


def provenance(run: Run) -> list[tuple[str, str]]:
    """Where the figures come from: the folder's name, then what the run says of itself."""
    pairs = [(key, _words(value)) for key, value in run.provenance.items()]
    return [("run folder", run.folder.resolve().name), *pairs]


def _words(value: Any) -> str:
    if isinstance(value, Mapping):
        return ", ".join(f"{key} {item}" for key, item in value.items())
    return str(value)
