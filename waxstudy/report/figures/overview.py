"""The comparison at a glance: heat against the reference case, and the fluctuation of the air temperature."""

from __future__ import annotations

import math
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from waxstudy.report.comparison import CORRECTED_DIFFERENCE, DIFFERENCE, Estimate
from waxstudy.report.content import Content
from waxstudy.report.figures.plot import drawing, panels
from waxstudy.report.figures.style import BLACK, COLOURS, GREY, MARKERS, legend_of


@drawing(
    "overview",
    "The comparison at a glance",
    "Left: heat of each case against the reference case of its ladder, mean and 95 % interval of paired "
    "members; filled where the mean decides. Middle: the same, corrected for what the room holds more or less of it "
    "when the week ends. Right: mean absolute error of the air temperature, mean and standard deviation of single "
    "runs.",
)
def figure_overview(content: Content) -> Figure:
    """Differences in heat [%] and mean absolute errors [K] of all cases and weeks, the other side's beside."""
    cases = [case for ladder in content.run.ladders for case in ladder.cases]
    figure, axes = panels(1, 3, 1.4 + 0.33 * len(cases), sharey=True)
    left, middle, right = axes[0]
    middle.sharex(left)  # before anything is drawn, so that all that is drawn fits
    for row in content.rows:
        height, look = cases.index(row.case) + _offset(content, row.week), _week_look(content, row.week)
        _difference(left, look, height, row.heat_vs_most_detailed_percent, row.resolved)
        _difference(middle, look, height, row.heat_corrected_vs_most_detailed_percent, row.corrected_resolved)
        error = row.mae_K
        _point(right, look, height, (error.mean - error.sd, error.mean, error.mean + error.sd), True)
        for panel, column in ((left, DIFFERENCE), (middle, CORRECTED_DIFFERENCE), (right, "mae_K")):
            if cell := content.against and content.against.cell(column, row):
                panel.plot(cell.theirs.mean, height, "x", color=GREY, markersize=6, markeredgewidth=1.6, zorder=2.5)
    for panel, which in ((left, "heat"), (middle, "corrected heat")):
        panel.axvline(0.0, color=BLACK, linewidth=0.8)
        panel.set_xlabel(f"{which} against the reference case, %")
    if all(row.corrected_resolved is None for row in content.rows):
        middle.set_xlabel("corrected heat is not known")
    right.set_xlabel("mean absolute error of the air temperature, K")
    if math.isfinite(right.dataLim.x1):
        right.set_xlim(0.0, 1.04 * right.dataLim.x1)  # no marker is cut at the edge
    left.set_yticks(range(len(cases)), cases)
    left.invert_yaxis()
    _separate_ladders(content, axes[0])
    _legend(figure, content)
    return figure


def _offset(content: Content, week: str) -> float:
    """Weeks below each other within the row of a case."""
    n = len(content.run.weeks)
    return 0.36 * (content.run.weeks.index(week) - (n - 1) / 2.0) / max(1, n - 1)


def _difference(axes: Axes, look: tuple[str, str], height: float, of: Estimate, resolved: bool | None) -> None:
    if resolved is not None:
        _point(axes, look, height, (of.low, of.mean, of.high), resolved)


def _point(axes: Axes, look: tuple[str, str], height: float, span: tuple[float, float, float], is_filled: bool) -> None:
    (colour, marker), (low, mean, high) = look, span
    if not math.isnan(low):
        axes.plot([low, high], [height, height], color=colour)
    axes.plot(mean, height, marker, color=colour, markersize=6, mfc=colour if is_filled else "white")


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
