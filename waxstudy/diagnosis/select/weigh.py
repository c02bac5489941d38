"""Which hypotheses of a link are tried, each fitted to the whole record."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from waxstudy.diagnosis.calibration.healthy import Healthy
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.start_points import Screen
from waxstudy.diagnosis.model.edits import EffectType
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.appraise import Appraisal
from waxstudy.diagnosis.select.day import SPANS
from waxstudy.diagnosis.select.days import courses
from waxstudy.diagnosis.select.instruments import Instruments
from waxstudy.diagnosis.select.looks import acts_all_day, has_hours
from waxstudy.diagnosis.select.patterns import acting, patterns
from waxstudy.diagnosis.select.posterior import Weighed, score
from waxstudy.diagnosis.select.superposed import Superposed
from waxstudy.diagnosis.select.timed import can_be_timed, timed
from waxstudy.diagnosis.weights import WEIGHTS

DEEPER = 3  # hypotheses that others are tried beside
Tick = Callable[[str], None]


class Weighing(Appraisal):
    """Weighs what may have changed at one link."""

    def __init__(
        self,
        problem: SegmentProblem,
        effects: Sequence[EffectType],
        healthy: Healthy,
        thorough: float,
        tick: Tick,
    ) -> None:
        super().__init__(problem, healthy, Estimator(problem, thorough, keeps=True, near=problem.near))
        self.tick = tick
        self.effects = [effect for effect in effects if not effect.hindrance(problem.belief)]
        if problem.segment.with_room:
            make: Callable[..., EffectType] = timed  # a cached function takes hashable arguments, which classes are
            self.effects += [make(effect) for effect in self.effects if can_be_timed(effect, problem.belief)]

    def weighed(self) -> list[Weighed]:
        """Return the hypotheses: none, each effect, and the best few with every other."""
        singles = self._singles()  # which may find a better fit of nothing
        found = [self.of(each) for each in (self.none, *singles)]
        # an effect that comes and goes gains much, but not on all days
        told = [each for each in found[1:] if each.gain + each.ease > each.price]
        found += list(self._patterned(sorted(told, key=lambda each: -each.gain)))
        best = sorted(found[1:], key=lambda each: -score(each))[:DEEPER]
        if best and score(best[0]) > score(found[0]) and not self.estimator.is_quick:
            for each in self._open(best):
                others = [effect for effect in self.effects if _may_be_beside(effect, each.fitted)]
                pairs = list(self._one_more(others, each.fitted, self.tick))
                found += [self.beside(each, pair) for pair in self._timely(pairs, each.fitted)]
        return self._beside_instruments(found)

    def _beside_instruments(self, found: list[Weighed]) -> list[Weighed]:
        """Return hypotheses, the first that nothing changed, of a room each with the instrument that may be off."""
        if not self.problem.segment.with_room or self.problem.as_built is None:
            return found
        instruments = Instruments(self.estimator, self.none, self.share, self.healthy.problem.record)
        alone = instruments.best(found[0].fitted)
        beside = [instruments.beside(alone, each.gain, each.ease, each.spread, each.fitted) for each in found[1:]]
        return [replace(each, off_by=off_by) for each, off_by in zip(found, (alone, *beside), strict=True)]

    @cached_property
    def _superposed(self) -> Superposed:
        return Superposed(self.estimator, self.none)

    def _open(self, best: Sequence[Weighed]) -> list[Weighed]:
        """Return hypotheses that leave something for more to tell; of a room its unknowns may hide that."""
        return [each for each in best if self.problem.segment.with_room or each.misfit > WEIGHTS.open]

    @property
    def _one_more(self) -> Callable[[Sequence[EffectType], Hypothesis, Tick], Iterable[Hypothesis]]:
        """What fits effects one by one on top of a given hypothesis."""
        return self._superposed.fits if len(self.problem.sd) else self._fits

    def _singles(self) -> list[Hypothesis]:
        """Return each effect by itself, fitted to the whole record."""
        singles = self._timely(list(self._one_more(self.effects, self.none, self.tick)), self.none)
        self._settle(singles)
        return singles

    def _timely(self, fits: Sequence[Hypothesis], given: Hypothesis) -> list[Hypothesis]:
        """Leave out what acts all day where an effect that always acts explains as much: it is the same air or heat.

        As much is up to the price of hours, and to what the form of an effect may leave.
        """
        gains = [0.5 * (self._loss(given) - self._loss(each)) for each in fits]
        pairs = list(zip(fits, gains, strict=True))
        most = max((gain for each, gain in pairs if not each.effects[-1][0].has_hours()), default=0.0)
        enough = (most + float(np.log(SPANS))) / (1.0 - WEIGHTS.form**2)
        return [each for each, gain in pairs if not acts_all_day(*each.effects[-1]) or gain > enough]

    def _settle(self, singles: Sequence[Hypothesis]) -> None:
        """Look for a better fit of nothing where the best effects led the room: else they gain what it had left."""
        if len(self.problem.sd):
            near = sorted(singles, key=self._loss)[:DEEPER]
            known = self.estimator.base_slopes
            again = [self.estimator.nuisance_fit((), each.departures, each.convention, ALL, known) for each in near]
            self.none = min([self.none, *(each for each in again if each)], key=self._loss)

    def _fits(self, effects: Sequence[EffectType], given: Hypothesis, tick: Tick) -> Iterator[Hypothesis]:
        most = self.most_told(given)
        for effect in effects:
            tick(effect.name)
            least = WEIGHTS.screened if self.may_show(effect, most) else np.inf
            fitted = self.estimator.fit(effect, given, ALL, Screen(least, self.share))
            if fitted is not None:
                yield fitted

    def _patterned(self, told: Sequence[Weighed]) -> Iterator[Weighed]:
        """Yield the best few effects as they act at certain times: of a room those with hours, on some days."""
        if self.problem.segment.with_room:
            yield from self._on_days([each for each in told if has_hours(*each.fitted.effects[0])][:DEEPER])
            return
        possible = self._open(told[:DEEPER])
        tried = sum(1 for _ in patterns(self.problem.record)) if possible else 0
        for each in possible:
            # one after the other: of a long record all of them would not lie in memory
            without, record = self._nothing(each.fitted), self.problem.record
            made = ((acting(without, each.fitted, one, self.share), one) for one in patterns(record))
            (fitted, strength), pattern = min(made, key=lambda pair: self._loss(pair[0][0]))
            weighed = self.of(fitted, pattern=pattern)
            price = weighed.price + WEIGHTS.price + float(np.log(tried))
            yield replace(weighed, price=price, strength=strength)

    def _on_days(self, best: Sequence[Weighed]) -> Iterator[Weighed]:
        """Yield effects of a room that act between hours, where they do so on some days only."""
        record, inputs = self.problem.record, self.problem.belief.inputs
        among = courses(record, inputs) if inputs else []
        for each in best:
            if fitted := self._superposed.on_days(each.fitted, among):
                yield self.of(fitted)


def _may_be_beside(effect: EffectType, given: Hypothesis) -> bool:
    """Whether an effect is none of the given ones, and none of them takes the place of another."""
    taken = {name for other, _ in given.effects for name in (other.name, *other.absorbs)}
    return effect.name not in taken and not set(given.names) & set(effect.absorbs)
