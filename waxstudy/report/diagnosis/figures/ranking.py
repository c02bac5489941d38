"""The ranking: every effect that was fitted, by how much of a gap it explains."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from waxstudy.diagnosis.result import Diagnosis, Tried
from waxstudy.report.diagnosis.words import chance, channel_words, percent, probability, stage_words
from waxstudy.report.figures.plot import Lacking, drawing, one_panel
from waxstudy.report.figures.style import BLACK, GREY, legend_of, name_rows

MOST = 24
BEST, ALIKE, OTHER = "found", "cannot be told from one that was found", "not found"
LOOKS: Mapping[str, Any] = {
    BEST: {"facecolor": BLACK, "edgecolor": BLACK},
    ALIKE: {"facecolor": "white", "edgecolor": BLACK, "hatch": "/////"},
    OTHER: {"facecolor": "white", "edgecolor": GREY},
}
RANGE = (-25.0, 110.0)  # %; beyond, the figure at the bar tells
ROOM_FOR_WORDS = 65.0  # % of a scale that is longer than its bars


@drawing(
    "ranking",
    "Every effect that was tried",
    "Share of the gap above the noise floor that each effect explains, alone and as large as it fits best; at the bar "
    "its probability. In a room without a baseline: on days that its fit has not seen, with its p over all effects "
    "tried (family-wise). Black: found. Hatched: in the group of one that was found, and not to be told from it with "
    "this record. White: not named, for the reason beside it. An effect that two measured channels can show stands "
    "twice, each with its channel.",
)
def figure_ranking(diagnosis: Diagnosis) -> Figure:
    """Shares explained [%] of the effects tried; raise `Lacking` where none could be."""
    if not diagnosis.tried:
        raise Lacking("no effect could be tried")
    shown = ranked(diagnosis)[:MOST]
    figure, panel = one_panel(1.0 + 0.27 * len(shown))
    for place, each in enumerate(shown):
        _bar(panel, place, each, role(diagnosis, each))
    panel.axvline(0.0, color=BLACK, linewidth=0.8)
    name_rows(panel, [label(diagnosis, each) for each in shown])
    panel.grid(axis="y", visible=False)
    first = RANGE[0] if any(each.share < 0.0 for each in shown) else 0.0
    panel.set(xlim=(first, RANGE[1] + ROOM_FOR_WORDS), xticks=range(int(first), 101, 25))
    panel.set_xlabel("share of the gap above the noise floor that is explained, %")
    roles = {role(diagnosis, each) for each in shown}
    legend_of(figure, [Patch(label=name, linewidth=0.9, **look) for name, look in LOOKS.items() if name in roles])
    return figure


def ranked(diagnosis: Diagnosis) -> list[Tried]:
    """The found ones, those like them, then the rest; each by the share explained."""
    roles = [BEST, ALIKE, OTHER]
    return sorted(diagnosis.tried, key=lambda each: (roles.index(role(diagnosis, each)), -each.share))


def label(diagnosis: Diagnosis, tried: Tried) -> str:
    """An effect with its stage; where it stands twice, also with its channel."""
    is_twice = sum(each.name == tried.name for each in diagnosis.tried) > 1
    channel = f", {channel_words(tried.channel)}" if is_twice and tried.channel else ""
    return f"{tried.name}  ({stage_words(tried.stage)}{channel})"


def role(diagnosis: Diagnosis, tried: Tried) -> str:
    """Whether an effect was found, cannot be told from one that was, or neither."""
    if any(tried.name == effect.name for effect in diagnosis.effects):
        return BEST
    return ALIKE if any(tried.name in effect.group for effect in diagnosis.effects) else OTHER


def _bar(panel: Axes, place: int, tried: Tried, role: str) -> None:
    share = min(max(100.0 * tried.share, RANGE[0]), RANGE[1])
    panel.barh(place, share, 0.66, linewidth=0.9, **LOOKS[role])
    text = chance(tried.probability) if math.isfinite(tried.probability) else f"p {probability(tried.p)}"
    text += "" if share == 100.0 * tried.share else f" (explains {percent(tried.share)})"
    text += f"; {tried.why}" if tried.why else ""
    panel.annotate(text, (max(share, 0.0), place), (5, 0), textcoords="offset points", va="center", fontsize=9.0)
