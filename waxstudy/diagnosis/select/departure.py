"""How far an effect is from what is believed, in steps that are worth a word."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from waxstudy.diagnosis.estimate.parameter_space import EffectType
from waxstudy.diagnosis.result import Interval
from waxstudy.plugin import Belief, Prior


def departure(effect: EffectType, values: Mapping[str, float], believed: Belief) -> float:
    """Return how far an effect is from what is believed, in noticeable steps of the parameter that is farthest.

    Infinite of an effect that is neutral nowhere, as another kind of motor.
    """
    neutral = effect.neutral(believed)
    if neutral is None or not effect.priors:
        return np.inf
    both = effect.priors.keys() & neutral.keys() & values.keys()
    return max((steps(effect.priors[name], values[name], neutral[name]) for name in both), default=0.0)


def distinct(effect: EffectType, intervals: Mapping[str, Interval], believed: Belief) -> float:
    """Return the same of the parameters whose interval leaves out what is believed."""
    neutral = effect.neutral(believed) or {}
    without = [name for name, each in intervals.items() if not each.low <= neutral.get(name, np.nan) <= each.high]
    return departure(effect, {name: intervals[name].value for name in without}, believed)


def steps(prior: Prior, value: float, still: float) -> float:
    """Return the distance of a value from a neutral one in noticeable steps."""
    if prior.is_log:
        return float(abs(np.log(value / still)) / np.log(prior.noticeable))
    return abs(value - still) / prior.noticeable
