"""A score as one self-contained HTML page."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from waxstudy.report.blind_test.figures import figure_confusion, figure_goals, figure_sizes
from waxstudy.report.blind_test.words import (
    Score,
    failure_table,
    goal_table,
    ordered,
    parameter_table,
    split_table,
)
from waxstudy.report.figures.places import Lacking
from waxstudy.report.figures.style import svg_element
from waxstudy.report.page import PageFigure, filled, page_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PLOTS: dict[str, tuple[str, str, Callable[[Score], Figure]]] = {
    "goals": (
        "Figures and goals",
        "With their 95 % intervals; where no mark stands, nobody answered such a record.",
        figure_goals,
    ),
    "confusion": (
        "True cause and what was said",
        "Records with one cause or none, all channel sets and noises; the darker, the larger the share of a row.",
        figure_confusion,
    ),
    "sizes": ("What size of gap is found", "Shares with 95 % intervals; all channel sets and noises.", figure_sizes),
}


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
        figures={name: _drawn(score, name) for name in PLOTS},
        splits=[page_table(split_table(title, split)) for title, split in first["by"].items()],
        parameters=page_table(parameter_table(first["parameters"])),
        failures=[
            page_table(failure_table(f"{name}: records not answered as they should be", each["failures"]))
            for name, each in score["diagnosers"].items()
            if name == names[0] and each["failures"]
        ],
        left_out=page_table(failure_table("with the true effect taken out of the library", first["left_out"])),
    )


def _drawn(score: Score, name: str) -> PageFigure:
    title, caption, draw = PLOTS[name]
    id = f"figure-{name}"
    try:
        return PageFigure(id, title, caption, svg_element(draw(score), id))
    except Lacking as reason:
        return PageFigure(id, title, "", "", str(reason))
