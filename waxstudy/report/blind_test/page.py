"""A score as one self-contained HTML page."""

from __future__ import annotations

from waxstudy.report.blind_test.figures import figure_confusion, figure_goals, figure_sizes
from waxstudy.report.blind_test.words import (
    Score,
    failure_table,
    goal_table,
    ordered,
    parameter_table,
    split_table,
)
from waxstudy.report.figures.plot import plots
from waxstudy.report.page import filled, page_table


def as_html(score: Score) -> str:
    """Return the score as one page, without links to outside and without scripts."""
    names = ordered(score)
    first = score["diagnosers"][names[0]]
    return filled(
        "blind_test.html.j2",
        score=score,
        first=names[0],
        who=[(name, score["diagnosers"][name]) for name in names],
        goals=[page_table(goal_table(score, where)) for where in ("fast room", "other physics")],
        figures=plots((figure_goals, figure_confusion, figure_sizes), score),
        splits=[page_table(split_table(title, split)) for title, split in first["by"].items()],
        parameters=page_table(parameter_table(first["parameters"])),
        failures=[
            page_table(failure_table(f"{name}: records not answered as they should be", each["failures"]))
            for name, each in score["diagnosers"].items()
            if name == names[0] and each["failures"]
        ],
        left_out=page_table(failure_table("with the true effect taken out of the library", first["left_out"])),
    )
