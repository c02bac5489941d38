"""What switches are weighed by: what noise does to them under the hypothesis that tells best when they were thrown.

A wrong one may be about to throw a switch for hours, which noise then decides; of a right one seconds are known.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.parameter_space import EffectType
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.residuals.switching import Switching


def has_times(problem: SegmentProblem) -> bool:
    """Whether something that runs on throws switches of a link."""
    segment, binary = problem.segment, problem.record.binary
    return not segment.with_room and segment.driven_by not in binary and any(each in binary for each in segment.judged)


def best_timed(problem: SegmentProblem, effects: Sequence[EffectType], thorough: float) -> Sequence[Hypothesis]:
    """Return hypotheses of at most one effect, the one under which the switches are likeliest first.

    Each is fitted as switches are weighed under what is believed, then weighed by what noise does under itself.
    """
    estimator = Estimator(problem, thorough)
    possible = [each for each in effects if not each.hindrance(problem.belief)]
    fits = [fitted for each in possible if (fitted := estimator.fit(each, estimator.base, ALL))]
    return sorted([estimator.base, *fits], key=lambda each: -_likelihood(problem, each))


def _likelihood(problem: SegmentProblem, fitted: Hypothesis) -> float:
    """Return the logarithm of how likely the switches are under a hypothesis, by its own noise."""
    own = problem.timed_by([fitted])
    seen = own.at(fitted.effects, fitted.departures, fitted.convention)
    if seen is None:
        return -np.inf
    ways = [way for way in own.judge.ways.values() if isinstance(way, Switching)]
    return sum(way.likelihood(seen.residual_of(way.channel).error) for way in ways)
