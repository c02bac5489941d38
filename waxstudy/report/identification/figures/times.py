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


def _kept(found: ActuatorFit) -> pd.DataFrame:
    """The cycles that are used, with the exemplar that each is of."""
    kept = found.cycles[found.cycles["lost"] == ""]
    return kept.assign(motor=kept["product"] + " " + kept["exemplar"])


def _looks(found: ActuatorFit) -> Mapping[str, dict[str, Any]]:
    """A colour and marker for each exemplar."""
    names = sorted({f"{record.product} {record.exemplar}" for record in found.records})
    return {name: series(i) for i, name in enumerate(names)}


@drawing(
    "times",
    "Characteristic times and their models (as the paper's figure 11)",
    "A point per cycle: dead and rise time over the undercooling time before, hold and fall time over the "
    "overheating time. Lines: the fitted models, as far as the records reach; a level line is a constant.",
)
def figure_times(found: ActuatorFit) -> Figure:
    """Four panels, one per time."""
    figure, axes = panels(2, 2, 7.0)
    kept = _kept(found)
    for panel, (name, time) in zip(axes.flat, found.model.times.items(), strict=True):
        _points(panel, found, kept, name, kept[f"{name}_s"].to_numpy())
        for place, product in enumerate(found.model.products):
            _curve(panel, time, product, kept[kept["product"] == product], DASHES[place % len(DASHES)])
        panel.set(ylabel=f"{name} time, s", ylim=(0.0, None))
    legend_below(figure, axes[0, 0])
    return figure


def _points(panel: Axes, found: ActuatorFit, kept: pd.DataFrame, name: str, values: FloatArray) -> None:
    before = kept[BEFORE[name]]
    for motor, look in _looks(found).items():
        own = ((kept["motor"] == motor) & before.notna()).to_numpy()
        style = {"linestyle": "", "markersize": 3.5, "alpha": 0.6, **look}
        panel.plot(before.to_numpy()[own] / 60.0, values[own], label=f"motor {motor}", **style)
    panel.set_xlabel(AXIS[BEFORE[name]])


def _curve(panel: Axes, time: TimeModel, product: str, own: pd.DataFrame, dash: Any) -> None:
    before = own[BEFORE[time.name]].dropna()
    if before.empty:
        return
    x: FloatArray = np.linspace(before.min(), before.max(), 200)
    look = {"color": BLACK, "linestyle": dash, "linewidth": 1.6, "label": f"model of {product}"}
    panel.plot(x / 60.0, _modelled_s(time, product, x), **look)


def _modelled_s(time: TimeModel, product: str, before_s: FloatArray) -> FloatArray:
    """Return a product's time after each time before."""
    curve, shape = time.curves[product], TIMES[time.name][0]
    f = shape(before_s, np.array([curve.tau_s.value]))[0] if shape else np.zeros_like(before_s)
    return np.asarray(curve.a_s.value * f + curve.b_s.value)


@drawing(
    "residuals",
    "What the models leave",
    "Measured less modelled, for the same cycles; a trend here would be something that the models miss.",
)
def figure_residuals(found: ActuatorFit) -> Figure:
    figure, axes = panels(1, 4, 3.2)
    kept = _kept(found)
    for panel, (name, time) in zip(axes[0], found.model.times.items(), strict=True):
        left = kept[f"{name}_s"].to_numpy(dtype=float, copy=True)
        for product in found.model.products:
            rows = (kept["product"] == product).to_numpy()
            left[rows] -= _modelled_s(time, product, kept[BEFORE[name]].to_numpy(dtype=float)[rows])
        _points(panel, found, kept, name, left)
        panel.axhline(0.0, color=BLACK, linewidth=0.8)
        panel.set_title(f"{name} time, s")
    legend_below(figure, axes[0, 0])
    return figure


@drawing(
    "activation",
    "Full activation and deactivation (as the paper's figure 12)",
    "Dead plus rise time, and hold plus fall time, of every cycle that was used, record by record. Dashed: 5 min, "
    "within which a valve must open for the reserve that the paper has in mind.",
)
def figure_activation(found: ActuatorFit) -> Figure:
    """A column of points per record."""
    kept, looks = _kept(found), _looks(found)
    names = [record.name for record in found.records if (kept["record"] == record.name).any()]
    figure, axes = panels(2, 1, 5.4, sharex=True)
    pairs = (("full activation", "dead_s", "rise_s"), ("deactivation", "hold_s", "fall_s"))
    for panel, (title, first, second) in zip(axes[:, 0], pairs, strict=True):
        for place, name in enumerate(names):
            own = kept[kept["record"] == name]
            look = {"linestyle": "", "markersize": 3.0, **looks[own["motor"].iloc[0]]}
            spread = np.linspace(-0.25, 0.25, len(own)) if len(own) > 1 else 0.0
            panel.plot(place + spread, (own[first] + own[second]) / 60.0, **look)
        panel.set(ylabel=f"{title}, min", ylim=(0.0, None))
    axes[0, 0].axhline(LIMIT_S / 60.0, color=BLACK, linestyle=DASHED)
    axes[1, 0].set_xticks(range(len(names)), names, rotation=60, ha="right")
    return figure
