"""A diagnosis as one self-contained HTML page."""

from __future__ import annotations

from waxstudy.gap.result import Diagnosis
from waxstudy.gap.told import told
from waxstudy.report.diagnosis import tables
from waxstudy.report.diagnosis.figures import FIGURES
from waxstudy.report.diagnosis.summary import QUICK, VERDICTS, how_sure, lines
from waxstudy.report.figures.plot import plots
from waxstudy.report.page import PageTable, filled, page_table
from waxstudy.report.words import Table


def as_html(diagnosis: Diagnosis) -> str:
    """Return the diagnosis as one page, without links to outside and without scripts."""
    return filled(
        "diagnosis.html.j2",
        diagnosis=diagnosis,
        verdict=VERDICTS[diagnosis.verdict],
        quick=QUICK,
        lines=lines(diagnosis),
        figures=plots(FIGURES, diagnosis),
        effects=[
            (effect, told(effect), how_sure(effect), page_table(tables.parameters(effect)))
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
