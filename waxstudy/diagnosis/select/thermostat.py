"""A thermostat that does not switch where its reading says so: one such time is no chance."""

from __future__ import annotations

from math import exp, log

from waxstudy.diagnosis.calibration.healthy import Healthy
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.residuals.switching import Past
from waxstudy.diagnosis.result import When
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin.hours import DAY_H, clock

MOST_TIMES = 3  # chosen: that are told by day and clock, so that a line holds them


def past_switch(problem: SegmentProblem, healthy: Healthy, fitted: Hypothesis) -> float:
    """Return by how much farther than usual a reading goes on past a switch, in standard deviations; else 0.

    Seconds tell little of a single switch: noise throws it by hours where a reading hardly moves. How far the reading
    went meanwhile does tell.
    """
    most_K = max((each.reading_K for each in problem.past_switch(fitted)), default=0.0)
    usual_K = healthy.past_switch_K
    return log(most_K / usual_K) / WEIGHTS.coarse_scatter if most_K > usual_K > 0.0 else 0.0


def when_past_switch(problem: SegmentProblem, fitted: Hypothesis) -> When | None:
    """Return when a reading went on past a switch so far that this alone makes something unknown likely; else None."""
    least_K = exp(WEIGHTS.coarse_scatter * (2.0 * WEIGHTS.unknown_price) ** 0.5) * problem.noise_past_switch_K
    times = [each for each in problem.past_switch(fitted) if each.reading_K > least_K]
    if not times:
        return None
    farthest = sorted(sorted(times, reverse=True)[:MOST_TIMES], key=lambda each: each.begin)
    rest = f" and {len(times) - MOST_TIMES} more times" if len(times) > MOST_TIMES else ""
    words = ", ".join(_from_to(problem.record, each) for each in farthest)
    far = f"{'up to ' if len(times) > 1 else ''}{max(each.reading_K for each in times):.2g} K"
    hours = problem.record.interval_s / 3600.0
    told = f"{words}{rest}, when its reading went on {far} past where it switches"
    return When(told, [(each.begin * hours, each.end * hours) for each in times])


def _from_to(record: Record, past: Past) -> str:
    """Return when a reading went on, by day and clock."""
    begin, end = ((record.start_s + place * record.interval_s) / 3600.0 for place in (past.begin, past.end))
    last = f"day {int(end // DAY_H) + 1} " if end // DAY_H > begin // DAY_H else ""
    return f"from day {int(begin // DAY_H) + 1} {clock(begin)} to {last}{clock(end)}"
