"""The landscape of a tuning, and its settings on both kinds of weather."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from waxstudy.report.figures.plot import Lacking, drawing, one_panel, panels
from waxstudy.report.figures.style import BLACK, COLOURS, GREY, MARKERS, legend_of, name_rows
from waxstudy.report.tuning.tables import unit_beside
from waxstudy.tuning.space import Axis
from waxstudy.tuning.tune import Setting, Tuned

LEVELS = 12
MOST_IN_A_ROW = 3  # of a legend: names of settings may be long
WORST = 1.5  # scores above are drawn alike: what is far worse than the case as it stands needs no detail


@drawing(
    "landscape",
    "The landscape: the score over what was tuned",
    "Score of all settings that were evaluated (dots), joined to a map; 1 is the case as it stands, less is better, "
    "and what lies above 1.5 is drawn alike. Crosses could not be had at equal comfort. Of more than two parameters "
    "the first two are shown, whatever the others were.",
)
def figure_landscape(found: Tuned) -> Figure:
    """Score over the first two parameters, or over the only one."""
    return _map(found) if len(found.axes) > 1 else _curve(found)


def _map(found: Tuned) -> Figure:
    across, up = found.axes[1], found.axes[0]
    figure, panel = one_panel(5.6)
    counted = [each for each in found.seen if not each.reason]
    x, y = (np.array([each.values[axis.key] for each in counted]) for axis in (across, up))
    score = np.minimum([each.score for each in counted], WORST)
    places = [np.array([axis.share(value) for value in values]) for axis, values in ((across, x), (up, y))]
    if len(counted) < 3 or np.linalg.matrix_rank(np.column_stack([p - p[0] for p in places])) < 2:
        raise Lacking("too few settings could be had")
    # triangles between the places as they are seen, on a logarithmic scale where that is so
    mesh = Triangulation(x, y, Triangulation(*places).triangles)
    levels = MaxNLocator(LEVELS).tick_values(float(score.min()), float(score.max()) + 1e-6)
    drawn = panel.tricontourf(mesh, score, levels=levels, cmap="Greys")
    panel.tricontour(mesh, score, levels=[1.0], colors=BLACK, linestyles="dashed", linewidths=1.2)
    panel.plot(x, y, ".", color=COLOURS[4], markersize=4)
    lost = [each for each in found.seen if each.reason]
    panel.plot(
        [e.values[across.key] for e in lost], [e.values[up.key] for e in lost], "x", color=COLOURS[5], markersize=6
    )
    words = f"score ({found.goal.words}), 1; dashed: 1"
    bar = figure.colorbar(drawn, ax=panel, location="bottom", aspect=60, label=words, format="%.2f")
    bar.ax.grid(visible=False)
    handles = [_mark(panel, setting, place, across, up) for place, setting in enumerate(found.settings)]
    _scaled(panel, across, up)
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), MOST_IN_A_ROW))
    return figure


def _look(place: int) -> dict[str, Any]:
    """The chosen one is a star, the case as it stands a circle, others have markers of their own."""
    if place == 1:
        return {"marker": "*", "color": COLOURS[0], "markersize": 17}
    marker = "o" if place == 0 else MARKERS[1 + (place - 2) % (len(MARKERS) - 1)]
    return {"marker": marker, "color": COLOURS[(place + 1) % len(COLOURS)], "markersize": 9}


def _mark(panel: Axes, setting: Setting, place: int, across: Axis, up: Axis) -> Line2D:
    look = {**_look(place), "linestyle": "none", "markeredgecolor": BLACK, "zorder": 4.0}
    label = f"{setting.name} ({setting.score:.2f})"
    (drawn,) = panel.plot([setting.values[across.key]], [setting.values[up.key]], label=label, clip_on=False, **look)
    return drawn


def _label(axis: Axis) -> str:
    return ", ".join(filter(None, (axis.name, unit_beside(axis))))


def _scaled(panel: Axes, across: Axis, up: Axis) -> None:
    for axis, set_scale, set_label in (
        (across, panel.set_xscale, panel.set_xlabel),
        (up, panel.set_yscale, panel.set_ylabel),
    ):
        set_scale("log" if axis.is_log else "linear")
        set_label(_label(axis))


def _curve(found: Tuned) -> Figure:
    (axis,) = found.axes
    figure, panel = one_panel(4.2)
    counted = sorted((each for each in found.seen if not each.reason), key=lambda each: each.values[axis.key])
    if not counted:
        raise Lacking("no settings could be had")
    panel.plot([e.values[axis.key] for e in counted], [e.score for e in counted], ".-", color=GREY)
    handles = []
    for place, setting in enumerate(found.settings):
        look = {**_look(place), "linestyle": "none", "markeredgecolor": BLACK, "zorder": 4.0}
        handles += panel.plot([setting.values[axis.key]], [setting.score], label=setting.name, **look)
    panel.set_xscale("log" if axis.is_log else "linear")
    panel.set(xlabel=_label(axis), ylabel=f"score ({found.goal.words}), 1")
    figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), MOST_IN_A_ROW))
    return figure


@drawing(
    "tested",
    "On weather that took no part",
    "Score of each of the settings on the weather tuned on (open circle) and on the weather that took no part (full "
    "square); 1 is the case as it stands on the same weather, less is better.",
)
def figure_tested(found: Tuned) -> Figure:
    """Scores of the settings on both kinds of weather."""
    if found.chosen.tested is None:
        raise Lacking("the study has no other weather than that which was tuned on")
    shown = [setting for setting in found.settings if setting.tested is not None]
    drawn, axes = panels(1, 1, 0.9 + 0.36 * len(shown))
    panel = axes[0, 0]
    for row, setting in enumerate(shown):
        panel.plot([setting.score, setting.tested_score], [row, row], color=GREY, linewidth=0.9)
        panel.plot(setting.score, row, "o", color=BLACK, markerfacecolor="white", markersize=7)
        panel.plot(setting.tested_score, row, "s", color=COLOURS[1], markersize=6)
    panel.axvline(1.0, color=BLACK, linewidth=0.8)
    panel.set_xlabel(f"score ({found.goal.words}), 1")
    name_rows(panel, [setting.name for setting in shown])
    handles = [
        Line2D([], [], marker="o", color=BLACK, markerfacecolor="white", linestyle="none", label="tuned on"),
        Line2D([], [], marker="s", color=COLOURS[1], linestyle="none", label="took no part"),
    ]
    legend_of(drawn, handles)
    return drawn
