"""The figures of a diagnosis: where the gap lies, what explains it, how far it shrinks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from waxstudy.diagnosis.result import Diagnosis
from waxstudy.report.diagnosis.figures import departures, gap_map, ranking, traces, waterfall

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["FIGURES", "Plot"]


@dataclass(frozen=True)
class Plot:
    """A figure with its words; `draw` raises `Lacking` where the diagnosis lacks what it needs."""

    id: str
    title: str
    caption: str
    draw: Callable[[Diagnosis], Figure]


FIGURES: Sequence[Plot] = (
    Plot("map", gap_map.TITLE, gap_map.CAPTION, gap_map.figure_gap_map),
    Plot("traces", traces.TITLE, traces.CAPTION, traces.figure_traces),
    Plot("ranking", ranking.TITLE, ranking.CAPTION, ranking.figure_ranking),
    Plot("waterfall", waterfall.TITLE, waterfall.CAPTION, waterfall.figure_waterfall),
    Plot("departures", departures.TITLE, departures.CAPTION, departures.figure_departures),
)
