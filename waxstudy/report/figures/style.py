"""Colours, lines and legends that all figures share.

Colours are those of Okabe and Ito (2008), which colour-blind readers can tell apart; as grey print loses them,
every figure tells its lines apart by marker, dash or width as well.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from waxstudy.report.content import Content

BLACK, GREY = "#000000", "#8a8a8a"
COLOURS = ("#E69F00", "#0072B2", "#009E73", "#CC79A7", "#56B4E9", "#D55E00")
MARKERS = ("o", "s", "^", "D", "v", "P")
DASHED: Any = (0, (5, 2))
DASHES: tuple[Any, ...] = ("-", DASHED, (0, (1, 1.3)), (0, (6, 1.5, 1, 1.5)))
THICK = 2.2


def series(place: int) -> dict[str, Any]:
    """Colour and marker of the first, second, ... of several alike."""
    return {"color": COLOURS[place % len(COLOURS)], "marker": MARKERS[place % len(MARKERS)]}


def name_rows(panel: Axes, names: Sequence[str]) -> None:
    """Name the rows of a panel, the first at its top."""
    panel.set_yticks(range(len(names)), names)
    panel.set_ylim(len(names) - 0.4, -0.6)


def legend_of(figure: Figure, handles: Sequence[Any], **options: Any) -> None:
    """Put a legend in one row below the figure."""
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), **options)


def legend_below(figure: Figure, axes: Axes) -> None:
    """Put the legend of one panel, which stands for all, below the figure."""
    handles, labels = axes.get_legend_handles_labels()
    columns = _columns(labels, 1.0)
    figure.legend(handles, labels, loc="outside lower center", ncols=columns, handlelength=3.0)


def legend_under(axes: Axes, share: float, handles: Sequence[Any] | None = None) -> None:
    """Put a legend under one panel that takes a share of the figure's width."""
    handles = handles or axes.get_legend_handles_labels()[0]
    columns = _columns([str(handle.get_label()) for handle in handles], share)
    axes.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=4.0, ncols=columns)


def _columns(labels: Sequence[str], share: float) -> int:
    """As many columns as the longest label leaves room for, at 130 letters over the full width; rows filled."""
    most = max(1, min(len(labels), 6, int(130 * share / (max(map(len, labels)) + 9))))
    return math.ceil(len(labels) / math.ceil(len(labels) / most))


def look(content: Content, case: str) -> dict[str, Any]:
    """Colour, marker and width of a case by its place in its ladder; the reference is black and thick."""
    ladder = next(ladder for ladder in content.run.ladders if case in ladder.cases)
    if case == ladder.reference:
        return {"color": BLACK, "linewidth": THICK, "zorder": 3.0}
    return {**series(list(ladder.cases).index(case)), "markersize": 4.5}


def ladder_dash(content: Content, case: str) -> Any:
    """Line style of a case by the place of its ladder: the first solid, the second dashed."""
    place = next(i for i, ladder in enumerate(content.run.ladders) if case in ladder.cases)
    return DASHES[place % len(DASHES)]
