"""The record at a glance: what was recorded when, and which days served for what."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from waxstudy.diagnosis.observations.record import DAY_S, settling_s
from waxstudy.diagnosis.result import Diagnosis
from waxstudy.report.diagnosis.words import channel_words
from waxstudy.report.figures.plot import Lacking, drawing, one_panel
from waxstudy.report.figures.style import COLOURS, GREY, legend_of, name_rows

LOOKS = {  # of a sample, and by grey print of its height
    "judged": (COLOURS[1], 0.7),
    "recorded, not judged": (COLOURS[4], 0.3),
}
HOURS = 1.0  # a piece of a bar


@drawing(
    "record",
    "The record, and what of it was judged",
    "A row for each channel: high where samples were judged, low where they were only recorded (the first hours, "
    "and where nothing is modelled beside them), nothing where none is known.",
)
def figure_record(diagnosis: Diagnosis) -> Figure:
    """Raise `Lacking` without traces."""
    traces = diagnosis.traces
    channels = [stage.channel for stage in diagnosis.stages if f"{stage.channel}_measured" in traces]
    if not channels or len(traces) < 2:
        raise Lacking("no channel was judged")
    figure, panel = one_panel(1.1 + 0.3 * len(channels))
    days = (pd.DatetimeIndex(traces.index) - traces.index[0]) / pd.Timedelta(1, "D")
    pieces = np.floor(np.asarray(days) * 24.0 / HOURS)
    settling_d = settling_s(len(traces) * float(days[1]) * DAY_S) / DAY_S
    is_settled = np.asarray(days) >= settling_d
    for row, channel in enumerate(channels):
        known = traces[f"{channel}_measured"].notna()
        is_beside = traces[f"{channel}_before"].notna() if f"{channel}_before" in traces else False
        modelled = known & is_beside & is_settled
        for mask, (colour, height) in ((modelled, LOOKS["judged"]), (known & ~modelled, LOOKS["recorded, not judged"])):
            _bar(panel, row, pieces[mask.to_numpy()], colour, height)
    name_rows(panel, [channel_words(channel) for channel in channels])
    panel.set(xlabel=f"days since {traces.index[0]:%Y-%m-%d %H:%M}", xlim=(0.0, float(days[-1])))
    panel.grid(axis="y", visible=False)
    for boundary in np.arange(0.0, float(days[-1])):
        panel.axvline(boundary, color=GREY, linewidth=0.3)
    legend_of(figure, [Patch(color=colour, label=label) for label, (colour, _) in LOOKS.items()])
    return figure


def _bar(panel: Axes, row: int, pieces: np.ndarray, colour: str, height: float) -> None:
    """Pieces of an hour in which at least a sample is, joined where they follow each other."""
    there = np.unique(pieces)
    if not len(there):
        return
    first = there[np.concatenate([[True], np.diff(there) > 1.0])]
    last = there[np.concatenate([np.diff(there) > 1.0, [True]])]
    spans = [(begin * HOURS / 24.0, (end - begin + 1.0) * HOURS / 24.0) for begin, end in zip(first, last, strict=True)]
    panel.broken_barh(spans, (row - height / 2.0, height), facecolors=colour)
