"""What the last step of a ladder changes on the days around the warmest hour of the second week."""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from waxstudy.report.content import Content
from waxstudy.report.figures import places
from waxstudy.report.figures.plot import Lacking, drawing, panels
from waxstudy.report.figures.style import BLACK, COLOURS, DASHED, legend_under
from waxstudy.study.model import Ladder

SHOWN_DAYS = 3


@drawing(
    "22",
    "Figure 22. The last step of each ladder in the second week",
    "The reference case (black) and the case one step simpler (orange) on the days around the warmest "
    "hour of the last week: air temperature (solid), operative temperature (dashed) and water flow; one "
    "member.",
)
def figure_22(content: Content) -> Figure:
    """Temperatures [°C] and flow [L/h] of the last step; raise `Lacking` for one week, one case, or no traces."""
    week = places.second_week(content)
    ladders = [ladder for ladder in content.run.ladders if places.one_simpler(ladder)]
    if not ladders:
        raise Lacking("no ladder has a step before its reference case")
    figure, axes = panels(2, len(ladders), 6.0, sharex=True, sharey="row", height_ratios=(2, 1))
    start_s = _warmest_s(places.trace(content, ladders[0].reference, week))
    for column, ladder in zip(axes.T, ladders, strict=True):
        _step(column, content, ladder, week, start_s)
    axes[0, 0].set_ylabel("temperature, °C")
    axes[1, 0].set_ylabel("water flow, L/h")
    figure.align_ylabels()
    return figure


def _warmest_s(frame: pd.DataFrame) -> float:
    """Start of the days to show, the warmest in their middle, as far as the week reaches [s]."""
    warmest_day = int(frame["time_s"].iloc[int(frame["operative_C"].argmax())] / places.DAY_S)
    last_start = int(frame["time_s"].iloc[-1] / places.DAY_S) - SHOWN_DAYS
    return places.DAY_S * max(0, min(warmest_day - SHOWN_DAYS // 2, last_start))


def _step(column: list[Axes], content: Content, ladder: Ladder, week: str, start_s: float) -> None:
    above, below = column
    simpler = places.one_simpler(ladder)
    assert simpler
    for case, colour in ((simpler, COLOURS[0]), (ladder.reference, BLACK)):
        frame = places.between(places.trace(content, case, week), start_s, start_s + SHOWN_DAYS * places.DAY_S)
        thin = places.every(frame, 180.0)
        above.plot(places.days(thin), thin["air_C"], color=colour, label=f"{case} air")
        above.plot(places.days(thin), thin["operative_C"], color=colour, linestyle=DASHED, label=f"{case} operative")
        _flow(below, places.steps(frame, "flow_L_h"), colour, filled=case == simpler)
    first = int(start_s / places.DAY_S)
    above.set_title(f"{ladder.name}, {week}")
    below.set(xlabel="time from the start of the week, days", xlim=(first, first + SHOWN_DAYS))
    below.set_xticks(range(first, first + SHOWN_DAYS + 1))
    legend_under(below, 1.0 / len(content.run.ladders), above.get_lines())


def _flow(panel: Axes, frame: pd.DataFrame, colour: str, filled: bool) -> None:
    """One case filled and the other as a line, so that both show where they overlap."""
    if filled:
        panel.fill_between(places.days(frame), frame["flow_L_h"], step="pre", color=colour, alpha=0.7, linewidth=0)
    else:
        panel.plot(places.days(frame), frame["flow_L_h"], color=colour, linewidth=0.9, drawstyle="steps-pre")
