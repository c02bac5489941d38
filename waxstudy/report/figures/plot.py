"""A figure from its drawing to a page: its words, its size, the look that all share, and the way to SVG."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.text import Text

from waxstudy.study.visible import visible_lines

WIDTH_IN = 11.0  # the width of the page's text: at 100 % a point of a figure is a point on the page
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
    "lines.linewidth": 1.2,
    "path.simplify_threshold": 0.25,
    "svg.fonttype": "path",
    "svg.hashsalt": "waxstudy",
}
POINTS = 72.0  # to an inch
MARGIN_PT = 3.0
Shown = TypeVar("Shown")  # what a figure is drawn of


class Lacking(Exception):
    """A figure cannot be drawn; the message says what is missing."""


@dataclass(frozen=True)
class Plot:
    """A figure of a page: its title is its alternative text as well; one without SVG says what is missing."""

    id: str
    title: str
    caption: str
    svg: str
    missing: str = ""
    size: tuple[float, float] = (0.0, 0.0)  # of the whole, in its own unit
    parts: Sequence[str] = ()  # `viewBox`es of panels and legends, which a phone shows one by one


@dataclass(frozen=True)
class Drawing(Generic[Shown]):
    """How a figure is drawn, and its words; `draw` raises `Lacking` where what is shown has not what it needs."""

    name: str
    title: str
    caption: str
    draw: Callable[[Shown], Figure]

    def __call__(self, shown: Shown) -> Figure:
        """Draw in the common look, whatever the reader's own matplotlib settings are."""
        with rc_context(RC):
            return self.draw(shown)

    def plot(self, shown: Shown) -> Plot:
        """Return the figure as it is put on a page."""
        id = f"figure-{self.name}"
        try:
            figure = self(shown)
            svg = _svg(figure, id)
            size = figure.get_figwidth() * POINTS, figure.get_figheight() * POINTS
            return Plot(id, self.title, self.caption, svg, size=size, parts=_parts(figure))
        except Lacking as reason:
            return Plot(id, self.title, self.caption, "", str(reason))


def drawing(name: str, title: str, caption: str) -> Callable[[Callable[[Shown], Figure]], Drawing[Shown]]:
    """Give a function that draws a figure its words."""
    return lambda draw: Drawing(name, title, caption, draw)


def plots(
    drawings: Sequence[Drawing[Shown]], shown: Shown, told: Callable[[float], None] = lambda share: None
) -> dict[str, Plot]:
    """Return figures by their names; `told` hears after each which share of them is drawn."""
    found = {}
    for number, each in enumerate(drawings, 1):
        found[each.name] = each.plot(shown)
        told(number / len(drawings))
    return found


class Shows(Figure):
    """A figure that a notebook shows as the value of a cell, without pyplot."""

    def _repr_png_(self) -> bytes:
        out = io.BytesIO()
        with rc_context(RC), _any_script():
            self.savefig(out, format="png", dpi=POINTS)
        return out.getvalue()


def panels(rows: int, columns: int, height_in: float, **options: Any) -> tuple[Figure, Any]:
    """Return a figure over the full width of the page and its axes (rows, columns)."""
    figure = Shows(figsize=(WIDTH_IN, height_in), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, **options)
    for panel in axes.flat:
        panel.tick_params(labelleft=True)  # on a phone each panel stands alone
    return figure, axes


def one_panel(height_in: float) -> tuple[Figure, Axes]:
    """Return such a figure with a single panel."""
    figure, axes = panels(1, 1, height_in)
    return figure, axes[0, 0]


@contextmanager
def _any_script() -> Iterator[None]:
    """A name in another script gets boxes, and no warning."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from font")
        yield


def _svg(figure: Figure, prefix: str) -> str:
    """Return the figure as an element of a page, the same for the same figure; the prefix keeps ids apart."""
    for words in figure.findobj(Text):  # names may hold anything: no formulas, and nothing that no font has a sign for
        words.set_text(visible_lines(words.get_text()))
        words.set_parse_math("$" not in words.get_text())
    out = io.StringIO()
    with rc_context(RC), _any_script():
        # `savefig` would draw once more, for the layout alone; this leaves the figure at 72 dpi
        FigureCanvasSVG(figure).print_svg(out, metadata={"Date": None})  # type: ignore[no-untyped-call]
    text = re.sub(r"\s*<metadata>.*?</metadata>", "", out.getvalue(), flags=re.S)
    element = re.sub(r"\sxmlns(:\w+)?=\"[^\"]*\"", "", text[text.index("<svg") :])
    element = element.replace("<svg ", '<svg id="whole" ', 1)
    return re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{prefix}-", element)


def _parts(figure: Figure) -> list[str]:
    """Where the panels, from the top left on, and the legend lie in a figure that was drawn.

    Each as a `viewBox`: x, y, width, height.
    """
    with _any_script():
        drawn = sorted(figure.axes, key=lambda panel: (-panel.get_position().y1, panel.get_position().x0))
        boxes = [panel.get_tightbbox() for panel in drawn] + [each.get_window_extent() for each in figure.legends]
    scale, height = POINTS / figure.dpi, figure.get_figheight() * POINTS
    found = []
    for box in filter(None, boxes):
        x, top = box.x0 * scale - MARGIN_PT, height - box.y1 * scale - MARGIN_PT
        sides = x, top, box.width * scale + 2 * MARGIN_PT, box.height * scale + 2 * MARGIN_PT
        found.append(" ".join(f"{side:.1f}" for side in sides))
    return found
