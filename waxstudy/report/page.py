"""The report as a page."""

from __future__ import annotations

from collections.abc import Callable

from waxstudy.report.cases import legend, told_same
from waxstudy.report.content import Content
from waxstudy.report.figures import PAPER_FIGURES
from waxstudy.report.figures.months import figure_months
from waxstudy.report.figures.overview import figure_overview
from waxstudy.report.figures.plot import plots
from waxstudy.report.html import filled, provenance
from waxstudy.report.render import activation_tables, comparison_tables, other_notes, season_tables
from waxstudy.report.words import counted


def as_html(content: Content, told: Callable[[float], None] = lambda share: None) -> str:
    """Return the report as one page, and tell which share of its figures is drawn.

    Raises `RunError` where the run's curves or traces cannot be read.
    """
    return filled(
        "page.html.j2",
        content=content,
        summary=summary(content),
        legend=legend(content.study),
        same=told_same(content.run),
        findings=content.against.sentences() if content.against else [],
        overview=figure_overview.plot(content),
        comparison=comparison_tables(content),
        months=figure_months.plot(content) if content.months else None,
        season=season_tables(content),
        against=[table for table in content.against.tables() if table.rows] if content.against else [],
        activation=activation_tables(content),
        starts={ladder.cases[0] for ladder in content.run.ladders},
        figures=plots(PAPER_FIGURES, content, told),
        provenance=provenance(content.run),
        notes=other_notes(content),
    )


def summary(content: Content) -> list[str]:
    """What was studied and what came out, in plain sentences."""
    run = content.run
    cases = sum(len(ladder.cases) for ladder in run.ladders)
    sentences = [
        f"{counted(cases, 'case')} in {counted(len(run.ladders), 'ladder')} "
        f"({', '.join(ladder.name for ladder in run.ladders)}) over {counted(len(run.weeks), 'week')} "
        f"({', '.join(run.weeks)}), with {_members(content)} per case.",
        _resolved(content),
    ]
    return [*sentences, content.against.summary] if content.against else sentences


def _members(content: Content) -> str:
    """The members of a case, week by week where they are not as many in each."""
    by_week = {week: content.members_told(week) for week in content.run.weeks}
    if len(set(by_week.values())) == 1:
        return next(iter(by_week.values()))
    return ", ".join(f"{told} in {week}" for week, told in by_week.items())


def _resolved(content: Content) -> str:
    judged = [row for row in content.rows if row.resolved is not None]
    if content.members < 2:
        return "With one member per case there is no spread, so that no difference can be called resolved."
    resolved = sum(bool(row.resolved) for row in judged)
    return (
        f"Of {counted(len(judged), 'difference')} in heat from the reference case, "
        f"{resolved} {'is' if resolved == 1 else 'are'} resolved."
    )
