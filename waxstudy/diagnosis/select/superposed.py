"""Effects of a room beside each other: a room is linear in heat, so that what each of them does adds up, nearly."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from waxstudy.diagnosis.criteria import LIMITS
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.parameter_space import Edits, EffectType, Space, Values
from waxstudy.diagnosis.model.as_built import Knob
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.plugin import FloatArray

STRONGEST = 4.0  # times a point that was looked at
PROMISING = 2.0  # of log likelihood that an effect must gain in a straight line, for a closer look
MANY, SEVERAL = 3, 2  # parameters of an effect with hours, and starts that it is fitted from
TINY = 1e-12


class Superposed:
    """Looks at each effect once, all over its parameters, beside what is believed; beside others they add up."""

    def __init__(self, estimator: Estimator[SegmentProblem], none: Hypothesis) -> None:
        self.estimator, self.problem, self.none = estimator, estimator.problem, none
        self.slopes = estimator.base_slopes
        sd = self.problem.sd
        self.basis, self.triangle = np.linalg.qr(np.vstack((self.slopes, self.problem.prior / sd)))
        self.looked: dict[EffectType, tuple[list[Values], FloatArray]] = {}

    def fits(
        self, effects: Sequence[EffectType], given: Hypothesis, tick: Callable[[str], None]
    ) -> Iterator[Hypothesis]:
        """Yield a hypothesis with each effect beside a given one, fitted to the whole record where it may gain."""
        for effect in effects:
            tick(effect.name)
            if fitted := self._fit(effect, given):
                yield fitted

    def _fit(self, effect: EffectType, given: Hypothesis) -> Hypothesis | None:
        found = self._starts(effect, given)
        if not found:
            return None
        best, gain = found[0]
        if gain < PROMISING:
            # with more than one there is nothing to tell; alone it is told what it comes to
            return None if given.effects else self.problem.at(*best, given.convention)
        starts = [*(start for start, _ in found), *self._instead(effect, given)]
        tried = [self._fitted(*start, given.convention) for start in starts]
        fitted = min((each for each in tried if each), key=lambda each: self.estimator.score(each, ALL), default=None)
        if fitted is None or self.estimator.score(given, ALL) - self.estimator.score(fitted, ALL) < 2.0 * PROMISING:
            return fitted
        return self._fitted(fitted.effects, fitted.departures, fitted.convention)

    def _instead(self, effect: EffectType, given: Hypothesis) -> Iterator[tuple[Edits, FloatArray]]:
        """Yield a start at which the effect does what the nuisances of its own kind do in the given hypothesis."""
        values, departures = dict(effect.neutral(self.problem.belief) or {}), given.departures.copy()
        for place, knob in enumerate(self.problem.nuisances):
            if isinstance(knob, Knob) and knob.effect is effect:
                values |= {knob.parameter: knob.values(float(departures[place]))[knob.parameter]}
                departures[place] = 0.0
        if values.keys() >= effect.priors.keys() and not np.array_equal(departures, given.departures):
            yield (*given.effects, (effect, values)), departures

    def _fitted(self, effects: Edits, departures: FloatArray, convention: Convention) -> Hypothesis | None:
        """Return a hypothesis fitted from given values, by slopes of the departures as they are there."""
        start = self.problem.at(effects, departures, convention)
        slopes = self.estimator.slopes_at(start) if start else None
        return self.estimator.nuisance_fit(effects, departures, convention, ALL, slopes)

    def _starts(self, effect: EffectType, given: Hypothesis) -> list[tuple[tuple[Edits, FloatArray], float]]:
        """Return the best values and departures to start from, with the log likelihood gained where all is straight.

        Of an effect with hours several: an hour that is a little off hides how long it acts.
        """
        tried, changes = self._looks(effect)
        if not tried:
            return []
        missed = np.concatenate((given.whitened, self._pulled(given)))
        before = self._free(missed)
        ways = changes - self.basis @ (self.basis.T @ changes)
        power: FloatArray = np.maximum(np.sum(ways**2, axis=0), TINY)
        neutral = effect.neutral(self.problem.belief)
        bounds = (0.0, STRONGEST) if neutral else (1.0, 1.0)
        strength = np.clip(-(before @ ways) / power, *bounds)
        gains = -(strength * (before @ ways)) - 0.5 * strength**2 * power
        found: list[tuple[tuple[Edits, FloatArray], float]] = []
        most = LIMITS.departure * self.problem.sd
        for place in np.argsort(-gains)[: SEVERAL if len(effect.priors) >= MANY else 1]:
            values = Space(effect).scaled(tried[place], neutral, float(strength[place])) if neutral else tried[place]
            step = np.linalg.solve(self.triangle, -self.basis.T @ (missed + strength[place] * changes[:, place]))
            start = (*given.effects, (effect, values)), np.clip(given.departures + step, -most, most)
            found.append((start, float(gains[place])))
        return found

    def _looks(self, effect: EffectType) -> tuple[list[Values], FloatArray]:
        """Return points all over an effect's parameters, and the change that each makes (m, points)."""
        if effect not in self.looked:
            tried, changes = [], []
            for values in (*Space(effect).points(self.estimator.thorough), *effect.starts(self.problem.belief)):
                look = self.problem.at(((effect, values),), self.none.departures, self.none.convention)
                if look is not None:
                    tried.append(values)
                    changes.append(look.whitened - self.none.whitened)
            padded = np.zeros((len(self.none.whitened) + len(self.problem.sd), len(tried)))
            padded[: len(self.none.whitened)] = np.array(changes).T if changes else 0.0
            self.looked[effect] = tried, padded
        return self.looked[effect]

    def _pulled(self, fitted: Hypothesis) -> FloatArray:
        return np.asarray(self.problem.prior @ (fitted.departures / self.problem.sd))

    def _free(self, missed: FloatArray) -> FloatArray:
        """Return what the nuisances cannot take of what is missed."""
        return np.asarray(missed - self.basis @ (self.basis.T @ missed))
