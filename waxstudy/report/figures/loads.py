"""Cumulative flow, return temperature and floor heat."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from waxstudy.report.content import Content
from waxstudy.report.figures.places import cumulative, trace
from waxstudy.report.figures.plot import Lacking, drawing, panels
from waxstudy.report.figures.style import DASHED, GREY, legend_under, look
from waxstudy.results.kpis import DURATION_PERCENT
from waxstudy.study.model import Ladder

CHANNELS = (
    ("flow_L_h", "water flow, L/h"),
    ("return_C", "return temperature, °C"),
    ("floor_heat_W_m2", "floor heat flux, W/m²"),
)


@drawing(
    "21",
    "Figure 21. Cumulative performance in the first week",
    "Values that are not exceeded for a share of the time, mean over the members: water flow (the paper's "
    "mass flow), return temperature while water flows, supply temperature (dashed, where the study keeps a "
    "trace), and heat from the floor surface into the room.",
)
def figure_21(content: Content) -> Figure:
    """Duration curves of flow [L/h], return temperature [°C] and floor heat [W/m²], a column per ladder."""
    ladders, week = content.run.ladders, content.run.weeks[0]
    figure, axes = panels(len(CHANNELS), len(ladders), 9.2, sharex=True, sharey="row")
    for column, ladder in zip(axes.T, ladders, strict=True):
        for panel, (channel, _) in zip(column, CHANNELS, strict=True):
            _curves(panel, content, ladder, week, channel)
        _supply(column[1], content, ladder, week)
        column[0].set_title(f"{ladder.name}, {week}")
        column[-1].set(xlabel="share of the time with lower values, %", xlim=(0, 100))
        legend_under(column[-1], 1.0 / len(ladders))
    for panel, (_, label) in zip(axes[:, 0], CHANNELS, strict=True):
        panel.set_ylabel(label)
    figure.align_ylabels()
    return figure


def _curves(panel: Axes, content: Content, ladder: Ladder, week: str, channel: str) -> None:
    for place, case in enumerate(ladder.cases):
        curve = cumulative(content, case, week)[channel]
        panel.plot(curve.index, curve, label=case, markevery=(4 + 3 * place, 20), **look(content, case))


def _supply(panel: Axes, content: Content, ladder: Ladder, week: str) -> None:
    try:
        supply_C = trace(content, ladder.reference, week)["supply_C"]
    except Lacking:
        return
    curve = np.percentile(supply_C, DURATION_PERCENT)
    panel.plot(DURATION_PERCENT, curve, color=GREY, linestyle=DASHED, linewidth=1.8)
    panel.annotate("supply", (50, curve[50]), (0, 5), textcoords="offset points", ha="center", va="bottom")
