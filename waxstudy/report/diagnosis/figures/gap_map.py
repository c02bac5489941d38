"""The gap map: stages of the loop by regime, how far each is out of its noise and what share of the gap it holds."""

from __future__ import annotations

import math
import textwrap

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from waxstudy.diagnosis.result import Diagnosis, StageGap
from waxstudy.report.diagnosis.focus import left_at
from waxstudy.report.diagnosis.words import channel_words, percent, quantity, stage_words, times
from waxstudy.report.figures.plot import Lacking, drawing, one_panel
from waxstudy.report.figures.style import BLACK, GREY, legend_of

# from how many noise floors on, in which colour; one hue from light to dark, which grey print keeps
SHADES = (
    (0.0, "#ffffff", "below 1.5"),
    (1.5, "#d6e5f2", "1.5 to 3"),
    (3.0, "#9cc3e0", "3 to 6"),
    (6.0, "#4a90c4", "6 to 12"),
    (12.0, "#14507f", "12 or more"),
)
DARK_FROM = 6.0
MOST_REGIMES = 7
LETTERS = 13  # of a regime's name in a line
ROW_IN = 0.96


@drawing(
    "map",
    "The gap map: stages of the loop by regime",
    "A row for each judged channel, with the stages behind it; its gap as a whole, then by regime, the largest share "
    "first. Each field has the gap there in multiples of the noise floor, and its share of the row's squared gap; "
    "regimes may overlap. The darker, the further out of the noise. “No finding”: the form of the room's model, or "
    "within the published uncertainty of what is believed.",
)
def figure_gap_map(diagnosis: Diagnosis) -> Figure:
    """Gaps over their noise floors [-] and shares of the squared gap [%]; raise `Lacking` where nothing is judged."""
    if not diagnosis.stages:
        raise Lacking("no stage of the loop could be judged")
    figure, panel = one_panel(0.8 + ROW_IN * len(diagnosis.stages))
    for row, stage in enumerate(diagnosis.stages):
        _row(panel, row, stage)
    columns = 1 + max(min(MOST_REGIMES, len(stage.regimes)) for stage in diagnosis.stages)
    panel.set(xlim=(0.0, max(4, columns)), ylim=(len(diagnosis.stages), 0.0), xticks=[])
    places = [row + 0.5 for row in range(len(diagnosis.stages))]
    panel.set_yticks(places, [_label(diagnosis, stage) for stage in diagnosis.stages])
    panel.tick_params(length=0)
    panel.grid(False)
    panel.spines[:].set_visible(False)
    handles = [Patch(facecolor=colour, edgecolor=GREY, label=words) for _, colour, words in SHADES]
    legend_of(figure, handles, title="gap in multiples of the noise floor")
    return figure


def _label(diagnosis: Diagnosis, stage: StageGap) -> str:
    words = f"{textwrap.fill(stage_words(stage.stage), 24)}\n{channel_words(stage.channel)}"
    left = left_at(diagnosis, stage)
    is_explained = stage.gap_after < stage.gap
    return words if left is None or left.is_finding or is_explained else f"{words}\n(no finding)"


def _row(panel: Axes, row: int, stage: StageGap) -> None:
    whole = quantity(stage.gap, stage.unit)
    _field(panel, 0, row, "whole", stage.over_floor, whole, is_whole=True)
    for column, regime in enumerate(sorted(stage.regimes, key=lambda each: -each.share)[:MOST_REGIMES], start=1):
        over = stage.regime_over_floor(regime)
        _field(panel, column, row, regime.name, over, f"{percent(regime.share)} of it")


def _field(
    panel: Axes, column: int, row: int, name: str, over_floor: float, below: str, is_whole: bool = False
) -> None:
    edge, width = (BLACK, 1.4) if is_whole else (GREY, 0.7)
    place = (column + 0.03, row + 0.05)
    panel.add_patch(Rectangle(place, 0.94, 0.9, facecolor=shade(over_floor), edgecolor=edge, linewidth=width))
    ink = "white" if over_floor >= DARK_FROM else BLACK
    title = textwrap.fill(textwrap.shorten(name, 2 * LETTERS, placeholder="…"), LETTERS)
    for height, text, style in (
        (0.22, title, {"fontsize": 8.5, "linespacing": 1.05}),
        (0.53, _times(over_floor), {"fontsize": 11.0, "fontweight": "bold"}),
        (0.79, below, {"fontsize": 9.0}),
    ):
        panel.text(column + 0.5, row + height, text, ha="center", va="center", color=ink, **style)


def _times(over_floor: float) -> str:
    return f"{times(over_floor)} ×" if math.isfinite(over_floor) else "no floor"


def shade(over_floor: float) -> str:
    """The colour of a gap of so many noise floors."""
    return [colour for least, colour, _ in SHADES if over_floor >= least or least == 0.0][-1]
