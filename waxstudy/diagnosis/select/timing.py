"""What switches are weighed by: what noise does to them under the hypothesis that tells best when they were thrown.

A wrong one may be about to throw a switch for hours, which noise then decides; of a right one seconds are known.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.parameter_space import EffectType
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.residuals.switching import Switching


def best_timed(problem: SegmentProblem, effects: Sequence[EffectType], thorough: float) -> Hypothesis | None:
    """Return the hypothesis of at most one effect under which the switches are likeliest; None where none is driven.

    Each is fitted to their times as if only sampling blurred them, then weighed by what noise does under itself.
    """
    segment, binary = problem.segment, problem.record.binary
    if segment.with_room or segment.driven_by in binary or not any(each in binary for each in segment.judged):
        return None
    return max(_tried(problem, effects, thorough), key=lambda each: _likelihood(problem, each))


def _tried(problem: SegmentProblem, effects: Sequence[EffectType], thorough: float) -> Iterator[Hypothesis]:
    estimator = Estimator(problem.timed_by(None), thorough)
    yield estimator.base
    for effect in effects:
        if not effect.hindrance(problem.belief) and (fitted := estimator.fit(effect, estimator.base, ALL)):
            yield fitted


def _likelihood(problem: SegmentProblem, fitted: Hypothesis) -> float:
    """Return the logarithm of how likely the switches are under a hypothesis, by its own noise."""
    own = problem.timed_by(fitted)
    seen = own.at(fitted.effects, fitted.departures, fitted.convention)
    if seen is None:
        return -np.inf
    ways = [way for way in own.judge.ways.values() if isinstance(way, Switching)]
    return sum(way.likelihood(seen.residual_of(way.channel).error) for way in ways)
