"""An effect tried at a segment, and whether it may be claimed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.noise_floor import NoiseFloor
from waxstudy.diagnosis.estimate.parameter_space import EffectType
from waxstudy.diagnosis.residuals.judge import SELECT
from waxstudy.diagnosis.result import in_floors
from waxstudy.diagnosis.select.criteria import EXPLAINED, Needs
from waxstudy.plugin import Belief, Prior

LEVEL = 0.01  # family-wise, over the effects of a segment
LEAST_GAIN = 10.0  # whitened
LEAST_PART = 0.15  # of a gap, that one of two effects must explain alone
ALIKE = 9.0  # difference of loss at which two effects cannot be told apart, in units of what is left
NOISE_ONLY = 1.03  # left over the floor, at which nothing but noise is left
SAME = 1e-6  # share of a gain that is but rounding


@dataclass(frozen=True)
class Candidate:
    """An effect tried on top of a model: fitted on the first part, judged on the second."""

    effect: EffectType
    fitted: Hypothesis
    gain: float  # loss that it takes away on the second part, but for what the drive's noise adds to it
    loss: float  # on both parts, likewise
    strain: float  # squares of how far the room had to depart from what is believed, in standard deviations
    p: float  # family-wise
    share: float  # of the gap above the floor, of the channel where it acts most, on the second part
    plain_share: float  # the same of residual in the channel's unit
    left: float  # whitened gap that is left of that channel, over its floor
    missed: float  # the same, in standard deviations
    channel: str  # where it acts most
    spread: float  # of the room's form by what is left of it here, in units of what it may leave; 1 in a chain
    over: float  # the gap of that channel before it, over the floor of both models, in the channel's unit
    needs: Needs
    is_covered: bool  # by what real actuators are known to stray from the believed one
    is_worth_naming: bool  # far enough from what is believed

    @property
    def is_seen(self) -> bool:
        return self.p <= LEVEL and self.gain >= LEAST_GAIN * self.spread

    @property
    def is_part(self) -> bool:
        """Whether it may be one of two effects that explain a gap together."""
        return self.is_seen and self.over >= self.needs.gap and self.share >= LEAST_PART and not self.is_covered

    @property
    def is_slight(self) -> bool:
        """Whether it explains its channel, but is too small to be named."""
        return self.is_seen and self.left <= EXPLAINED and not self.is_worth_naming

    @property
    def is_accepted(self) -> bool:
        is_gap = self.over >= self.needs.gap and self.left <= self.needs.left
        is_shared = self.share >= self.needs.share and self.plain_share >= self.needs.plain_share
        return self.is_seen and is_gap and is_shared and self.is_worth_naming and not self.is_covered

    @property
    def why_not(self) -> str:
        """Why it may not be claimed, by the first condition that it does not meet; empty where it may."""
        if self.is_accepted:
            return ""
        reasons = {
            "may be chance": self.p > LEVEL,
            "hardly better than without": not self.is_seen,
            "real motors stray as much": self.is_covered,
            "the gap is within noise": self.over < self.needs.gap,
            "too slight to be named": not self.is_worth_naming,
        }
        return next((reason for reason, holds in reasons.items() if holds), "explains too little")


def best_of(candidates: Sequence[Candidate]) -> Candidate:
    """Return the candidate that gains most; of those that gain the same but for rounding, the first by name.

    One with fewer parameters that leaves no more than noise is better: more of them follow what sampling blurs.
    """
    most = max(c.gain for c in candidates)
    best = min((c for c in candidates if c.gain >= most * (1.0 - SAME)), key=lambda c: c.effect.name)
    even = [c for c in candidates if c.left <= NOISE_ONLY and len(c.effect.priors) < len(best.effect.priors)]
    return min(even, key=lambda c: (len(c.effect.priors), -c.gain, c.effect.name), default=best)


def alike(best: Candidate, candidates: Sequence[Candidate]) -> tuple[str, ...]:
    """Return the effects that cannot be told from the best one on what it was chosen by, the best first."""
    left = max(1.0, best.missed) ** 2 * best.spread

    def worse(other: Candidate) -> float:
        return other.loss + other.strain - best.loss - best.strain

    others = sorted((c for c in candidates if c.effect is not best.effect and c.is_seen), key=worse)
    return (best.effect.name, *(c.effect.name for c in others if worse(c) <= ALIKE * left))


def is_worth_naming(effect: EffectType, values: Mapping[str, float], believed: Belief) -> bool:
    """Whether a parameter lies farther from what is believed than what the effect calls noticeable."""
    neutral = effect.neutral(believed)
    if neutral is None or not effect.priors:
        return True
    both = effect.priors.keys() & neutral.keys()
    return any(departs(effect.priors[name], values[name], neutral[name]) for name in both)


def departs(prior: Prior, value: float, still: float) -> bool:
    """Whether a value is off a neutral one by more than is noticeable."""
    if prior.is_log:
        return max(value / still, still / value) > prior.noticeable
    return abs(value - still) > prior.noticeable


def over_floor(current: Hypothesis, channel: str, floor: NoiseFloor, is_slight: bool) -> float:
    """Return a channel's gap over a floor, in its unit; of a slight gain in what runs on also weighed as residual are.

    A model that passes less noise on misses less, right or wrong: the gap must stand out of its own model's floor too.
    """
    residual = current.residual_of(channel)
    if residual.unit == "s" or not is_slight:
        return in_floors(residual.gap(SELECT), floor.plain[channel])
    weighed = float(np.sqrt(residual.loss(SELECT) / max(1, int(np.sum(residual.judged & (residual.part == SELECT))))))
    pairs = ((residual.gap(SELECT), floor.plain[channel]), (weighed, floor.white[channel]))
    return min(in_floors(*each) for each in pairs)


def shared(current: Hypothesis, fitted: Hypothesis, floor: NoiseFloor) -> tuple[str, float, float]:
    """Return the channel that gains most, the share of its gap above the floor that is explained, and what is left."""
    changes = [
        old.loss(SELECT) - new.loss(SELECT) for old, new in zip(current.residuals, fitted.residuals, strict=True)
    ]
    place = int(np.argmax(changes))
    old, new = current.residuals[place], fitted.residuals[place]
    least = floor.white[old.channel] ** 2 * max(1, int(np.sum(old.judged & (old.part == SELECT))))
    before, after = old.loss(SELECT), new.loss(SELECT)
    left = float(np.sqrt(after / least)) if least > 0 else np.inf
    return old.channel, explained(before, after, least), left


def explained(before: float, after: float, least: float) -> float:
    """Return the share of what is missed above a floor that is explained, at most 1; nothing of what is within it."""
    return (before - after) / (before - min(least, after)) if before > least else 0.0
