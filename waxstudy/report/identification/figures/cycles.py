"""Cycles as they were measured: the first against the following ones, and where the characteristic times are cut."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from waxstudy.identification.records import Record
from waxstudy.identification.result import ActuatorFit
from waxstudy.identification.times import TIMES
from waxstudy.report.figures.plot import Lacking, drawing, one_panel, panels
from waxstudy.report.figures.style import BLACK, COLOURS, DASHED, DASHES, legend_below

MOST_RECORDS = 6
MOST_CYCLES = 40
SHADES = dict(zip(TIMES, ("#56B4E9", "#E69F00", "#D55E00", "#CC79A7", "#009E73", "#0072B2"), strict=True))


@drawing(
    "periods",
    "The first period and the following ones (as the paper's figure 9)",
    "Opening since switching on, one record per exemplar in the profile that most of them share. Left the first "
    "period, which begins as cold as the motor happened to be; right the following ones, one upon the other.",
)
def figure_periods(found: ActuatorFit) -> Figure:
    """First and following periods of up to six exemplars."""
    records = _shared_profile(found)
    figure, axes = panels(1, 2, 4.2, sharey=True, sharex=True)
    for place, record in enumerate(records):
        own = found.cycles[found.cycles["record"] == record.name]
        look: dict[str, Any] = {"color": COLOURS[place], "linestyle": DASHES[place % len(DASHES)]}
        _draw_cycle(axes[0, 0], record, own.iloc[0], alpha=1.0, label=_name(record), **look)
        for _, cycle in own.iloc[1 : 1 + MOST_CYCLES].iterrows():
            _draw_cycle(axes[0, 1], record, cycle, alpha=0.35, **look)
    for panel, title in zip(axes[0], ("first period", "following periods"), strict=True):
        panel.set(title=title, xlabel="time since switching on, min")
    axes[0, 0].set_ylabel("opening, 1")
    legend_below(figure, axes[0, 0])
    return figure


def _shared_profile(found: ActuatorFit) -> list[Record]:
    """Return a record of each exemplar, in the profile that most exemplars have; raise `Lacking`."""
    usable = [record for record in found.records if (found.cycles["record"] == record.name).sum() > 1]
    if not usable:
        raise Lacking("no record has more than one cycle")

    def exemplars(profile: str) -> int:
        return len({(r.product, r.exemplar) for r in usable if r.profile == profile})

    profile = max((record.profile for record in usable), key=exemplars)
    first = {(r.product, r.exemplar): r for r in reversed(usable) if r.profile == profile}
    return sorted(first.values(), key=lambda r: (r.product, r.exemplar))[:MOST_RECORDS]


def _name(record: Record) -> str:
    return f"{record.product}{record.exemplar}" if record.exemplar != record.name else record.name


def _draw_cycle(panel: Axes, record: Record, cycle: pd.Series, **look: Any) -> None:
    start, end = _span(record, cycle)
    minutes = (np.arange(start, end) * record.interval_s - cycle["on_at_s"]) / 60.0
    every = max(1, round(5.0 / record.interval_s))
    panel.plot(minutes[::every], record.opening[start:end:every], **look)


def _span(record: Record, cycle: pd.Series) -> tuple[int, int]:
    """First and last sample of a cycle; what is unknown of its end is left out."""
    known = [cycle[name] for name in TIMES if np.isfinite(cycle[name])]
    length_s = float(np.sum(known)) if known else cycle["off_at_s"] - cycle["on_at_s"]
    start = max(0, int(cycle["on_at_s"] / record.interval_s))
    return start, min(len(record.opening), start + int(length_s / record.interval_s) + 1)


@drawing(
    "cut-offs",
    "Where the characteristic times are cut (as the paper's figure 10)",
    "The cycle of the record with the most cycles whose times lie nearest to their medians. Rise and fall are where "
    "the opening is steeper than 0.83 % up or 1.67 % down in 5 s; signal and opening tell the rest apart. Dashed: "
    "signal.",
)
def figure_cut_offs(found: ActuatorFit) -> Figure:
    """One cycle with its six times shaded."""
    record, cycle = _typical(found)
    start, end = _span(record, cycle)
    seconds = np.arange(start, end) * record.interval_s - cycle["on_at_s"]
    figure, panel = one_panel(3.6)
    at = 0.0
    for name in TIMES:
        length = float(cycle[name])  # a whole cycle has them all
        label = f"{name.removesuffix('_s')}: {length:.0f} s"
        panel.axvspan(at / 60.0, (at + length) / 60.0, color=SHADES[name], alpha=0.25, linewidth=0.0, label=label)
        at += length
    panel.plot(seconds / 60.0, record.opening[start:end], color=BLACK, label="opening")
    on = record.on[start:end].astype(float)
    panel.plot(seconds / 60.0, on, color=BLACK, linestyle=DASHED, drawstyle="steps-post", label="heating signal")
    title = f"{record.name}, cycle {cycle['cycle']}"
    panel.set(title=title, xlabel="time since switching on, min", ylabel="opening, 1")
    legend_below(figure, panel)
    return figure


def _typical(found: ActuatorFit) -> tuple[Record, pd.Series]:
    kept = found.cycles[(found.cycles["lost"] == "") & found.cycles["undercool_s"].notna()]
    if kept.empty:
        raise Lacking("no cycle is whole")
    name = kept["record"].value_counts().index[0]
    own = kept[kept["record"] == name]
    far = (own[list(TIMES)] - own[list(TIMES)].median()).abs().sum(axis=1)
    return next(r for r in found.records if r.name == name), own.loc[far.idxmin()]
