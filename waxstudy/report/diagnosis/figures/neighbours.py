"""Rooms that depart from their neighbours: as measured, as expected, and when they depart."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from waxstudy.diagnosis.result import Diagnosis, NeighbourEvent, RoomCourse
from waxstudy.report.figures.plot import Lacking, drawing, panels
from waxstudy.report.figures.style import BLACK, COLOURS, DASHED, legend_below

COLDER, WARMER = "#9ecae1", "#fdd0a2"  # told apart by their hatching in grey print
MOST_DATES = 14  # below a panel
NUMBER = 0.045  # of a panel's width: what a number takes
PANEL_IN, ROOM_FOR_LEGEND_IN = 2.0, 0.8


@drawing(
    "rooms",
    "Rooms that depart from their neighbours",
    "Air of each room in which something departs: as measured (line), and as its neighbours, the weather, its own "
    "recorded heat and its ordinary day have it (dashed). Shaded: the hours in which it departs; hatched where it is "
    "warmer. Numbers are mean departures in kelvins, the largest where there is no room for all.",
)
def figure_neighbours(diagnosis: Diagnosis) -> Figure:
    """Air [°C] of each room with events by time [days]; `Lacking` where no room departs."""
    courses = diagnosis.neighbours.courses
    if not courses:
        raise Lacking("no room departs from its neighbours")
    figure, axes = panels(len(courses), 1, PANEL_IN * len(courses) + ROOM_FOR_LEGEND_IN, sharex=True)
    for panel, (name, course) in zip(axes[:, 0], courses.items(), strict=True):
        _room(panel, name, course, [each for each in diagnosis.neighbours.events if each.room == name])
    last = axes[-1, 0]
    last.set_xlabel("local standard time")
    _dates(last, pd.Timestamp(diagnosis.neighbours.begins), max(course.hours))
    _keys(last)
    legend_below(figure, last)
    return figure


def _room(panel: Axes, name: str, course: RoomCourse, events: Sequence[NeighbourEvent]) -> None:
    days = np.array(course.hours) / 24.0
    for each in events:
        is_colder = each.size_K.value < 0.0
        for begin, end in each.spans_h:
            look = {"facecolor": COLDER if is_colder else WARMER, "hatch": "" if is_colder else "////"}
            panel.axvspan(begin / 24.0, end / 24.0, edgecolor="white", linewidth=0.0, zorder=0, **look)  # type: ignore[arg-type]
    for place, size_K in numbered(events, float(days[-1])):
        _number(panel, place, size_K)
    panel.plot(days, course.expected_C, color=COLOURS[1], linestyle=DASHED, label="as its neighbours say")
    panel.plot(days, course.measured_C, color=BLACK, label="measured")
    panel.set(ylabel="air, °C", title=name, xlim=(0.0, days[-1]))
    panel.margins(y=0.15)


def numbered(events: Sequence[NeighbourEvent], days: float) -> list[tuple[float, float]]:
    """Return where numbers stand [days] and which [K]: the largest first, none too near to another or to an end."""
    found: list[tuple[float, float]] = []
    for each in sorted(events, key=lambda each: -abs(each.size_K.value)):
        for begin, end in each.spans_h:
            place = float(np.clip(0.5 * (begin + end) / 24.0, 0.5 * NUMBER * days, (1.0 - 0.5 * NUMBER) * days))
            if all(abs(place - other) >= NUMBER * days for other, _ in found):
                found.append((place, each.size_K.value))
    return found


def _number(panel: Axes, day: float, size_K: float) -> None:
    words = f"{size_K:+.1f}".replace("-", "−")
    panel.text(
        day, 0.98, words, transform=panel.get_xaxis_transform(), ha="center", va="top", fontsize=8.5, clip_on=True
    )


def _dates(panel: Axes, begins: pd.Timestamp, hours: float) -> None:
    """Name midnights by their day."""
    every = max(1, round(hours / 24.0 / MOST_DATES))
    midnights = pd.date_range(begins.ceil("D"), begins + pd.Timedelta(hours, "h"), freq=f"{every}D")
    places = [(each - begins).total_seconds() / 86_400.0 for each in midnights]
    is_of_years = midnights[0].year != midnights[-1].year
    panel.set_xticks(
        places, [f"{each.day} {each:%b}" + (f"\n{each.year}" if is_of_years else "") for each in midnights]
    )


def _keys(panel: Axes) -> None:
    """Add what shading means to the legend."""
    panel.fill_between([], [], [], facecolor=COLDER, label="colder")
    panel.fill_between([], [], [], facecolor=WARMER, hatch="////", edgecolor="white", label="warmer")
