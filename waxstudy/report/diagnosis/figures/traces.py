"""Measured, before and after: the worst and the typical day of the channels that matter most."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from waxstudy.diagnosis.result import Diagnosis, StageGap
from waxstudy.plugin import FloatArray
from waxstudy.report.diagnosis.focus import Day, main_stages, shown_days
from waxstudy.report.diagnosis.traced import TRACED, traced
from waxstudy.report.diagnosis.words import axis_unit, channel_words, named
from waxstudy.report.figures.breaks import LEVELS, broken
from waxstudy.report.figures.plot import Lacking, drawing, panels
from waxstudy.report.figures.style import BLACK, COLOURS, DASHED, legend_of

LOOKS: Mapping[str, dict[str, Any]] = {
    "measured": {"color": BLACK, "linewidth": 0.9},
    "before": {"color": COLOURS[5], "linewidth": 1.7, "linestyle": DASHED},
    "after": {"color": COLOURS[1], "linewidth": 1.5},
}


@drawing(
    "traces",
    "The worst and a typical day",
    "Measured, as believed, and with the effects found, if any, on the day on which what is believed misses the first "
    "channel most, and on a typical day (the middle of all days, ordered by that). Each channel is driven by what was "
    "measured before it in the loop; lines are broken where nothing is known, as a return without flow.",
)
def figure_traces(diagnosis: Diagnosis) -> Figure:
    """Traces of up to three channels over two days; raise `Lacking` where there is nothing to compare."""
    stages = [s for s in main_stages(diagnosis) if f"{s.channel}_before" in diagnosis.traces]
    days = shown_days(diagnosis, stages[0].channel) if stages else []
    if not days:
        raise Lacking("no channel was judged on a whole day")
    figure, axes = panels(len(stages), len(days), 1.1 + 2.3 * len(stages), sharex=True, sharey="row")
    for row, stage in zip(axes, stages, strict=True):
        for panel, day in zip(row, days, strict=True):
            _draw(panel, day, stage.channel)
        row[0].set_ylabel(_label(stage))
        for panel in row[1:]:
            panel.tick_params(labelleft=True)  # on a phone each panel stands alone
    for panel, day in zip(axes[0], days, strict=True):
        panel.set_title(f"{day.what}, {day.date}")
    for panel in axes[-1]:
        panel.set(xlabel="time of the day, h", xticks=range(0, 25, 3), xlim=(0, 24))
    # what any panel shows: not every channel is changed by the effects
    handles = {str(line.get_label()): line for panel in axes.flat for line in panel.get_lines()}
    legend_of(figure, list(handles.values()), handlelength=3.0)
    figure.align_ylabels()
    return figure


def _label(stage: StageGap) -> str:
    unit = named(stage.channel)[1]  # that of the channel; the gap of one that switches is in seconds
    return f"{textwrap.fill(channel_words(stage.channel), 20)}, {axis_unit(unit)}"


def _draw(panel: Axes, day: Day, channel: str) -> None:
    for what, trace in traced(day.traces, channel).items():
        known = trace.dropna()
        steps = "steps-pre" if known.nunique() <= LEVELS else "default"
        panel.plot(*course(known), label=TRACED[what], drawstyle=steps, **LOOKS[what])


def course(known: pd.Series[float]) -> tuple[FloatArray, FloatArray]:
    """Hours and values of a line, which is broken where nothing was recorded or modelled for long."""
    return broken(_hours(known), np.asarray(known, dtype=float))


def _hours(known: pd.Series[float]) -> FloatArray:
    """Hours of the day; midnight ends it."""
    stamps = pd.DatetimeIndex(known.index)
    hours = np.asarray((stamps - stamps.normalize()) / pd.Timedelta(1, "h"), dtype=float)
    return np.where(hours == 0.0, 24.0, hours)
