"""The characteristic times over what was before, with the fitted curves; their residuals; full activation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from waxstudy.identification.actuator import TIMES
from waxstudy.identification.models import TimeModel
from waxstudy.identification.result import LIMIT_S, ActuatorFit
from waxstudy.plugin import FloatArray
from waxstudy.report.figures.plot import drawing, panels
from waxstudy.report.figures.style import BLACK, DASHED, DASHES, legend_below, series

BEFORE = {"dead": "before_s", "rise": "before_s", "hold": "overheat_s", "fall": "overheat_s"}
AXIS = {"before_s": "undercooling time before, min", "overheat_s": "overheating time, min"}


def motors(found: ActuatorFit) -> Mapping[str, dict[str, Any]]:
    """A colour and marker for each exemplar."""
    names = sorted({_motor(row) for row in found.records})
    return {name: series(i) for i, name in enumerate(names)}


def _motor(row: Any) -> str:
    return f"{row.product} {row.exemplar}"


@drawing(
    "times",
    "Characteristic times and their models (as the paper's figure 11)",
    "A point per cycle: dead and rise time over the undercooling time before, hold and fall time over the "
    "overheating time. Lines: the fitted models, as far as the records reach; a level line is a constant.",
)
def figure_times(found: ActuatorFit) -> Figure:
    """Four panels, one per time."""
    figure, axes = panels(2, 2, 7.0)
    kept = found.cycles[found.cycles["lost"] == ""]
    for panel, (name, time) in zip(axes.flat, found.model.times.items(), strict=True):
        _points(panel, found, kept, name, kept[f"{name}_s"].to_numpy())
        for place, product in enumerate(found.model.products):
            _curve(panel, time, product, kept[kept["product"] == product], DASHES[place % len(DASHES)])
        panel.set_ylabel(f"{name} time, s")
        panel.set_ylim(bottom=0.0)
    legend_below(figure, axes[0, 0])
    return figure


def _points(panel: Axes, found: ActuatorFit, kept: pd.DataFrame, name: str, values: FloatArray) -> None:
    before = BEFORE[name]
    for motor, look in motors(found).items():
        own = (kept["product"] + " " + kept["exemplar"] == motor).to_numpy() & kept[before].notna().to_numpy()
        minutes = kept[before].to_numpy()[own] / 60.0
        panel.plot(minutes, values[own], linestyle="", markersize=3.5, alpha=0.6, label=f"motor {motor}", **look)
    panel.set_xlabel(AXIS[before])


def _curve(panel: Axes, time: TimeModel, product: str, own: pd.DataFrame, dash: Any) -> None:
    curve, shape, before = time.curves[product], TIMES[time.name][0], own[BEFORE[time.name]].dropna()
    if before.empty:
        return
    x: FloatArray = np.linspace(before.min(), before.max(), 200)
    f = shape(x, np.array([curve.tau_s.value]))[0] if shape else np.zeros_like(x)
    label = f"model of {product}"
    panel.plot(x / 60.0, curve.a_s.value * f + curve.b_s.value, color=BLACK, linestyle=dash, linewidth=1.6, label=label)


@drawing(
    "residuals",
    "What the models leave",
    "Measured less modelled, for the same cycles; a trend here would be something that the models miss.",
)
def figure_residuals(found: ActuatorFit) -> Figure:
    figure, axes = panels(1, 4, 3.2)
    for panel, (name, time) in zip(axes[0], found.model.times.items(), strict=True):
        kept = found.cycles[found.cycles["lost"] == ""]
        predicted = np.full(len(kept), np.nan)
        for product in found.model.products:
            rows = (kept["product"] == product).to_numpy()
            predicted[rows] = _predicted(time, product, kept[rows])
        _points(panel, found, kept, name, kept[f"{name}_s"].to_numpy() - predicted)
        panel.axhline(0.0, color=BLACK, linewidth=0.8)
        panel.set_title(f"{name} time, s")
    legend_below(figure, axes[0, 0])
    return figure


def _predicted(time: TimeModel, product: str, own: pd.DataFrame) -> FloatArray:
    curve, (shape, before) = time.curves[product], TIMES[time.name]
    if shape is None:
        return np.full(len(own), curve.b_s.value)
    f = shape(own[before].to_numpy(dtype=float), np.array([curve.tau_s.value]))[0]
    if curve.form == "constant":
        return np.full(len(own), curve.b_s.value)
    return np.asarray(curve.b_s.value + curve.a_s.value * f)


@drawing(
    "activation",
    "Full activation and deactivation (as the paper's figure 12)",
    "Dead plus rise time, and hold plus fall time, of every cycle that was used, record by record. Dashed: 5 min, "
    "within which a valve must open for the reserve that the paper has in mind.",
)
def figure_activation(found: ActuatorFit) -> Figure:
    """A column of points per record."""
    kept = found.cycles[found.cycles["lost"] == ""]
    names = [record.name for record in found.records if (kept["record"] == record.name).any()]
    figure, axes = panels(2, 1, 5.4, sharex=True)
    pairs = (("full activation", "dead_s", "rise_s"), ("deactivation", "hold_s", "fall_s"))
    looks = motors(found)
    for panel, (title, first, second) in zip(axes[:, 0], pairs, strict=True):
        for place, name in enumerate(names):
            own = kept[kept["record"] == name]
            look = looks[f"{own['product'].iloc[0]} {own['exemplar'].iloc[0]}"]
            spread = place + np.linspace(-0.25, 0.25, len(own)) if len(own) > 1 else np.array([float(place)])
            panel.plot(spread, (own[first] + own[second]) / 60.0, linestyle="", markersize=3.0, **look)
        panel.set_ylabel(f"{title}, min")
        panel.set_ylim(bottom=0.0)
    axes[0, 0].axhline(LIMIT_S / 60.0, color=BLACK, linestyle=DASHED)
    axes[1, 0].set_xticks(range(len(names)), names, rotation=60, ha="right")
    return figure
