"""What nobody knows exactly of the room: how far the record moves it from what is believed."""

from __future__ import annotations

from matplotlib.figure import Figure

from waxstudy.diagnosis.result import Diagnosis
from waxstudy.report.diagnosis.words import departure
from waxstudy.report.figures.plot import Lacking, drawing, one_panel
from waxstudy.report.figures.style import BLACK, COLOURS

USUAL_SD = 2.0


@drawing(
    "departures",
    "What was adjusted of the room",
    "Departures of the room, of what drives it and of how it began from what is believed, in standard deviations of "
    "how well each is known beforehand. Within the grey band they are nothing to speak of; far outside, the room is "
    "not as described.",
)
def figure_departures(diagnosis: Diagnosis) -> Figure:
    """Departures [standard deviations]; raise `Lacking` where no room took part."""
    if not diagnosis.departures:
        raise Lacking("no room took part")
    names, values = list(diagnosis.departures), list(diagnosis.departures.values())
    figure, panel = one_panel(0.8 + 0.3 * len(names))
    panel.axvspan(-USUAL_SD, USUAL_SD, color="#e6e6e6", zorder=0.5)
    panel.axvline(0.0, color=BLACK, linewidth=0.8)
    for place, value in enumerate(values):
        panel.plot([0.0, value], [place, place], color=COLOURS[1], linewidth=2.2)
        panel.plot(value, place, "o", color=COLOURS[1], markersize=6)
        offset, side = ((7, 0), "left") if value >= 0.0 else ((-7, 0), "right")
        panel.annotate(departure(value), (value, place), offset, textcoords="offset points", va="center", ha=side)
    most = 1.25 * max(2.5, *(abs(value) for value in values))
    panel.set_xlim(-most, most)
    panel.set_yticks(range(len(names)), names)
    panel.set_ylim(len(names) - 0.5, -0.5)
    panel.grid(axis="y", visible=False)
    panel.set_xlabel("departure, standard deviations of what was known beforehand")
    return figure
