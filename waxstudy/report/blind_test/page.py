"""A score as a page."""

from __future__ import annotations

from waxstudy.report.blind_test import tables
from waxstudy.report.blind_test.figures import figure_confusion, figure_goals, figure_sizes
from waxstudy.report.figures.plot import plots
from waxstudy.report.html import filled


def as_html(score: tables.Score) -> str:
    """Return the score as one page, without links to outside and without scripts."""
    names = tables.ordered(score)
    first = score["diagnosers"][names[0]]
    return filled(
        "blind_test.html.j2",
        score=score,
        first=names[0],
        who=[(name, score["diagnosers"][name]) for name in names],
        goals=tables.answered_goals(score),
        posteriors=tables.posterior_tables(score),
        figures=plots((figure_goals, figure_confusion, figure_sizes), score),
        splits=[tables.split_table(title, split) for title, split in first["by"].items()],
        parameters=tables.parameter_table(first["parameters"]),
        failures=tables.failure_table(f"{names[0]}: records not answered as they should be", first["failures"]),
        left_out=tables.failure_table("with the true effect taken out of the library", first["left_out"]),
    )
