"""Linearised loops as tables, JSON and a page."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from waxstudy.loop.loops import LoopRow
from waxstudy.report.figures.plot import Lacking, drawing, panels, plots
from waxstudy.report.figures.style import BLACK, COLOURS, DASHES, legend_of
from waxstudy.report.html import filled
from waxstudy.report.table import Column, Table, text
from waxstudy.report.words import yes_or_no
from waxstudy.version import __version__

SHOWN_H = (0.2, 48.0)  # periods that a figure shows: those of controllers in rooms
FIGURES = (
    "gain_margin",
    "phase_margin_deg",
    "limit_gain",
    "limit_period_h",
    "ultimate_gain",
    "ultimate_period_h",
    "output",
    "minimum_duty",
    "switches_per_day",
    "strokes_per_day",
)


@dataclass(frozen=True)
class Loops:
    """The loops of a study."""

    study: str
    rows: Sequence[LoopRow]

    @property
    def weeks(self) -> list[str]:
        return list(dict.fromkeys(row.week for row in self.rows))


def tables(found: Loops) -> list[Table[LoopRow]]:
    """A table for each week."""
    columns: list[Column[LoopRow]] = [
        text("case"),
        text("stable", lambda row: yes_or_no(row.is_stable), "verdict"),
        Column("gain_margin", None, ".2g", "gain margin"),
        Column("phase_margin_deg", None, ".0f", "phase margin", "°"),
        Column("limit_gain", None, ".2g", "limit gain", "1/K"),
        Column("limit_period_h", None, ".2f", "period", "h"),
        Column("ultimate_gain", None, ".2g", "P: ultimate gain", "1/K"),
        Column("ultimate_period_h", None, ".2f", "period", "h"),
        Column("output", None, ".2f", "at output"),
        Column("minimum_duty", None, ".2f", "least duty"),
        Column("switches_per_day", None, ".1f", "switches", "1/day"),
        Column("strokes_per_day", None, ".1f", "strokes", "1/day"),
    ]
    return [Table(week, columns, [row for row in found.rows if row.week == week]) for week in found.weeks]


def notes(found: Loops) -> list[str]:
    """How the figures are meant, and which are missing."""
    told: dict[str, list[str]] = {}
    for row in found.rows:
        if row.why:
            told.setdefault(row.why, []).append(row.case)
    missing = [f"{', '.join(dict.fromkeys(cases))}: {why}, so that there are no margins" for why, cases in told.items()]
    return [
        *missing,
        "limit gain: at which the loop just swings, the controller's other parameters as they are; P: the same of a "
        "proportional controller in its place",
        "at output: the constant output that would give the week's mean heat; the loop is linearised there",
        "least duty: the least constant output that lets water flow",
    ]


def as_json(found: Loops) -> dict[str, Any]:
    """Return all figures; what a case has not is null, and `why` says the reason."""
    return {
        "format": 1,
        "study": found.study,
        "loops": [
            {
                "case": row.case,
                "week": row.week,
                "stable": row.is_stable,
                **{name: getattr(row, name) for name in FIGURES},
                **({"why": row.why} if row.why else {}),
            }
            for row in found.rows
        ],
    }


@drawing(
    "bode",
    "The open loops",
    "Above: how much larger the reading swings than the error that makes it swing, over the period of the swing. "
    "Below: by how much it lags. A loop is stable if it passes on less than 1 (line) where the lag is 180° (line).",
)
def figure_bode(found: Loops) -> Figure:
    """Size and lag of each open loop, a column for each week."""
    figure, axes = panels(2, len(found.weeks), 6.4, sharex=True, sharey="row")
    handles: dict[str, Any] = {}
    cases = list(dict.fromkeys(row.case for row in found.rows if _open_loop(row) is not None))
    if not cases:
        raise Lacking("no case has a linear controller")
    for column, week in enumerate(found.weeks):
        for row in found.rows:
            open_loop = _open_loop(row)
            if row.week != week or open_loop is None or row.loop is None:
                continue
            place = cases.index(row.case)
            period_h = 2.0 * np.pi / row.loop.frequencies / 3600.0
            seen = (period_h > SHOWN_H[0]) & (period_h < SHOWN_H[1])
            lag = -np.degrees(np.unwrap(np.angle(open_loop)))
            look = {"color": COLOURS[place % len(COLOURS)], "linestyle": DASHES[place % len(DASHES)]}
            axes[0, column].plot(period_h[seen], np.abs(open_loop)[seen], **look)
            handles[row.case] = axes[1, column].plot(period_h[seen], lag[seen], label=row.case, **look)[0]
        axes[0, column].set(title=week, xscale="log", yscale="log")
        axes[0, column].axhline(1.0, color=BLACK, linewidth=0.8)
        axes[1, column].axhline(180.0, color=BLACK, linewidth=0.8)
        axes[1, column].set(xlabel="period of the swing, h", ylim=(60.0, 420.0), yticks=range(90, 421, 90))
        axes[1, column].xaxis.set_major_formatter("{x:g}")
        axes[0, column].tick_params(labelbottom=True)  # on a phone each panel stands alone
    axes[0, 0].set_ylabel("size of the open loop, 1")
    axes[1, 0].set_ylabel("lag, °")
    legend_of(figure, list(handles.values()))
    return figure


def _open_loop(row: LoopRow) -> Any:
    return row.loop.open_loop if row.loop else None


def summary(found: Loops) -> str:
    """Which loops are beyond the limit of stability, in one sentence."""
    told = list(_unstable(found))
    if not any(row.is_stable is not None for row in found.rows):
        return "No case has a linear loop."
    return f"Beyond the limit of stability: {'; '.join(told)}." if told else "Every linear loop is stable."


def _unstable(found: Loops) -> Iterator[str]:
    for week in found.weeks:
        cases = [
            f"{row.case} ({row.gain_margin:.2g})" if not math.isnan(row.gain_margin) else row.case
            for row in found.rows
            if row.week == week and row.is_stable is False
        ]
        if cases:
            yield f"{week}: {', '.join(cases)}"


def as_html(found: Loops) -> str:
    """Return the loops as one page."""
    return filled(
        "loops.html.j2",
        found=found,
        summary=summary(found),
        tables=tables(found),
        notes=notes(found),
        figures=plots((figure_bode,), found),
        version=__version__,
    )
