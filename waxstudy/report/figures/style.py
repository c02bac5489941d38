"""The look that all figures share: sizes, colours, line styles, and the way to SVG.

Colours are those of Okabe and Ito (2008), which colour-blind readers can tell apart; as grey print loses them,
every figure tells its lines apart by marker, dash or width as well.
"""

from __future__ import annotations

import functools
import io
import math
import re
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

from waxstudy.report.content import Content

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH_IN = 11.0  # the width of the page's text: at 100 % a point of a figure is a point on the page
BLACK, GREY = "#000000", "#8a8a8a"
COLOURS = ("#E69F00", "#0072B2", "#009E73", "#CC79A7", "#56B4E9", "#D55E00")
MARKERS = ("o", "s", "^", "D", "v", "P")
DASHED: Any = (0, (5, 2))
DASHES: tuple[Any, ...] = ("-", DASHED, (0, (1, 1.3)), (0, (6, 1.5, 1, 1.5)))
THIN, THICK = 1.2, 2.2
RC: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 9.5,
    "axes.titlesize": 10.5,
    "axes.titlelocation": "left",
    "axes.labelsize": 9.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "xtick.labelsize": 9.0,
    "ytick.labelsize": 9.0,
    "legend.fontsize": 9.5,
    "legend.frameon": False,
    "lines.linewidth": THIN,
    "path.simplify_threshold": 0.25,
    "svg.fonttype": "path",
    "svg.hashsalt": "waxstudy",
}

Draw = Callable[[Content], "Figure"]
Shown = TypeVar("Shown")  # what a figure is drawn of


def styled(draw: Callable[[Shown], Figure]) -> Callable[[Shown], Figure]:
    """Draw in this look, whatever the reader's own matplotlib settings are."""

    @functools.wraps(draw)
    def with_style(content: Shown) -> Figure:
        from matplotlib import rc_context

        with rc_context(RC):
            return draw(content)

    return with_style


def panels(rows: int, columns: int, height_in: float, **options: Any) -> tuple[Figure, Any]:
    """Return a figure over the full width of the page and its axes (rows, columns)."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH_IN, height_in), layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False, **options)


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
    place = list(ladder.cases).index(case)
    return {"color": COLOURS[place % len(COLOURS)], "marker": MARKERS[place % len(MARKERS)], "markersize": 4.5}


def ladder_dash(content: Content, case: str) -> Any:
    """Line style of a case by the place of its ladder: the first solid, the second dashed."""
    place = next(i for i, ladder in enumerate(content.run.ladders) if case in ladder.cases)
    return DASHES[place % len(DASHES)]


def svg_document(figure: Figure) -> str:
    """Return the figure as the text of an SVG file; the same figure gives the same text."""
    from matplotlib import rc_context

    out = io.StringIO()
    with rc_context(RC):
        figure.savefig(out, format="svg", metadata={"Date": None})
    return re.sub(r"\s*<metadata>.*?</metadata>", "", out.getvalue(), flags=re.S)


def svg_element(figure: Figure, prefix: str) -> str:
    """Return the figure as an SVG element of a page; the prefix keeps ids of several figures apart."""
    text = svg_document(figure)
    element = re.sub(r"\sxmlns(:\w+)?=\"[^\"]*\"", "", text[text.index("<svg") :])
    return re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{prefix}-", element)
