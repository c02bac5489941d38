"""What changed since a healthy record: every hypothesis fitted to the whole record, and how probable it is."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.diagnosis.calibration.calibrate import Calibration, Healthy
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.estimate.parameter_space import EffectType
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.superposed import Superposed

# constants of the posterior
PRIOR_CHANGED = 0.25  # that something of a link changed at all
PRICE = 3.0  # of a free parameter, in units of log likelihood
UNKNOWN_PRICE = 5.0  # of leaving something to what is unknown
SCATTER = 0.15  # of the logarithm of what healthy records leave
LEAST_LEFT = 0.3  # of what noise leaves: less is no measure of anything
DEEPER = 3  # hypotheses that others are tried beside
CREDIBLE = 0.9
UNKNOWN = "unknown"
NONE = "none"
Tick = Callable[[str], None]


@dataclass(frozen=True)
class Weighed:
    """A hypothesis of one link: its effects as fitted, and what speaks for it, as logarithms."""

    fitted: Hypothesis
    likelihood: float
    always: float  # how much better the same would be, had it been so from the start
    misfit: float  # what it leaves beyond what healthy records do, in standard deviations
    prior: float

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(sorted(self.fitted.names))


class Weighing:
    """Weighs what may have changed at one link."""

    def __init__(
        self,
        problem: SegmentProblem,
        effects: Sequence[EffectType],
        calibration: Calibration,
        thorough: float,
        tick: Tick,
    ) -> None:
        self.problem, self.tick = problem, tick
        self.estimator = Estimator(problem, thorough)
        self.healthy: Healthy = calibration.healthy[problem.segment.name]
        self.effects = [effect for effect in effects if not effect.hindrance(problem.belief)]
        self.share = {each.channel: self.healthy.together(each.channel) for each in self.healthy.fitted.residuals}
        self.prior_one = float(np.log(PRIOR_CHANGED / max(1, len(self.effects))))
        self.prior_none = float(np.log(1.0 - PRIOR_CHANGED))

    def weighed(self) -> list[Weighed]:
        """Return the hypotheses: none, each effect, and the best few with every other."""
        none = self.estimator.settled(self.estimator.base)
        one_more = Superposed(self.estimator, none).fits if len(self.problem.sd) else self._fits
        found = [self.of(none)]
        found += [self.of(each) for each in one_more(self.effects, none, self.tick)]
        best = sorted(found[1:], key=lambda each: -score(each))[:DEEPER]
        if best and score(best[0]) > score(found[0]):
            for each in best:
                others = [effect for effect in self.effects if effect.name not in each.names]
                found += [self.of(pair) for pair in one_more(others, each.fitted, self.tick)]
        return found

    def _fits(self, effects: Sequence[EffectType], given: Hypothesis, tick: Tick) -> Iterator[Hypothesis]:
        for effect in effects:
            tick(effect.name)
            fitted = self.estimator.fit(effect, given, ALL)
            if fitted is not None:
                yield fitted

    def of(self, fitted: Hypothesis) -> Weighed:
        parameters = sum(len(effect.priors) for effect, _ in fitted.effects)
        loss = sum(each.loss() / self.share.get(each.channel, 1.0) for each in fitted.residuals)
        likelihood = -0.5 * (loss + self.estimator.strain(fitted)) - PRICE * parameters
        prior = self.prior_one * len(fitted.effects) if fitted.effects else self.prior_none
        always = self.healthy.gain(fitted.effects) if fitted.effects else 0.0
        return Weighed(fitted, likelihood, always, self.misfit(fitted), prior)

    def misfit(self, fitted: Hypothesis) -> float:
        """Return by how much the channel that is missed most is missed by more than in the healthy record."""
        return max((self._misfit(each) for each in fitted.residuals), default=0.0)

    def _misfit(self, residual: Residual) -> float:
        count = int(residual.judged.sum())
        healthy = self.healthy.left(residual.channel)
        if not count or healthy is None:
            return 0.0
        left = float(np.sqrt(residual.loss() / count))
        usual, before = healthy
        share = self.share.get(residual.channel, 1.0)
        scatter = np.sqrt(SCATTER**2 + 0.5 * share / count + 0.5 * share / before)
        return max(0.0, float(np.log(max(left, LEAST_LEFT) / max(usual, LEAST_LEFT)) / scatter))


def score(weighed: Weighed) -> float:
    """Return the logarithm of what speaks for a hypothesis, with nothing unknown beside it."""
    return weighed.likelihood + weighed.prior - max(0.0, weighed.always) - 0.5 * weighed.misfit**2


def posterior(found: Sequence[Weighed]) -> dict[str, float]:
    """Return the probability of each hypothesis of a link, with something unknown beside it or not; they sum to 1."""
    logs: dict[str, float] = {}
    for each in found:
        name = "+".join(each.names)
        plain = each.likelihood + each.prior - max(0.0, each.always)
        for key, value in ((name or NONE, plain - 0.5 * each.misfit**2), (beside(name), plain - UNKNOWN_PRICE)):
            logs[key] = max(logs.get(key, -np.inf), value)
    most = max(logs.values())
    weights = {name: float(np.exp(value - most)) for name, value in logs.items()}
    whole = sum(weights.values())
    return {name: weight / whole for name, weight in weights.items()}


def beside(name: str) -> str:
    return f"{name}+{UNKNOWN}" if name else UNKNOWN


