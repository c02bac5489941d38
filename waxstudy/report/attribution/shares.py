"""Each step's share in what all steps of a ladder change: by the ladder's order, and averaged over all orders."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pandas as pd

from waxstudy.plugin import FloatArray
from waxstudy.report.attribution.shapley import Placement, Subset, order_count, placements, shapley
from waxstudy.report.attribution.simulate import simulate
from waxstudy.report.attribution.subsets import CannotAttribute, Subsets, subsets
from waxstudy.report.comparison import (
    CORRECTED,
    CORRECTED_DIFFERENCE,
    DIFFERENCE,
    Estimate,
    differences_percent,
    estimate,
    member_values,
)
from waxstudy.results.run import Run
from waxstudy.simulation.run import Progress
from waxstudy.study.model import Study

HEAT, PERCENT, SHIFT, MAE = "heat_kWh_m2_week", DIFFERENCE, "setpoint_shift_K", "mae_K"
FIGURES = (HEAT, PERCENT, CORRECTED_DIFFERENCE, SHIFT, MAE)


@dataclass(frozen=True)
class Share:
    """What one step adds to one figure; `least` and `most` are over all places that it can take in an order."""

    step: str
    in_ladder: Estimate
    order_free: Estimate
    of_its_place: Estimate  # in_ladder minus order_free, paired by member
    least: float
    most: float


@dataclass(frozen=True)
class Difference:
    """One figure's change from a ladder's first case to its last, and the steps' shares in it."""

    figure: str
    total: Estimate
    shares: Sequence[Share]
    means: Mapping[Subset, float]  # of the figure itself, for each set of steps

    @property
    def remainder(self) -> float:
        """What the order-free shares leave of the total: nothing but rounding."""
        return sum(share.order_free.mean for share in self.shares) - self.total.mean

    @property
    def lines(self) -> list[Share]:
        """The shares, and what they sum to."""
        nothing = Estimate(np.nan, np.nan, np.nan, np.nan)
        return [*self.shares, Share("total", self.total, self.total, nothing, np.nan, np.nan)]


@dataclass(frozen=True)
class Attribution:
    """One ladder in one week."""

    subsets: Subsets
    week: str
    orders: int
    differences: Mapping[str, Difference]
    hours_below: Mapping[Subset, float]  # per week, mean over the members, at each set's own setpoint shift
    residual_K: Mapping[Subset, float]  # what the search for that shift left, to first order

    @property
    def name(self) -> str:
        return f"{self.subsets.ladder.name}, {self.week}"


@dataclass(frozen=True)
class OrderFree:
    """The attribution of every ladder of a run, weeks first."""

    run: Run
    study: Study
    members: int
    attributions: Sequence[Attribution]

    @property
    def ladders(self) -> list[Subsets]:
        """The ladders, each once."""
        return [of.subsets for of in self.attributions if of.week == self.run.weeks[0]]


def attribute(run: Run, study: Study, progress: Progress | None = None) -> OrderFree:
    """Return the attribution of every ladder that has steps; what is missing is computed first.

    Raises `CannotAttribute`, `OtherSources`, and what a run raises.
    """
    ladders = [subsets(study, ladder) for ladder in study.ladders.values() if len(ladder.cases) > 1]
    if not ladders:
        raise CannotAttribute("no ladder of this study has a step")
    kpis = simulate(run, study, ladders, progress)
    found = [_attribution(kpis, ladder, week) for week in run.weeks for ladder in ladders]
    return OrderFree(run, study, run.members, found)


def _attribution(kpis: pd.DataFrame, of: Subsets, week: str) -> Attribution:
    places = placements(of.case)
    differences = {}
    for figure in FIGURES:
        known = {id: values_of(kpis, id, of.ladder.reference, week, figure) for id in set(of.case.values())}
        values = {chosen: known[id] for chosen, id in of.case.items()}
        differences[figure] = difference(figure, of.steps, places, values)
    hours, shift, alone = (
        {chosen: float(np.mean(member_values(kpis, id, week, column))) for chosen, id in of.case.items()}
        for column in ("hours_below_per_week", SHIFT, "single_run_shift_K")
    )
    residual = {chosen: alone[chosen] - shift[chosen] for chosen in of.case}
    return Attribution(of, week, order_count(of.case), differences, hours, residual)


def values_of(kpis: pd.DataFrame, case: str, reference: str, week: str, figure: str) -> FloatArray:
    """Return a case's figure for each member.

    Heat in percent is relative to the same member of the ladder's reference case. All members have one shift in
    common; the spread about it is that of the shifts which they would have needed alone.
    """
    if figure == PERCENT:
        return differences_percent(kpis, case, reference, week)
    if figure == CORRECTED_DIFFERENCE:
        return differences_percent(kpis, case, reference, week, CORRECTED)
    values = member_values(kpis, case, week, figure)
    if figure == SHIFT:
        alone = member_values(kpis, case, week, "single_run_shift_K")
        return values + alone - np.mean(alone)
    return values


def difference(
    figure: str, steps: Sequence[str], places: Sequence[Placement], values: Mapping[Subset, FloatArray]
) -> Difference:
    """Return the shares of the steps in one figure, from its values (members,) for each set of steps."""
    free = shapley(places, values)
    chain = [values[frozenset(range(n))] for n in range(len(steps) + 1)]
    in_ladder = [after - before for before, after in pairwise(chain)]
    shares = []
    for i, step in enumerate(steps):
        adds = [float(np.mean(place.marginal(values))) for place in places if place.step == i]
        ways = estimate(in_ladder[i]), estimate(free[i]), estimate(in_ladder[i] - free[i])
        shares.append(Share(step, *ways, min(adds), max(adds)))
    means = {chosen: float(np.mean(value)) for chosen, value in values.items()}
    return Difference(figure, estimate(chain[-1] - chain[0]), shares, means)
