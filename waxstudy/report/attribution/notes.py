"""What the reader of an attribution must know: that shares sum up, which orders count, and what weakens a share."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from waxstudy.report.attribution.shapley import Subset
from waxstudy.report.attribution.shares import PERCENT, Attribution, OrderFree
from waxstudy.report.attribution.subsets import Subsets, needs
from waxstudy.report.content import ALIKE
from waxstudy.report.words import counted
from waxstudy.results.comfort import OFF_COMFORT_H


def notes(found: OrderFree) -> list[str]:
    """Return one sentence each."""
    worst = max(abs(d.remainder) for of in found.attributions for d in of.differences.values())
    left = [1000.0 * abs(residual) for of in found.attributions for residual in of.residual_K.values()]
    said = [
        f"the order-free shares of the steps sum to the total difference; largest remainder {worst:.0e}",
        f"the search for equal comfort leaves {np.sqrt(np.mean(np.square(left))):.1f} mK in the shift of a case (root "
        f"mean square; at most {max(left):.1f} mK), which no interval holds: shares of that size say nothing",
    ]
    for subsets in found.ladders:
        said += _which_orders(subsets)
    if found.members == 1:
        said.append("one member per case: no spread, so no share can be called resolved")
    for of in found.attributions:
        said += _off_comfort(of, found.study.comfort.hours_below_per_week)
        said += _alike(of)
    return said


def _which_orders(subsets: Subsets) -> Iterator[str]:
    name, steps = subsets.ladder.name, subsets.steps
    idle = [step for step, edit in zip(steps, subsets.edits, strict=True) if not edit]
    if idle:
        yield f"{name}: changes nothing: {', '.join(idle)}"
    for step, before in zip(steps, needs(subsets.edits), strict=True):
        if before:
            yield f"{name}: {step} stays after {', '.join(steps[i] for i in sorted(before))}, whose block it changes"
    if subsets.refused:
        chosen, why = next(iter(subsets.refused.items()))
        left_out = counted(len(subsets.refused), "set")
        yield f"{name}: {left_out} of steps left out, e.g. {named(subsets, chosen)}: {why}"


def _off_comfort(of: Attribution, limit_h: float) -> Iterator[str]:
    """Cases that the setpoint shift did not bring to equal comfort."""
    off = {chosen: hours for chosen, hours in of.hours_below.items() if abs(hours - limit_h) > OFF_COMFORT_H}
    if off:
        cases = ", ".join(f"{named(of.subsets, chosen)} ({hours:.1f} h)" for chosen, hours in off.items())
        yield f"{of.name}: not at {limit_h:g} h below the limit: {cases}"


def _alike(of: Attribution) -> Iterator[str]:
    shares = of.differences[PERCENT].shares
    alike = [share.step for share in shares if share.order_free.sd < ALIKE and share.order_free.mean]
    if alike:
        alone = "all members meet in one course, so that the interval of the heat says nothing"
        yield f"{of.name}: {alone}: {', '.join(alike)}"


def named(subsets: Subsets, chosen: Subset) -> str:
    """The simplest case and the steps taken from it."""
    return " + ".join([subsets.ladder.cases[0], *(subsets.steps[step] for step in sorted(chosen))])
