"""All switchings laid over each other, from the moment at which the signal comes or goes."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from waxstudy.diagnosis.result import Diagnosis
from waxstudy.report.diagnosis.figures.traces import LOOKS
from waxstudy.report.diagnosis.focus import main_stages
from waxstudy.report.diagnosis.traced import TRACED, traced
from waxstudy.report.diagnosis.words import axis_unit, channel_words, named
from waxstudy.report.figures.plot import Lacking, drawing, panels
from waxstudy.report.figures.style import BLACK, GREY, legend_of

DRIVEN = ("displacement", "flow_L_h")  # what a switch moves within minutes
SIGNALS = ("heating_signal", "control_output")
BEFORE_MIN, AFTER_MIN = 2.0, 15.0  # what matters of a motor; a full stroke takes less than ten
LEAST = 3  # switchings


@drawing(
    "switchings",
    "All switchings, aligned",
    "What the signal moves, from the moment at which it comes (left) and goes (right). Thin lines: each switching as "
    "measured. Thick lines: medians of what was measured, believed, and found. A line that moves later is a dead time, "
    "one that is less steep a slower motor, one that ends elsewhere another flow.",
)
def figure_switchings(diagnosis: Diagnosis) -> Figure:
    """Raise `Lacking` where no signal or nothing that it moves was judged."""
    traces = diagnosis.traces
    signal = next((name for name in SIGNALS if _is_binary(traces, name)), None)
    channels = [name for name in DRIVEN if f"{name}_before" in traces and f"{name}_measured" in traces]
    shown = [stage.channel for stage in main_stages(diagnosis) if stage.channel in channels] or channels[:1]
    if signal is None or not shown:
        raise Lacking("no signal that only switches, or nothing that it moves within minutes, is in the record")
    step_min = _interval_min(traces)
    course = traces[f"{signal}_measured"].to_numpy(dtype=float)
    on = course > 0.5
    # what a gap hides is no switching
    changed = np.flatnonzero((np.diff(on.astype(int)) != 0) & np.isfinite(np.diff(course))) + 1
    starts = [changed[on[changed]], changed[~on[changed]]]
    if step_min > AFTER_MIN / LEAST or min(map(len, starts)) < LEAST:
        raise Lacking("the record is too coarse for minutes, or the signal hardly switches")
    figure, axes = panels(len(shown), 2, 0.9 + 2.3 * len(shown), sharex=True, sharey="row")
    for row, channel in zip(axes, shown, strict=True):
        for panel, places in zip(row, starts, strict=True):
            _draw(panel, traces, channel, places, step_min)
        row[0].set_ylabel(f"{channel_words(channel)}, {axis_unit(named(channel)[1])}")
        row[1].tick_params(labelleft=True)  # on a phone each panel stands alone
    for panel, places, what in zip(axes[0], starts, ("comes", "goes"), strict=True):
        panel.set_title(f"signal {what}: {len(places)} times")
    for panel in axes[-1]:
        panel.set(xlabel="minutes since then", xlim=(-BEFORE_MIN, AFTER_MIN))
    handles = {str(line.get_label()): line for line in axes[0, 0].get_lines() if line.get_label()[0] != "_"}
    legend_of(figure, list(handles.values()), handlelength=3.0)
    return figure


def _is_binary(traces: pd.DataFrame, name: str) -> bool:
    column = f"{name}_measured"
    return column in traces and set(traces[column].dropna().unique()) == {0.0, 1.0}


def _interval_min(traces: pd.DataFrame) -> float:
    return float(np.median(np.diff(traces.index)) / np.timedelta64(1, "m"))


def _draw(panel: Axes, traces: pd.DataFrame, channel: str, places: NDArray[np.int64], step_min: float) -> None:
    offsets = np.arange(-round(BEFORE_MIN / step_min), round(AFTER_MIN / step_min) + 1)
    inside = places[(places + offsets[0] >= 0) & (places + offsets[-1] < len(traces))]
    minutes = offsets * step_min
    for what, trace in traced(traces, channel).items():
        courses = trace.to_numpy(dtype=float)[inside[:, None] + offsets]  # (switchings, minutes)
        if what == "measured":
            panel.plot(minutes, courses.T, color=GREY, linewidth=0.5, alpha=0.5, label="_each")
        known = ~np.isnan(courses).all(axis=0)
        panel.plot(
            minutes[known],
            np.nanmedian(courses[:, known], axis=0),
            label=TRACED[what],
            **LOOKS[what] | {"linewidth": 2.0},
        )
    panel.axvline(0.0, color=BLACK, linewidth=0.8)
