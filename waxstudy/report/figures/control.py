"""What becomes of the controller's output on its way to the flow."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from waxstudy.report.content import Content
from waxstudy.report.figures.places import DAY_S, HOUR_S, between, hours, rises, trace
from waxstudy.report.figures.plot import drawing, panels
from waxstudy.report.figures.style import BLACK, COLOURS
from waxstudy.study.model import Ladder

EXCERPT_H = 4
CHANNELS = (
    ("output", "controller\noutput, –"),
    ("signal", "signal to the\nactuator, –"),
    ("opening", "valve\nopening, –"),
    ("flow_L_h", "water flow,\nL/h"),
)


@drawing(
    "19",
    "Figure 19. From controller output to flow",
    "A few hours of the reference case of the ladder with modulation (else of the last ladder), in the "
    "first week and where the signal starts most often; one member, means over the interval of the trace.",
)
def figure_19(content: Content) -> Figure:
    """Output, signal, opening [-] and flow [L/h] of a few hours; raise `Lacking` without traces."""
    case, week = modulated(content).reference, content.run.weeks[0]
    whole = trace(content, case, week)
    start_s = busiest_s(whole)
    frame = between(whole, start_s, start_s + EXCERPT_H * HOUR_S)
    day = int(start_s / DAY_S)
    figure, axes = panels(len(CHANNELS), 1, 5.6, sharex=True)
    time_h = hours(frame, day * DAY_S)
    for i, (panel, (channel, label)) in enumerate(zip(axes[:, 0], CHANNELS, strict=True)):
        panel.fill_between(time_h, frame[channel], step="pre", color=COLOURS[i], alpha=0.25, linewidth=0)
        panel.plot(time_h, frame[channel], color=BLACK, drawstyle="steps-pre")
        panel.set_ylabel(label)
        panel.set_ylim(bottom=0.0, top=1.05 if channel != "flow_L_h" else None)
    axes[0, 0].set_title(f"{case}, {week}, day {day + 1}")
    hour = start_s / HOUR_S % 24
    axes[-1, 0].set(xlabel="time of the day, h", xlim=(hour, hour + EXCERPT_H))
    figure.align_ylabels()
    return figure


def modulated(content: Content) -> Ladder:
    """The last ladder whose reference case has a modulator, else the last ladder."""
    cases, ladders = content.study.cases, content.run.ladders
    found = [ladder for ladder in ladders if "modulator" in cases[ladder.reference].blocks]
    return (found or ladders)[-1]


def busiest_s(frame: pd.DataFrame) -> float:
    """Start of the excerpt with the most starts of the signal, at a full hour within one day [s]."""
    times_h = hours(frame)
    starts = times_h[rises(frame["signal"].to_numpy())]
    hour = np.arange(int(times_h[-1]))
    hour = hour[hour % 24 <= 24 - EXCERPT_H]
    counts = [np.sum((starts >= h) & (starts < h + EXCERPT_H)) for h in hour]
    return float(hour[int(np.argmax(counts))] * HOUR_S) if len(hour) else 0.0
