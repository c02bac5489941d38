"""Flow beside the modelled opening: a cycle over time, and the curve."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from waxstudy.identification.valve import ValveFit, curve
from waxstudy.report.figures.places import rises
from waxstudy.report.figures.plot import drawing, one_panel, panels
from waxstudy.report.figures.style import BLACK, COLOURS, DASHED, DASHES, GREY, legend_below, legend_under


@drawing(
    "cycle",
    "One cycle of flow (as the paper's figure 15)",
    "Heating signal, modelled opening, measured and modelled flow over full flow, of a cycle in the record's middle.",
)
def figure_cycle(found: ValveFit) -> Figure:
    """Four lines over one cycle."""
    on = found.record.on
    starts = rises(on.astype(float))
    middle = len(starts) // 2
    start = max(0, int(starts[middle]) - round(60.0 / found.record.interval_s))
    end = int(starts[middle + 1]) if middle + 1 < len(starts) else len(on)
    part = slice(start, end)
    minutes = (np.arange(len(on))[part] - starts[middle]) * found.record.interval_s / 60.0
    figure, panel = one_panel(3.8)
    panel.plot(minutes, on[part], color=GREY, linestyle=DASHED, drawstyle="steps-pre", label="heating signal")
    panel.plot(minutes, found.opening[part], color=COLOURS[1], linestyle=DASHES[3], label="modelled opening")
    panel.plot(minutes, found.flow[part], color=BLACK, label="measured flow")
    panel.plot(minutes, found.modelled_flow()[part], color=COLOURS[5], linewidth=1.8, label="modelled flow")
    panel.set(xlabel="time since switching on, min", ylabel="opening, flow over full flow, 1")
    legend_below(figure, panel)
    return figure


@drawing(
    "curve",
    "The valve's curve (as the paper's figure 16)",
    "Left: measured flow over the modelled opening (grey: excluded from the fit), the theoretical curve of three "
    "points (dashed) and the curve corrected by the authority. Right: modelled against measured flow of the samples "
    "that were considered.",
)
def figure_curve(found: ValveFit) -> Figure:
    """Curve and measured points; modelled against measured."""
    figure, axes = panels(1, 2, 4.4)
    left, right = axes[0]
    used, excluded = found.considered, ~found.record.missing & ~found.considered
    points = {"linestyle": "", "marker": ".", "markersize": 2.5}
    left.plot(found.opening[excluded], found.flow[excluded], color="#bbbbbb", label="excluded", **points)
    left.plot(found.opening[used], found.flow[used], color=COLOURS[1], label="measured", **points)
    h = np.linspace(0.0, 1.0, 501)
    h_min, h_mid, v_mid = (found.values[name].value for name in ("h_min", "h_mid", "v_mid"))
    left.plot(h, curve(h, h_min, h_mid, v_mid, 1.0), color=BLACK, linestyle=DASHED, label="theoretical curve")
    authority = found.values["authority"].value
    look = {"color": COLOURS[5], "linewidth": 1.8, "label": f"with authority {authority:.3f}"}
    left.plot(h, curve(h, h_min, h_mid, v_mid, authority), **look)
    left.set(xlabel="modelled opening, 1", ylabel="flow over full flow, 1")
    legend_under(left, 0.5)
    right.plot([0.0, 1.0], [0.0, 1.0], color=BLACK, linewidth=0.8)
    right.plot(found.flow[used], found.modelled_flow()[used], color=COLOURS[1], **points)
    right.set(xlabel="measured flow over full flow, 1", ylabel="modelled flow over full flow, 1")
    right.set_title(f"MAE {100.0 * found.mae:.2f} %")
    return figure
