"""The response of a fleet over time: heat and flow while it is called, and what comes back of it later."""

from __future__ import annotations

from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from waxstudy.fleet.result import Activated
from waxstudy.report.figures.plot import drawing, panels
from waxstudy.report.figures.style import COLOURS, DASHES, GREY, MARKERS, legend_of

MOST = 3  # calls that are drawn beside each other


@drawing(
    "response",
    "The fleet's response",
    "Above: heat per loop beyond what the loops take without the call. Below: flow, as a share of that of all valves "
    "open. Bands hold 95 % of other fleets of as many loops, drawn from the same distributions. The grey line is the "
    "limit. Of more than three calls the first three are shown.",
)
def figure_response(found: Activated) -> Figure:
    """Heat and flow over the time of the call, a column for each call."""
    shown = _calls(found)
    figure, axes = panels(2, len(shown), 6.2, sharex=True, sharey="row")
    loops = int(found.said["loops"])
    for column, (title, rows) in enumerate(shown):
        rows = rows[rows["added_W"].notna()]
        _lines(axes[0, column], found, rows, "added_W", 1.0 / loops)
        _lines(axes[1, column], found, rows, "flow_share", 100.0)
        axes[0, column].set_title(title)
        axes[1, column].set(xlabel="time after the call, min", ylim=(-3.0, 103.0))
        for panel in axes[:, column]:
            panel.axvline(found.said["limit_s"] / 60.0, color=GREY, linewidth=2.0, zorder=1.0)
            panel.tick_params(labelbottom=True)
    axes[0, 0].set_ylabel("more heat than without\nthe call, W per loop")
    axes[1, 0].set_ylabel("flow, % of full")
    legend_of(figure, _legend(found))
    return figure


@drawing(
    "later",
    "During the call and after it",
    "Heat per loop beyond what the loops take without the call, in means over 5 min, from the call on (shaded). Below "
    "zero the fleet gives back what it took. Bands as above.",
)
def figure_later(found: Activated) -> Figure:
    """Heat over the hours after the call."""
    shown = _calls(found)
    figure, axes = panels(1, len(shown), 3.8, sharex=True, sharey="row")
    loops = int(found.said["loops"])
    for column, (title, rows) in enumerate(shown):
        panel = axes[0, column]
        _lines(panel, found, rows[rows["later_W"].notna()], "later_W", 1.0 / loops, 3600.0)
        panel.axvspan(0.0, found.said["lasts_s"] / 3600.0, color=GREY, alpha=0.25, linewidth=0.0)
        panel.axhline(0.0, color=GREY, linewidth=0.8)
        panel.set(title=title, xlabel="time after the call, h")
    axes[0, 0].set_ylabel("more heat than without\nthe call, W per loop")
    legend_of(figure, _legend(found))
    return figure


def _calls(found: Activated) -> list[tuple[str, pd.DataFrame]]:
    response = found.response
    weeks = response["week"].nunique() > 1
    calls = [
        (str(rows["week"].iloc[0]), float(rows["at_h"].iloc[0]), rows)
        for _, rows in response.groupby(["week", "at_h"], sort=False)
    ]
    calls.sort(key=lambda call: [row.week for row in found.rows].index(call[0]))
    return [(f"{week}, " * weeks + _clock(at_h), rows) for week, at_h, rows in calls[:MOST]]


def _clock(at_h: float) -> str:
    day, rest = divmod(round(at_h * 60.0), 1440)
    return f"called on day {day + 1} at {rest // 60:02d}:{rest % 60:02d}"


def _states(found: Activated) -> list[str]:
    return list(found.said["state"])


def _look(place: int) -> dict[str, Any]:
    return {"color": COLOURS[(place + 1) % len(COLOURS)], "linestyle": DASHES[place % len(DASHES)]}


def _mark(place: int) -> dict[str, Any]:
    return {"marker": MARKERS[place % len(MARKERS)], "markersize": 4.5}


def _lines(panel: Axes, found: Activated, rows: pd.DataFrame, name: str, times: float, unit_s: float = 60.0) -> None:
    for place, state in enumerate(_states(found)):
        of = rows[rows["state"] == state]
        time = of["time_s"] / unit_s
        look = _look(place)
        panel.fill_between(
            time, times * of[f"{name}_low"], times * of[f"{name}_high"], color=look["color"], alpha=0.22, linewidth=0.0
        )
        every = (3 * place, max(1, len(of) // 6))
        panel.plot(time, times * of[name], **look, **_mark(place), markevery=every, linewidth=1.4)


def _legend(found: Activated) -> list[Line2D]:
    return [Line2D([], [], label=state, **_look(place), **_mark(place)) for place, state in enumerate(_states(found))]
