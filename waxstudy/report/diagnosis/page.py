"""A diagnosis as a page."""

from __future__ import annotations

from waxstudy.diagnosis.result import Diagnosis
from waxstudy.diagnosis.sentences import group_sentence
from waxstudy.report.diagnosis.figures import FIGURES
from waxstudy.report.diagnosis.summary import headline, how_sure, lines, quick_look
from waxstudy.report.diagnosis.tables import TABLES, parameters
from waxstudy.report.figures.plot import plots
from waxstudy.report.html import filled


def as_html(diagnosis: Diagnosis) -> str:
    """Return the diagnosis as one page, without links to outside and without scripts."""
    return filled(
        "diagnosis.html.j2",
        diagnosis=diagnosis,
        verdict=headline(diagnosis),
        quick=quick_look(diagnosis),
        lines=lines(diagnosis),
        figures=plots(FIGURES, diagnosis),
        effects=[
            (effect, group_sentence(effect), how_sure(effect), parameters(effect)) for effect in diagnosis.effects
        ],
        tables={table.__name__: table(diagnosis) for table in TABLES},
    )
