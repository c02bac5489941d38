"""A diagnosis as one self-contained HTML page."""

from __future__ import annotations

from waxstudy.diagnosis.result import Diagnosis
from waxstudy.diagnosis.sentences import group_sentence
from waxstudy.report.diagnosis import tables
from waxstudy.report.diagnosis.figures import FIGURES, Plot
from waxstudy.report.diagnosis.summary import QUICK, VERDICTS, how_sure, lines
from waxstudy.report.figures.places import Lacking
from waxstudy.report.figures.style import svg_element
from waxstudy.report.page import PageFigure, PageTable, filled, page_table
from waxstudy.report.words import Table


def as_html(diagnosis: Diagnosis) -> str:
    """Return the diagnosis as one page, without links to outside and without scripts."""
    return filled(
        "diagnosis.html.j2",
        diagnosis=diagnosis,
        verdict=VERDICTS[diagnosis.verdict],
        quick=QUICK,
        lines=lines(diagnosis),
        figures={plot.id: _drawn(diagnosis, plot) for plot in FIGURES},
        effects=[
            (effect, group_sentence(effect), how_sure(effect), page_table(tables.parameters(effect)))
            for effect in diagnosis.effects
        ],
        tables={name: table for name, table in _tables(diagnosis).items() if table.rows},
    )


def _tables(diagnosis: Diagnosis) -> dict[str, PageTable]:
    made: dict[str, Table] = {
        "stages": tables.stages(diagnosis),
        "regimes": tables.regimes(diagnosis),
        "found": tables.found(diagnosis),
        "closed_loop": tables.closed_loop(diagnosis),
        "tried": tables.tried(diagnosis),
        "unexplained": tables.unexplained(diagnosis),
        "untestable": tables.untestable(diagnosis),
        "next": tables.next_measurements(diagnosis),
        "departures": tables.departures(diagnosis),
        "parts": tables.parts(diagnosis),
    }
    return {name: page_table(table) for name, table in made.items()}


def _drawn(diagnosis: Diagnosis, plot: Plot) -> PageFigure:
    id = f"figure-{plot.id}"
    try:
        return PageFigure(id, plot.title, plot.caption, svg_element(plot.draw(diagnosis), id))
    except Lacking as reason:
        return PageFigure(id, plot.title, "", "", str(reason))
