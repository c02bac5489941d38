"""The heating curve: supply water temperature by outdoor temperature."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from waxstudy.plugin import FloatArray, OutsideRoom, Room, WeatherRecord
from waxstudy.report.content import Content
from waxstudy.report.figures.places import trace
from waxstudy.report.figures.plot import Lacking, drawing, one_panel
from waxstudy.report.figures.style import BLACK, legend_under, series

OUTDOOR_C = np.linspace(-30.0, 20.0, 201)
MARKED = 20  # points of a week's part of the curve from one marker to the next


@drawing(
    "B1",
    "Figure B1. Heating curve",
    "Temperature of the supply water by that of the outdoor air, as the room of this study has it (black), and the "
    "part of it that each week uses, where the study keeps a trace.",
)
def figure_b1(content: Content) -> Figure:
    """Supply temperature [°C] over outdoor temperature [°C]; raise `Lacking` where only the engine knows it."""
    supply_C = _supply_C(content)
    figure, panel = one_panel(3.6)
    panel.plot(OUTDOOR_C, supply_C, color=BLACK, label=content.study.room.component.name)
    ladder = content.run.ladders[0]
    for place, week in enumerate(content.run.weeks):
        try:
            used = trace(content, ladder.reference, week)["supply_C"]
        except Lacking:
            continue
        inside = (supply_C >= used.min()) & (supply_C <= used.max())
        panel.plot(
            OUTDOOR_C[inside], supply_C[inside], label=week, linewidth=4.0, alpha=0.6, markevery=MARKED, **series(place)
        )
    panel.set(xlabel="outdoor temperature, °C", ylabel="supply temperature, °C", xlim=(OUTDOOR_C[0], OUTDOOR_C[-1]))
    legend_under(panel, 1.0)
    return figure


def _supply_C(content: Content) -> FloatArray:
    """Return what the room is supplied with at each outdoor temperature, without sun."""
    component = content.study.room.component
    assert issubclass(component, Room)
    if issubclass(component, OutsideRoom) and component.has_own_water:
        raise Lacking("the water is as warm as the model of this room says, not by a curve of the study")
    try:
        room = component.build(content.study.room.parameters)
        dark = {facade: np.zeros(len(OUTDOOR_C)) for facade in room.facades}
        return room.drive(WeatherRecord(3600.0, "2001-01-01", OUTDOOR_C, dark, OUTDOOR_C))[1]
    except Exception as error:  # a stranger's room may raise anything
        raise Lacking(f"the room does not say how warm its water is ({type(error).__name__}: {error})") from error
