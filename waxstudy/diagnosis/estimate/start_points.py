"""A first look at an effect: points all over its parameters, the room's departures following in a straight line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.parameter_space import EffectType, Space, Values
from waxstudy.diagnosis.estimate.solver import MOST_SD, LeastSquares
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.plugin import FloatArray

if TYPE_CHECKING:
    from waxstudy.diagnosis.estimate.fitter import Fitter

STRONGEST = 4.0  # times a point of a first look
SCALED = 4  # such points that are tried at the strength that suits the record
TINY = 1e-12
MANY = 4  # parameters of a chain, from which on the best point of a first look may lead nowhere
STARTS, STEPS, FAR = 8, 5, 0.1  # such points, steps from each, and the share of a range that their slopes look over


class FirstLook:
    """Where an effect, added to a fit, may be worth a closer look."""

    def __init__(self, fitter: Fitter, effect: EffectType, given: Hypothesis, parts: Sequence[int]) -> None:
        self.fitter, self.effect, self.given, self.parts = fitter, effect, given, parts
        self.space = Space(effect)

    def best(self, convention: Convention) -> tuple[float, Values]:
        """Return the least score, and the values that it is found at, with one way to read the record."""
        tried = [*self.space.points(self.fitter.thorough), *self.effect.starts(self.fitter.belief)]
        looks = [self._with(values, convention) for values in tried]
        more = self._scaled(tried, looks, convention)
        looks += [self._with(values, convention) for values in more]
        scores = [self.fitter.score(each, self.parts) for each in looks]
        found = sorted(zip(scores, [*tried, *more], strict=True), key=itemgetter(0))
        if self.fitter.nuisances or len(self.space.names) < MANY:
            return found[0]
        starts = round(STARTS * min(1.0, self.fitter.thorough))
        walked = [self._walked(values, convention) for _, values in found[:starts]]
        return min((found[0], *walked), key=itemgetter(0))

    def _walked(self, values: Values, convention: Convention) -> tuple[float, Values]:
        """Return score and values a few steps downhill, by slopes that look far: a point may lie in a hollow.

        A stroke that is shorter than a sample has no slope of its own that leads to a longer one.
        """
        problem = LeastSquares(self.fitter, (*self.given.effects, (self.effect, values)), convention, self.parts, FAR)
        walked = problem.solved(problem.vector(self.given.departures), STEPS, None)
        found = dict(walked.effects)[self.effect] if walked else values
        return self.fitter.score(self._with(found, convention), self.parts), found

    def _scaled(
        self, tried: Sequence[Values], looks: Sequence[Hypothesis | None], convention: Convention
    ) -> list[Values]:
        """Return points as strong as suits the record: a room answers nearly in proportion.

        A window of the right hours, but of thrice the flow, would look worse than none.
        """
        given = self.given
        neutral = self.effect.neutral(self.fitter.edited(given.effects, given.departures))
        still = self._at(given.effects, convention) if self.fitter.nuisances and neutral else None
        if still is None or neutral is None:
            return []
        before = still.missed(self.parts)
        found = []
        for values, look in zip(tried, looks, strict=True):
            change = look.missed(self.parts) - before if look else np.zeros(len(before))
            along = float(before @ change) / max(float(change @ change), TINY)
            strength = min(STRONGEST, max(0.0, -along))
            left = before + strength * change
            found.append((float(left @ left), self.space.scaled(values, neutral, strength)))
        return [values for _, values in sorted(found, key=itemgetter(0))[:SCALED]]

    def _with(self, values: Values, convention: Convention) -> Hypothesis | None:
        return self._at((*self.given.effects, (self.effect, values)), convention)

    def _at(self, effects: Sequence[tuple[EffectType, Values]], convention: Convention) -> Hypothesis | None:
        """Return a hypothesis with the room's departures where they would go, were everything straight from here."""
        fitted = self.fitter.at(effects, self.given.departures, convention)
        if fitted is None or not self.fitter.nuisances:
            return fitted
        slopes, solution, fit = self.fitter.straight(tuple(self.parts))
        sd = self.fitter.sd
        whole = fitted.whitened
        step = -solution @ np.concatenate((whole[fit], fitted.departures / sd))
        step = np.clip(fitted.departures + step, -MOST_SD * sd, MOST_SD * sd) - fitted.departures
        moved = _parted(whole + slopes @ step, fitted)
        return replace(fitted, residuals=[replace(e, whitened=v) for e, v in zip(fitted.residuals, moved, strict=True)])


def _parted(whole: FloatArray, fitted: Hypothesis) -> Sequence[FloatArray]:
    """Return a vector of all channels as one of each."""
    return np.split(whole, np.cumsum([len(each.whitened) for each in fitted.residuals])[:-1])
