"""The comparison at a glance: heat against the reference case, and the fluctuation of the air temperature."""

from __future__ import annotations

import math
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from waxstudy.report.comparison import DIFFERENCE, Row
from waxstudy.report.content import Content
from waxstudy.report.figures.plot import drawing, panels
from waxstudy.report.figures.style import BLACK, COLOURS, GREY, MARKERS, legend_of

ERROR = "mae_K"


@drawing(
    "overview",
    "The comparison at a glance",
    "Left: heat of each case against the reference case of its ladder, mean and 95 % interval of paired "
    "members; filled where the difference is resolved. Right: mean absolute error of the air temperature, "
    "mean and standard deviation of single runs.",
)
def figure_overview(content: Content) -> Figure:
    """Differences in heat [%] and mean absolute errors [K] of all cases and weeks, the other side's beside."""
    cases = [case for ladder in content.run.ladders for case in ladder.cases]
    figure, axes = panels(1, 2, 1.4 + 0.33 * len(cases), sharey=True)
    left, right = axes[0]
    for week in content.run.weeks:
        rows = [row for row in content.rows if row.week == week]
        heights = [cases.index(row.case) + _offset(content, week) for row in rows]
        _differences(left, content, rows, heights)
        _errors(right, content, rows, heights)
    left.axvline(0.0, color=BLACK, linewidth=0.8)
    left.set_xlabel("heat against the reference case, %")
    right.set_xlabel("mean absolute error of the air temperature, K")
    right.set_xlim(left=0.0)
    left.set_yticks(range(len(cases)), cases)
    left.invert_yaxis()
    _separate_ladders(content, axes[0])
    _legend(figure, content)
    return figure


def _offset(content: Content, week: str) -> float:
    """Weeks below each other within the row of a case."""
    n = len(content.run.weeks)
    return 0.36 * (content.run.weeks.index(week) - (n - 1) / 2.0) / max(1, n - 1)


def _differences(axes: Axes, content: Content, rows: Sequence[Row], heights: Sequence[float]) -> None:
    for row, height in zip(rows, heights, strict=True):
        if row.resolved is None:
            continue
        value, colour, marker = getattr(row, DIFFERENCE), *_week_look(content, row.week)
        if not math.isnan(value.low):
            axes.plot([value.low, value.high], [height, height], color=colour)
        axes.plot(value.mean, height, marker, color=colour, markersize=6, mfc=colour if row.resolved else "white")
    _others(axes, content, rows, heights, DIFFERENCE)


def _errors(axes: Axes, content: Content, rows: Sequence[Row], heights: Sequence[float]) -> None:
    for row, height in zip(rows, heights, strict=True):
        colour, marker = _week_look(content, row.week)
        if not math.isnan(row.mae_K.sd):
            low, high = row.mae_K.mean - row.mae_K.sd, row.mae_K.mean + row.mae_K.sd
            axes.plot([low, high], [height, height], color=colour)
        axes.plot(row.mae_K.mean, height, marker, color=colour, markersize=6)
    _others(axes, content, rows, heights, ERROR)


def _others(axes: Axes, content: Content, rows: Sequence[Row], heights: Sequence[float], column: str) -> None:
    cells = content.against.cells if content.against else ()
    found = {(cell.case, cell.week): cell.theirs.mean for cell in cells if cell.column == column}
    for row, height in zip(rows, heights, strict=True):
        if (row.case, row.week) in found:
            axes.plot(found[row.case, row.week], height, "x", color=GREY, markersize=6, markeredgewidth=1.6, zorder=2.5)


def _week_look(content: Content, week: str) -> tuple[str, str]:
    place = content.run.weeks.index(week)
    return COLOURS[(1, 0, *range(2, len(COLOURS)))[place % len(COLOURS)]], MARKERS[place % len(MARKERS)]


def _separate_ladders(content: Content, axes: Sequence[Axes]) -> None:
    edge = -0.5
    for ladder in content.run.ladders[:-1]:
        edge += len(ladder.cases)
        for panel in axes:
            panel.axhline(edge, color=GREY, linewidth=0.8)


def _legend(figure: Figure, content: Content) -> None:
    handles = []
    for week in content.run.weeks:
        colour, marker = _week_look(content, week)
        handles.append(Line2D([], [], color=colour, marker=marker, markersize=6, label=week))
    handles.append(Line2D([], [], color=BLACK, marker="o", mfc="white", linestyle="", label="not resolved"))
    if content.against:
        label = content.against.label
        handles.append(Line2D([], [], color=GREY, marker="x", linestyle="", markeredgewidth=1.6, label=label))
    legend_of(figure, handles)
