"""How strong an effect is drawn: log-uniform from below what anybody would notice to far above it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from waxstudy.plugin import Belief, Effect, Prior
from waxstudy.plugin.trial import Unmakeable

STEPS = (0.3, 120.0)  # noticeable steps from neutral, of a parameter on a straight scale
LOG_STEPS = (0.3, 14.0)  # the same of a factor
WAY = (0.05, 1.3)  # how far from neutral to a real device, where an effect puts one in the place of another
SPREAD = 0.4  # of the logarithm of a time or a factor, among devices of a kind
DIGITS = 5


def severity(effect: type[Effect], belief: Belief, random: np.random.Generator) -> dict[str, float]:
    """Return drawn values of an effect's parameters, within its priors; raise `Unmakeable` where it cannot apply."""
    if reason := effect.hindrance(belief):
        raise Unmakeable(f"{effect.name}: {reason}")
    neutral = effect.neutral(belief)
    starts = effect.starts(belief)
    if neutral is None:
        near = starts[int(random.integers(len(starts)))]
        values = {name: _scattered(prior, near[name], random) for name, prior in effect.priors.items()}
    elif starts and (len(effect.priors) > 2 or effect.priors.keys() - neutral.keys()):
        values = _on_the_way(effect.priors, neutral, starts[int(random.integers(len(starts)))], random)
    else:
        level = random.random()
        values = {name: _departed(prior, neutral[name], level, random) for name, prior in effect.priors.items()}
    return {name: float(f"{value:.{DIGITS}g}") for name, value in values.items()}


def _scattered(prior: Prior, near: float, random: np.random.Generator) -> float:
    """Return a value of another device of the kind."""
    if prior.is_log or near > 0.0:
        return _within(prior, near * float(np.exp(random.normal(0.0, SPREAD))))
    return _within(prior, near + prior.noticeable * float(random.normal(0.0, 2.0)))


def _on_the_way(
    priors: Mapping[str, Prior], neutral: Mapping[str, float], end: Mapping[str, float], random: np.random.Generator
) -> dict[str, float]:
    """Return values between what does nothing and a device, or somewhat beyond; each device is another."""
    share = float(np.exp(random.uniform(*np.log(WAY))))
    found = {}
    for name, prior in priors.items():
        own = share * float(np.exp(random.normal(0.0, 0.2)))
        if name in neutral:
            found[name] = _within(prior, neutral[name] + own * (end[name] - neutral[name]))
        else:
            found[name] = _within(prior, end[name] + prior.noticeable * float(random.normal()))
    return found


def _departed(prior: Prior, neutral: float, level: float, random: np.random.Generator) -> float:
    """Return a value some noticeable steps from neutral, to either side that the prior allows."""
    low, high = np.log(LOG_STEPS if prior.is_log else STEPS)
    steps = float(np.exp(low + level * (high - low)))
    way = 1.0 if random.random() < 0.5 else -1.0
    for side in (way, -way):
        value = (
            neutral * prior.noticeable ** (side * steps) if prior.is_log else neutral + side * steps * prior.noticeable
        )
        if _within(prior, value) != neutral:
            return _within(prior, value)
    return neutral


def _within(prior: Prior, value: float) -> float:
    return min(prior.high, max(prior.low, value))
