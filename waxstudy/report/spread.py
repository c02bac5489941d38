"""How much of the spread of single runs is of their start, and how much of their weather."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy.report.comparison import CORRECTED, HEAT, differences_percent, member_values
from waxstudy.report.split import Split
from waxstudy.results.run import Run


@dataclass(frozen=True)
class Spread:
    """The split of one figure of a case in a week that has several weathers."""

    case: str
    week: str
    figure: str
    unit: str
    split: Split


def spreads(run: Run) -> list[Spread]:
    """Return the splits of mean error, heat difference and corrected heat difference; none of a single weather."""
    return [
        Spread(case, week, figure, unit, Split.of(values))
        for week in run.weeks
        for ladder in run.ladders
        for case in ladder.cases
        for figure, unit, values in _figures(run, case, ladder.reference, week)
        if values.ndim == 2 and np.isfinite(values).all()
    ]


def _figures(run: Run, case: str, reference: str, week: str) -> Iterator[tuple[str, str, FloatArray]]:
    yield "MAE", "K", member_values(run.kpis, case, week, "mae_K")
    if case != reference:
        yield "heat difference", "%", differences_percent(run.kpis, case, reference, week, HEAT)
        yield "corrected difference", "%", differences_percent(run.kpis, case, reference, week, CORRECTED)
