"""Effects of a room beside each other: a room is linear in heat, so that what each of them does adds up, nearly."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.as_built import Knob
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.edits import Edits, EffectType, differ_by_inputs_alone
from waxstudy.diagnosis.observations.partition import ALL
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.day import SPANS
from waxstudy.diagnosis.select.days import Days
from waxstudy.diagnosis.select.looks import Looks, between, has_hours
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import HOURS, FloatArray
from waxstudy.plugin.hours import DAY_H, open_h


class Superposed:
    """Looks at each effect once, all over its parameters, beside "nothing"; beside others they add up."""

    def __init__(self, estimator: Estimator[SegmentProblem], none: Hypothesis) -> None:
        self.estimator, self.problem = estimator, estimator.problem
        self.looks = Looks(estimator, none)

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
        if gain < WEIGHTS.screened_room:
            if given.effects:
                return None  # with more than one there is nothing to tell; alone it is told what it comes to
            there = self.problem.at(*best, given.convention)
            if there is None or self._gain(there, given) > -WEIGHTS.screened_room:
                return there  # else the straight line does not hold, and a fit may find more
        starts = [*(start for start, _ in found), *self._instead(effect, given)]
        # slopes where nothing changed are near enough for the first fits
        tried = [self._fitted(*start, given.convention, self.estimator.base_slopes) for start in starts]
        fitted = min((each for each in tried if each), key=lambda each: self.estimator.score(each, ALL), default=None)
        if fitted is None or self._gain(fitted, given) < WEIGHTS.screened_room:
            return fitted
        return self._fitted(fitted.effects, fitted.departures, fitted.convention)

    def _gain(self, fitted: Hypothesis, given: Hypothesis) -> float:
        """Return the log likelihood that a fit gains over the hypothesis it was added to."""
        return 0.5 * (self.estimator.score(given, ALL) - self.estimator.score(fitted, ALL))

    def on_days(self, fitted: Hypothesis, among: Sequence[Days]) -> Hypothesis | None:
        """Return an effect of a room that acts at hours, where it acts on those of some days that promise most."""
        ((effect, values),) = fitted.effects
        belief = self.problem.belief
        other = effect.apply(belief, effect.Parameters(**values))
        # a room itself has no days
        if not differ_by_inputs_alone(other, belief) or not (found := self.looks.on_days(effect, values, among)):
            return None
        chosen, look = found
        edits, departures = [(chosen, self.looks.values(chosen, look))], self.looks.departures(self.looks.none, look)
        days = self._fitted(edits, departures, fitted.convention)
        return days if days and has_hours(*days.effects[0]) and self._needs_hours(days) else None

    def _needs_hours(self, days: Hypothesis) -> bool:
        """Whether what acts on some days explains more by its hours than they cost; else it acts on all their hours.

        An effect that acts for at most half a day always needs them. Both are looked at, at the strength that suits.
        """
        ((effect, values),) = days.effects
        from_h, to_h = (values[name] for name in HOURS)
        if open_h(from_h, to_h) <= 0.5 * DAY_H:
            return True
        all_day = {**values, **between((0.0, DAY_H))}
        at_hours, always = (self.looks.gain(effect, each) for each in (values, all_day))
        return at_hours - always > float(np.log(SPANS))

    def _instead(self, effect: EffectType, given: Hypothesis) -> Iterator[tuple[Edits, FloatArray]]:
        """Yield a start at which the effect does what the nuisances of its own kind do in the given hypothesis."""
        values, departures = dict(effect.neutral(self.problem.belief) or {}), given.departures.copy()
        for place, knob in enumerate(self.problem.nuisances):
            if isinstance(knob, Knob) and knob.effect is effect:
                values |= {knob.parameter: knob.values(knob.step(float(departures[place])))[knob.parameter]}
                departures[place] = 0.0
        if values.keys() >= effect.priors.keys() and not np.array_equal(departures, given.departures):
            yield (*given.effects, (effect, values)), departures

    def _fitted(
        self, effects: Edits, departures: FloatArray, convention: Convention, known: FloatArray | None = None
    ) -> Hypothesis | None:
        """Return a hypothesis fitted from given values, by known slopes of the departures, or those at the start."""
        if known is None and (start := self.problem.at(effects, departures, convention)):
            known = self.estimator.slopes_at(start)
        return self.estimator.nuisance_fit(effects, departures, convention, ALL, known)

    def _starts(self, effect: EffectType, given: Hypothesis) -> list[tuple[tuple[Edits, FloatArray], float]]:
        """Return the best values and departures to start from, with the log likelihood gained where all is straight."""
        found: list[tuple[tuple[Edits, FloatArray], float]] = []
        given = self.looks.beside(effect, given)
        for look in self.looks.best(effect, self.looks.missed(given)):
            edits = (*given.effects, (effect, self.looks.values(effect, look)))
            found.append(((edits, self.looks.departures(given, look)), look.gain))
        return found
