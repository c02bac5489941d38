"""What switches and a controller's output are weighed by: what noise does to them under the likeliest hypothesis.

Under a wrong hypothesis a reading may lie at a threshold for hours, and noise decides when it switches. Under the right
one the time is known to seconds or minutes. An output that runs on moves with noise as far as the controller's gain.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.edits import EffectType
from waxstudy.diagnosis.model.room_response import Predicted
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.observations.record import OUTPUT
from waxstudy.diagnosis.residuals.room_means import RoomMeans
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.residuals.switching import Switching


def is_moved_by_noise(problem: SegmentProblem) -> bool:
    """Whether something that runs on throws switches of a link, or moves the output of a controller seen when healthy.

    Without a healthy record nobody knows what the controller's own reading of its sensor adds to that of the log.
    """
    segment, binary = problem.segment, problem.record.binary
    was_healthy = problem.as_built is not None and segment.name in problem.as_built.conventions
    moved = any(each in binary or (each == OUTPUT and was_healthy) for each in segment.judged)
    return not segment.with_room and segment.driven_by not in binary and moved


def best_timed(
    problem: SegmentProblem, effects: Sequence[EffectType], thorough: float
) -> tuple[Sequence[Hypothesis], Sequence[Predicted]]:
    """Return hypotheses of at most one effect, the one under which what noise moves is likeliest first, and its noise.

    Each is fitted as that is weighed under what is believed, then weighed by what noise does under itself.
    """
    estimator = Estimator(problem, thorough)
    possible = [each for each in effects if not each.hindrance(problem.belief)]
    fits = [fitted for each in possible if (fitted := estimator.fit(each, estimator.base, ALL))]
    likely: list[tuple[float, Hypothesis]] = []
    best: tuple[float, Sequence[Predicted]] = -np.inf, ()
    for each in (estimator.base, *fits):
        noisy = problem.noisy(each)
        likely.append((_likelihood(problem, each, noisy), each))
        if likely[-1][0] > best[0]:  # all of them would not lie in memory
            best = likely[-1][0], noisy
    return [each for _, each in sorted(likely, key=lambda pair: -pair[0])], best[1]


def _likelihood(problem: SegmentProblem, fitted: Hypothesis, noisy: Sequence[Predicted]) -> float:
    """Return the logarithm of how likely switches and output are under a hypothesis, weighed as `timed_by` has it."""
    judge = problem.timed_by([fitted], noisy).judge
    moved = (way for way in judge.ways.values() if not isinstance(way, RoomMeans))
    ways = [way for way in moved if isinstance(way, Switching) or way.channel == OUTPUT]
    if not all(way.draws for way in ways):
        return -np.inf
    errors = {each.channel: each.error for each in fitted.residuals}
    return sum(way.likelihood(errors[way.channel]) for way in ways) - 0.5 * fitted.convention.handicap
