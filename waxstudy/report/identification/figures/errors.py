"""How far the model is off: errors per record, and an hour of a typical, the best and the worst record."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from waxstudy.identification.records import Record
from waxstudy.identification.result import ActuatorFit
from waxstudy.report.figures.plot import Lacking, drawing, one_panel, panels
from waxstudy.report.figures.style import BLACK, COLOURS, DASHED, GREY, legend_below

HOUR_S = 3600.0


@drawing(
    "errors",
    "Errors of all records (as the paper's figure 13)",
    "Mean absolute and root mean square error of the modelled opening over each record but for its gaps, by product.",
)
def figure_errors(found: ActuatorFit) -> Figure:
    """Bars per record."""
    shown = _modelled(found)
    figure, panel = one_panel(3.8)
    place = np.arange(len(shown))
    looks: Any = (-0.2, "mae", {"color": COLOURS[1]}), (0.2, "rmse", {"color": COLOURS[4], "hatch": "////"})
    for shift, what, look in looks:
        heights = [getattr(found.errors[record.name], what) for record in shown]
        panel.bar(place + shift, heights, 0.38, label=what.upper(), edgecolor=BLACK, linewidth=0.6, **look)
    panel.set_xticks(place, [record.name for record in shown], rotation=60, ha="right")
    panel.grid(axis="x", visible=False)
    panel.set_ylabel("error of the opening, 1")
    panel.legend()
    return figure


def _modelled(found: ActuatorFit) -> list[Record]:
    """The records that have a model; raise `Lacking` if none has."""
    if shown := [record for record in found.records if record.name in found.errors]:
        return shown
    raise Lacking("no record has a model")


@drawing(
    "hours",
    "An hour of a typical, the best and the worst record (as the paper's figure 14)",
    "Measured and modelled opening; records by their mean absolute error. Shown is the hour whose error is nearest "
    "to that of its record. Dashed: signal.",
)
def figure_hours(found: ActuatorFit) -> Figure:
    """Three panels: typical, best, worst."""
    ordered = sorted(_modelled(found), key=lambda record: found.errors[record.name].mae)
    picked = {"typical": ordered[len(ordered) // 2], "best": ordered[0], "worst": ordered[-1]}
    figure, axes = panels(1, 3, 3.6, sharey=True)
    for panel, (what, record) in zip(axes[0], picked.items(), strict=True):
        _hour(panel, found, record)
        panel.set(title=f"{what}: {record.name}, MAE {found.errors[record.name].mae:.3f}", xlabel="time, min")
    axes[0, 0].set_ylabel("opening, 1")
    legend_below(figure, axes[0, 0])
    return figure


def _hour(panel: Axes, found: ActuatorFit, record: Record) -> None:
    opening = found.modelled[record.name]
    length = min(len(opening), round(HOUR_S / record.interval_s))
    wrong = np.abs(opening - record.opening)
    starts = range(0, len(opening) - length + 1, max(1, length // 4))
    start = min(starts, key=lambda n: abs(float(wrong[n : n + length].mean()) - found.errors[record.name].mae))
    part = slice(start, start + length, max(1, round(2.0 / record.interval_s)))
    minutes = np.arange(len(opening))[part] * record.interval_s / 60.0
    on = record.on[part].astype(float)
    panel.plot(minutes, on, color=GREY, linestyle=DASHED, drawstyle="steps-post", label="heating signal")
    panel.plot(minutes, record.opening[part], color=BLACK, label="measured")
    panel.plot(minutes, opening[part], color=COLOURS[5], linewidth=1.6, label="modelled")
