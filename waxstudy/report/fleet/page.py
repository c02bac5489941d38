"""The page of an activation: one self-contained HTML file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from waxstudy.fleet.result import Activated
from waxstudy.report.figures.plot import plots
from waxstudy.report.fleet import tables
from waxstudy.report.fleet.figures import figure_later, figure_response
from waxstudy.report.html import filled, told
from waxstudy.report.words import counted
from waxstudy.version import __version__


def as_html(found: Activated) -> str:
    """Return an activation as one page."""
    return filled(
        "activation.html.j2",
        found=found,
        said=found.said,
        loops=counted(int(found.said["loops"]), "loop"),
        rooms=counted(found.rooms, "room"),
        verdict=tables.verdict(found),
        tables=tables.tables(found),
        notes=tables.notes(found),
        states=list(_states(found)),
        figures=plots((figure_response, figure_later), found),
        provenance=told(found.provenance),
        version=__version__,
    )


def _states(found: Activated) -> Iterator[str]:
    for name, state in found.said["state"].items():
        before = f"kept off before the call for {_pause(state['pause_s'])}" if "pause_s" in state else "left to itself"
        heated = f", heated for {state['preheat_s']:g} s just before it" if state["preheat_s"] else ""
        yield f"State {name}: the chain of case {state['case']}, {before}{heated}."


def _pause(spread: Mapping[str, Any]) -> str:
    if "low" in spread:
        return f"{spread['low'] / 60.0:g} to {spread['high'] / 60.0:g} min"
    if "mean" in spread:
        return f"{spread['mean'] / 60.0:g} min on the mean (standard deviation {spread['sd'] / 60.0:g} min)"
    return f"{', '.join(f'{value / 60.0:g}' for value in spread['values'])} min"
