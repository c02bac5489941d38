"""Where to start a fit of an effect of the chain: points all over its parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import itemgetter

from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Problem
from waxstudy.diagnosis.estimate.parameter_space import EffectType, Space, Values
from waxstudy.diagnosis.estimate.solver import LeastSquares
from waxstudy.diagnosis.model.conventions import Convention

STRONGEST = 4.0  # times a point of a first look
TINY = 1e-12
MANY = 4  # parameters of a chain, from which on the best point of a first look may lead nowhere
STARTS, STEPS, FAR = 8, 5, 0.1  # such points, steps from each, and the share of a range that their slopes look over


@dataclass(frozen=True)
class Screen:
    """What an effect must promise for a closer look: log likelihood that it would gain, were all straight."""

    least: float
    share: Mapping[str, float]  # by channel: how many samples count as one

    def gain(self, given: Hypothesis, look: Hypothesis) -> tuple[float, float]:
        """Return the most that is gained along the change that a look makes, and how far along it."""
        weight = [self.share.get(each.channel, 1.0) ** -0.5 for each in given.residuals]
        pairs = zip(given.residuals, look.residuals, weight, strict=True)
        along, power = 0.0, TINY
        for old, new, each in pairs:
            change = each * (new.whitened - old.whitened)
            along -= float(change @ (each * old.whitened))
            power += float(change @ change)
        strength = min(STRONGEST, max(0.0, along / power))
        return strength * along - 0.5 * strength**2 * power, strength


class StartPoints:
    """Where an effect, added to a hypothesis, may be worth a closer look."""

    def __init__(
        self,
        problem: Problem,
        score: Callable[[Hypothesis | None, Sequence[int]], float],
        effect: EffectType,
        given: Hypothesis,
        parts: Sequence[int],
        thorough: float,
        screen: Screen | None = None,
    ) -> None:
        self.screen = screen
        self.promised: tuple[float, Values, Convention] | None = None  # log likelihood, at most, and where
        self.problem, self.score, self.effect, self.given, self.parts = problem, score, effect, given, parts
        self.thorough, self.space = thorough, Space(effect)

    def best(self, convention: Convention) -> tuple[float, Values]:
        """Return the least score, and the values that it is found at, with one way to read the record."""
        tried = [*self.space.points(self.thorough), *self.effect.starts(self.problem.belief)]
        looks = [self._with(values, convention) for values in tried]
        self._screened(tried, looks, convention)
        scores = [self.score(each, self.parts) for each in looks]
        found = sorted(zip(scores, tried, strict=True), key=itemgetter(0))
        if len(self.space.names) < MANY or self.is_hopeless:
            return found[0]
        starts = round(STARTS * min(1.0, self.thorough))
        walked = [self._walked(values, convention) for _, values in found[:starts]]
        return min((found[0], *walked), key=itemgetter(0))

    @property
    def is_hopeless(self) -> bool:
        """Whether the effect would gain too little for a closer look, by all that was looked at."""
        return bool(self.screen and self.promised and self.promised[0] < self.screen.least)

    def _screened(self, tried: Sequence[Values], looks: Sequence[Hypothesis | None], convention: Convention) -> None:
        still = self.problem.at(self.given.effects, self.given.departures, convention)
        if self.screen is None or still is None:
            return
        neutral = self.effect.neutral(self.problem.edited(self.given.effects, self.given.departures))
        for values, look in zip(tried, looks, strict=True):
            if look is None:
                continue
            gain, strength = self.screen.gain(still, look)
            if self.promised is None or gain > self.promised[0]:
                there = self.space.scaled(values, neutral, strength) if neutral else values
                self.promised = gain, there, convention

    def _walked(self, values: Values, convention: Convention) -> tuple[float, Values]:
        """Return score and values a few steps downhill, by slopes that look far: a point may lie in a hollow.

        A stroke that is shorter than a sample has no slope of its own that leads to a longer one.
        """
        problem = LeastSquares(self.problem, (*self.given.effects, (self.effect, values)), convention, self.parts, FAR)
        walked = problem.solved(problem.vector(self.given.departures), STEPS, None)
        found = dict(walked.effects)[self.effect] if walked else values
        return self.score(self._with(found, convention), self.parts), found

    def _with(self, values: Values, convention: Convention) -> Hypothesis | None:
        effects = (*self.given.effects, (self.effect, values))
        return self.problem.at(effects, self.given.departures, convention)
