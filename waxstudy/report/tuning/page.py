"""The page of a tuning: one self-contained HTML file."""

from __future__ import annotations

from waxstudy.report.figures.plot import plots
from waxstudy.report.html import filled
from waxstudy.report.tuning import tables
from waxstudy.report.tuning.figures import figure_landscape, figure_tested
from waxstudy.tuning.fragment import fragment
from waxstudy.tuning.tune import Tuned
from waxstudy.version import __version__


def as_html(found: Tuned) -> str:
    """Return a tuning as one page."""
    return filled(
        "tuning.html.j2",
        found=found,
        verdict=tables.verdict(found),
        tables=tables.tables(found),
        figures=plots((figure_landscape, figure_tested), found),
        fragment=fragment(found),
        notes=[*tables.notes(found), *found.warnings],
        version=__version__,
    )
