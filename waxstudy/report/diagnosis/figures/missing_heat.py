"""Missing heat over the record, and against what may drive it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from waxstudy.diagnosis.result import NORMAL, Diagnosis, HeatBy, HeatPiece, Interval
from waxstudy.report.figures.plot import Lacking, drawing, panels
from waxstudy.report.figures.style import BLACK, COLOURS, DASHED, legend_below

DRIVERS = {
    "hour": "hour of the day",
    "day": "day of the week",
    "outdoor difference": "room warmer than outside",
    "sun": "sun into the room",
    "flow": "water flow",
}
BAND = "#dcdcdc"
MOST_FLAT = 4
BESIDE = 0.14  # of two points in the place of one


@drawing(
    "heat",
    "Missing heat over the record, and by what may drive it",
    "Which heat into the room's air would explain what was measured: below 0 the room lacks heat that is believed, "
    "above it has more. Above: over the record, in pieces as short as it resolves, with 95 % intervals; as believed "
    "(line and grey band) and with the effects found, if any (dashed, between thin lines). Dotted, where a healthy "
    "record is known: what is usual. Below: means by what may drive it, with 95 % intervals. That it goes with a "
    "driver is no proof of a cause.",
)
def figure_missing_heat(diagnosis: Diagnosis) -> Figure:
    """Heat [W] by time [days], hour, weekday, outdoor difference [K], sun [W] and flow; `Lacking` without a room."""
    heat = diagnosis.missing_heat
    if not heat.before:
        raise Lacking("no room was judged")
    drivers = {name: [each for each in heat.by if each.driver == name] for name in DRIVERS}
    shown = {name: bins for name, bins in drivers.items() if bins}
    has_after = bool(diagnosis.effects) and list(heat.after) != list(heat.before)
    figure, axes = panels(2 if shown else 1, max(1, len(shown)), 6.2 if shown else 3.2, sharey="row")
    if shown:
        grid = axes[0, 0].get_gridspec()
        for panel in axes[0]:
            panel.remove()
        over = figure.add_subplot(grid[0, :])
        for panel, (name, bins) in zip(axes[1], shown.items(), strict=True):
            _driver(panel, bins, has_after)
            panel.set_xlabel(DRIVERS[name])
        axes[1, 0].set_ylabel("mean heat, W")
    else:
        over = axes[0, 0]
    _course(over, heat.before, heat.after if has_after else (), heat.usual_W)
    over.set_xlabel(f"days since {diagnosis.begins[:16].replace('T', ' ') or 'the record began'}")
    legend_below(figure, over)
    return figure


def _course(panel: Axes, before: Sequence[HeatPiece], after: Sequence[HeatPiece], usual_W: float) -> None:
    edges, value, low, high = _steps(before)
    panel.fill_between(edges, low, high, step="post", color=BAND, linewidth=0.0, label="interval as believed")
    panel.step(edges, value, where="post", color=BLACK, linewidth=1.3, label="as believed")
    if after:
        edges, value, low, high = _steps(after)
        panel.step(edges, value, where="post", color=COLOURS[1], linestyle=DASHED, linewidth=1.6, label="with effects")
        for each in (low, high):
            panel.step(edges, each, where="post", color=COLOURS[1], linewidth=0.5)
    if np.isfinite(usual_W):
        for way, label in ((-NORMAL, "usual"), (NORMAL, None)):
            panel.axhline(way * usual_W, color=COLOURS[5], linestyle=":", linewidth=1.4, label=label)
    panel.axhline(0.0, color=BLACK, linewidth=0.8)
    panel.set(ylabel="heat into the room, W", xlim=(edges[0], edges[-1]))
    panel.set_xticks(range(int(edges[-1]) + 1))


def _steps(pieces: Sequence[HeatPiece]) -> tuple[np.ndarray, ...]:
    """Return the edges of pieces in days, and value, low and high from each on; the last is held to the end."""
    edges = np.array([*(each.from_h for each in pieces), pieces[-1].to_h]) / 24.0
    rows = np.array([(each.heat_W, each.low_W, each.high_W) for each in (*pieces, pieces[-1])])
    return edges, *rows.T


def _driver(panel: Axes, bins: Sequence[HeatBy], has_after: bool) -> None:
    shift = BESIDE if has_after else 0.0
    for place, each in enumerate(bins):
        _bar(panel, place - shift, each.before, color=BLACK, marker="o")
        if has_after:
            _bar(panel, place + shift, each.after, color=COLOURS[1], marker="s", markerfacecolor="white")
    panel.axhline(0.0, color=BLACK, linewidth=0.8)
    names = [each.name.replace(" to ", "–").removesuffix(" h") for each in bins]
    # names under many bins stand upright, others end below theirs
    look = {"rotation": 90} if len(bins) > MOST_FLAT else {"rotation": 30, "ha": "right"}
    panel.set_xticks(range(len(bins)), names, **look)
    panel.set_xlim(-0.6, len(bins) - 0.4)
    panel.grid(axis="x", visible=False)


def _bar(panel: Axes, place: float, value: Interval, **look: str) -> None:
    off = [[value.value - value.low], [value.high - value.value]]
    panel.errorbar([place], [value.value], yerr=off, capsize=2.5, markersize=4.5, linewidth=1.1, **look)  # type: ignore[arg-type]
