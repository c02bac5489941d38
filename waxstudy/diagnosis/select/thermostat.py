"""A thermostat that does not switch where its reading says so: one such time is no chance."""

from __future__ import annotations

from math import exp, log

from waxstudy.diagnosis.calibration.healthy import Healthy
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.result import When
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin.hours import DAY_H, clock


def past_switch(problem: SegmentProblem, healthy: Healthy, fitted: Hypothesis) -> float:
    """Return by how much farther than usual a reading goes on past a switch, in standard deviations; else 0.

    Seconds tell little of a single switch: noise throws it by hours where a reading hardly moves. How far the reading
    went meanwhile does tell.
    """
    most_K, usual_K = problem.past_switch(fitted).reading_K, healthy.past_switch_K
    return log(most_K / usual_K) / WEIGHTS.coarse_scatter if most_K > usual_K > 0.0 else 0.0


def when_past_switch(problem: SegmentProblem, fitted: Hypothesis) -> When | None:
    """Return when a reading went on past a switch so far that this alone makes something unknown likely; else None."""
    past, record = problem.past_switch(fitted), problem.record
    least = exp(WEIGHTS.coarse_scatter * (2.0 * WEIGHTS.unknown_price) ** 0.5)
    if past.reading_K <= least * problem.noise_past_switch_K:
        return None
    hours = [place * record.interval_s / 3600.0 for place in (past.begin, past.end)]
    begin, end = (each + record.start_s / 3600.0 for each in hours)
    last = f"day {int(end // DAY_H) + 1} " if end // DAY_H > begin // DAY_H else ""
    words = f"from day {int(begin // DAY_H) + 1} {clock(begin)} to {last}{clock(end)}"
    told = f"{words}, when its reading went on {past.reading_K:.2g} K past where it switches"
    return When(told, [(hours[0], hours[1])])
