"""Bars: what each step adds by the ladder's order, and averaged over all orders."""

from __future__ import annotations

import math

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from waxstudy.report.attribution.render import WORDS
from waxstudy.report.attribution.shares import HEAT, Attribution, OrderFree, Share
from waxstudy.report.figures.plot import drawing, panels
from waxstudy.report.figures.style import BLACK, COLOURS, GREY, legend_of, name_rows

BAR, SHIFT = 0.34, 0.19  # height of a bar, and its distance from the middle of its row
FREE, NOT_RESOLVED = COLOURS[1], "white"
HATCH = "/////"
TICKS = 5  # more of them run into each other


@drawing(
    "shares",
    "What each step adds, by the ladder's order and averaged over all orders",
    "Upper bar (hatched): the ladder's order. Lower bar: mean over all orders, filled where it is resolved, with its "
    "95 % interval from paired members (black). Thin line with ends: the least and the most that the step adds over "
    "all orders.",
)
def figure_shares(found: OrderFree) -> Figure:
    """Shares in heat [%], setpoint shift [K] and MAE [K]: a row for each ladder and week, one scale per ladder."""
    figures = [figure for figure in WORDS if figure != HEAT]
    most = max(len(of.subsets.steps) for of in found.attributions)
    rows = len(found.attributions)
    drawn, axes = panels(rows, len(figures), 0.7 + rows * (1.1 + 0.36 * most))
    first: dict[tuple[str, str], Axes] = {}
    for row, of in zip(axes, found.attributions, strict=True):
        for panel, figure in zip(row, figures, strict=True):
            one_scale = first.setdefault((of.subsets.ladder.name, figure), panel)
            if panel is not one_scale:
                panel.sharex(one_scale)  # before anything is drawn, so that all that is drawn fits
            _bars(panel, of, figure)
            panel.set_xlabel(f"{WORDS[figure][0]}, {WORDS[figure][1]}")
            panel.locator_params(axis="x", nbins=TICKS)
        row[0].set_title(f"ladder {of.name}")
    _legend(drawn)
    return drawn


def _bars(panel: Axes, of: Attribution, figure: str) -> None:
    for i, share in enumerate(of.differences[figure].shares):
        _step(panel, i, share)
    panel.axvline(0.0, color=BLACK, linewidth=0.8)
    name_rows(panel, of.subsets.steps)


def _step(panel: Axes, place: int, share: Share) -> None:
    above, below = place - SHIFT, place + SHIFT
    panel.barh(above, share.in_ladder.mean, BAR, facecolor="white", edgecolor=BLACK, hatch=HATCH, linewidth=0.8)
    fill = NOT_RESOLVED if share.order_free.resolved is False else FREE
    panel.barh(below, share.order_free.mean, BAR, facecolor=fill, edgecolor=FREE, linewidth=1.2)
    if not math.isnan(share.least):
        panel.plot([share.least, share.most], [below, below], color=GREY, marker="|", markersize=7, zorder=2.4)
    if share.order_free.resolved is not None:
        interval = [share.order_free.low, share.order_free.high]
        panel.plot(interval, [below, below], color="white", linewidth=4.8, zorder=2.5)  # an edge on the dark bar
        panel.plot(interval, [below, below], color=BLACK, linewidth=2.6, zorder=2.6)


def _legend(figure: Figure) -> None:
    handles = [
        Patch(facecolor="white", edgecolor=BLACK, hatch=HATCH, label="ladder's order"),
        Patch(facecolor=FREE, edgecolor=FREE, label="order-free"),
        Patch(facecolor=NOT_RESOLVED, edgecolor=FREE, label="order-free, not resolved"),
        Line2D([], [], color=BLACK, linewidth=2.6, label="95 % interval"),
        Line2D([], [], color=GREY, marker="|", markersize=7, label="least to most over all orders"),
    ]
    legend_of(figure, handles)
