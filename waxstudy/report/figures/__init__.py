"""The figures of a report: the comparison at a glance, and seven figures of the paper redrawn from the run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from waxstudy.report.figures import activation, control, last_step, loads, overview, temperatures
from waxstudy.report.figures.activation import figure_12
from waxstudy.report.figures.control import figure_19
from waxstudy.report.figures.last_step import figure_22
from waxstudy.report.figures.loads import figure_21
from waxstudy.report.figures.overview import figure_overview
from waxstudy.report.figures.places import Lacking
from waxstudy.report.figures.style import Draw, svg_document, svg_element
from waxstudy.report.figures.temperatures import figure_17, figure_18, figure_20

__all__ = [
    "OVERVIEW",
    "PAPER_FIGURES",
    "Lacking",
    "Plot",
    "figure_12",
    "figure_17",
    "figure_18",
    "figure_19",
    "figure_20",
    "figure_21",
    "figure_22",
    "figure_overview",
    "svg_document",
    "svg_element",
]


@dataclass(frozen=True)
class Plot:
    """A figure with its words; `draw` raises `Lacking` where the study lacks what it needs."""

    id: str
    title: str
    caption: str
    draw: Draw


OVERVIEW = Plot("overview", overview.TITLE, overview.CAPTION, figure_overview)
# ids are the paper's numbers
PAPER_FIGURES: Sequence[Plot] = (
    Plot("12", activation.TITLE, activation.CAPTION, figure_12),
    Plot("17", temperatures.TITLE_17, temperatures.CAPTION_17, figure_17),
    Plot("18", temperatures.TITLE_18, temperatures.CAPTION_18, figure_18),
    Plot("19", control.TITLE, control.CAPTION, figure_19),
    Plot("20", temperatures.TITLE_20, temperatures.CAPTION_20, figure_20),
    Plot("21", loads.TITLE, loads.CAPTION, figure_21),
    Plot("22", last_step.TITLE, last_step.CAPTION, figure_22),
)
