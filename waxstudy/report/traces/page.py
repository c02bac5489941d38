"""A page of traces: one file with plotly in it, that runs its own scripts alone and loads nothing."""

from __future__ import annotations

import base64
import hashlib
import re
from html import escape
from typing import Any

import numpy as np
import pandas as pd

from waxstudy.plugin import BackendMissing
from waxstudy.report.figures.breaks import LEVELS, broken
from waxstudy.report.figures.style import BLACK, COLOURS
from waxstudy.report.html import filled
from waxstudy.report.traces.lines import MOST_POINTS, Line, Panel, Traces, extremes
from waxstudy.report.words import capital
from waxstudy.study.visible import visible

LOOKS = (  # colour, dash, width: told apart in grey print as well
    (BLACK, "solid", 1.2),
    (COLOURS[5], "dash", 1.8),
    (COLOURS[1], "solid", 2.0),
    (COLOURS[2], "dot", 2.0),
    (COLOURS[0], "dashdot", 2.0),
    (COLOURS[3], "longdash", 2.0),
)
PANEL_PX, BETWEEN_PX, BUTTONS_PX, LEGEND_PX = 125, 62, 28, 70
PLACE = "<!-- traces -->"  # no name can hold it: the template escapes them
CONFIG = {
    "displaylogo": False,
    "responsive": True,
    "modeBarButtonsToRemove": ["select2d", "lasso2d", "toImage", "autoScale2d", "toggleHover"],
}


def as_html(traces: Traces) -> str:
    """Return the traces as one page; raise `BackendMissing` without plotly."""
    figure = _figure(traces)
    digests = (
        hashlib.sha256(each.encode()).digest() for each in re.findall(r"<script[^>]*>(.*?)</script>", figure, re.S)
    )
    page = filled(
        "traces.html.j2",
        traces=traces,
        most=MOST_POINTS // 2 if traces.longest > MOST_POINTS else 0,
        scripts=" ".join(f"'sha256-{base64.b64encode(digest).decode()}'" for digest in digests),
    )
    return page.replace(PLACE, figure, 1)


def _figure(traces: Traces) -> str:
    """The drawing with its library, as elements of a page."""
    try:
        from plotly import io
        from plotly.subplots import make_subplots
    except ImportError:
        raise BackendMissing("pages that zoom need plotly: pip install 'waxstudy[interactive]'") from None
    panels = traces.panels
    top = BUTTONS_PX + LEGEND_PX
    height = top + (PANEL_PX + BETWEEN_PX) * len(panels)
    figure = make_subplots(
        rows=len(panels),
        shared_xaxes=True,
        vertical_spacing=BETWEEN_PX / (height - top - BETWEEN_PX),
        subplot_titles=[_plain(f"{capital(panel.title)}, {panel.unit}") for panel in panels],
    )
    told: set[str] = set()
    for row, panel in enumerate(panels, 1):
        for line in panel.lines:
            figure.add_trace(_trace(panel, line, told), row=row, col=1)
    figure.update_annotations(x=0.0, xanchor="left", font_size=13, align="left")
    # as time alone zooms, a finger beside the panels still moves the page
    figure.update_yaxes(fixedrange=True, automargin=True, gridcolor="#dddddd", zeroline=False, nticks=5)
    figure.update_xaxes(type="date", gridcolor="#dddddd", showticklabels=True)
    figure.update_layout(
        height=height,
        margin={"l": 8, "r": 12, "t": top, "b": BETWEEN_PX},
        legend={"orientation": "h", "yref": "container", "y": 1.0 - BUTTONS_PX / height, "yanchor": "top", "x": 0.0},
        paper_bgcolor="#fff",
        plot_bgcolor="#fff",
        font={"family": "Liberation Sans, DejaVu Sans, sans-serif", "color": "#1a1a1a"},
        dragmode="zoom",
        hovermode="x unified",
        hoversubplots="axis",
    )
    return str(io.to_html(figure, CONFIG, full_html=False, include_plotlyjs=True, div_id="traces"))


def _trace(panel: Panel, line: Line, told: set[str]) -> dict[str, Any]:
    """A line as plotly has it; a name stands in the legend once."""
    stamps = pd.DatetimeIndex(line.known.index).tz_localize(None).as_unit("ms")
    times, values = broken(stamps.asi8.astype(np.float64), np.asarray(line.known, dtype=np.float64))
    kept = extremes(values)
    colour, dash, width = LOOKS[line.place % len(LOOKS)]
    is_new = line.name not in told and not line.is_dotted
    told.add(line.name)
    return {
        "type": "scatter",
        "mode": "lines",
        "name": _plain(line.name),
        "legendgroup": f"{line.place}",
        "showlegend": is_new,
        "x": times[kept],
        "y": values[kept].astype("float32"),
        "line": {
            "color": colour,
            "dash": "dot" if line.is_dotted else dash,
            "width": width,
            "shape": "vh" if line.known.nunique() <= LEVELS and not line.is_dotted else "linear",
        },
        "hovertemplate": "%{y:.3g}",
    }


def _plain(text: str) -> str:
    """Words for plotly, which would take some of them for markup."""
    return escape(visible(text))
