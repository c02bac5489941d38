"""What an effect of a room promises at each of its values, where all is straight: looked at once, without a fit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.parameter_space import HOURS, EffectType, Space, Values, has_hours
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.day import DAY_H, TINY, parts_of_day, promising
from waxstudy.plugin import FloatArray

STRONGEST = 4.0  # times a point that was looked at
SEVERAL = 3  # hours of the day that are looked at closer
LONGEST_STEP_H, LEAST_STEP_H = 0.25, 0.06  # by which they are
LEVELS = (0.0, 0.5, 1.0)  # of what is neither strength nor hour of an effect with hours, within its range


class Look(NamedTuple):
    """An effect at some values: the change (m + nuisances,), and the gain at the strength that suits best."""

    values: Values
    change: FloatArray
    strength: float
    gain: float


class Looks:
    """Looks at effects beside a room as it was calibrated, in which nothing departs.

    There it answers in a straight line. A room that was led far, to explain an effect without it, does not.
    """

    def __init__(self, estimator: Estimator[SegmentProblem], convention: Convention) -> None:
        self.problem, self.thorough = estimator.problem, estimator.thorough
        sd = self.problem.sd
        self.still = self.problem.at((), np.zeros(len(sd)), convention) or estimator.base
        slopes = np.vstack((estimator.slopes_at(self.still), self.problem.prior / sd))
        self.basis, self.triangle = np.linalg.qr(slopes)
        self._changes: dict[tuple[object, ...], FloatArray | None] = {}
        self._parts: dict[tuple[object, ...], FloatArray | None] = {}

    def missed(self, given: Hypothesis) -> FloatArray:
        """Return what a hypothesis misses, and how far it pulls (m + nuisances,)."""
        return np.concatenate((given.whitened, self.problem.prior @ (given.departures / self.problem.sd)))

    def best(self, effect: EffectType, missed: FloatArray) -> list[Look]:
        """Return the best look at an effect beside what is missed; of one with hours several, the best first.

        An hour that is a little off hides how long it acts.
        """
        before = self._free(missed)
        if has_hours(effect):
            looks = [self._sharpened(effect, each, before) for each in self._timed(effect, before)]
            return sorted(looks, key=lambda each: -each.gain)
        points = [*Space(effect).points(self.thorough), *effect.starts(self.problem.belief)]
        return sorted(self._looks(effect, points, before), key=lambda each: -each.gain)[:1]

    def step(self, missed: FloatArray, look: Look) -> FloatArray:
        """Return how far the nuisances would depart (nuisances,) with what was looked at."""
        return np.linalg.solve(self.triangle, -self.basis.T @ (missed + look.strength * look.change))

    def _looks(self, effect: EffectType, points: Sequence[Values], before: FloatArray) -> list[Look]:
        return [look for values in points if (look := self._look(effect, values, before))]

    def _look(self, effect: EffectType, values: Values, before: FloatArray) -> Look | None:
        """Return a look at one point; `before` (m + nuisances,) is missed, and no nuisance can take it."""
        change = self._change(effect, values)
        if change is None:
            return None
        way = self._free(change)
        along, power = float(before @ way), max(float(way @ way), TINY)
        least, most = self._strengths(effect)
        strength = float(np.clip(-along / power, least, most))
        return Look(values, change, strength, -strength * along - 0.5 * strength**2 * power)

    def _strengths(self, effect: EffectType) -> tuple[float, float]:
        """Return between which strengths, times that of a point, an effect may act."""
        if not effect.neutral(self.problem.belief):
            return 1.0, 1.0
        return -STRONGEST if self._is_signed(effect) else 0.0, STRONGEST

    def _is_signed(self, effect: EffectType) -> bool:
        """Whether an effect with hours may give heat as well as take it."""
        still = effect.neutral(self.problem.belief) or {}
        return HOURS[0] in effect.priors and all(
            effect.priors[n].low < v < effect.priors[n].high for n, v in still.items()
        )

    def _timed(self, effect: EffectType, before: FloatArray) -> list[Look]:
        """Return looks at the hours of the day between which an effect promises most."""
        spans = [
            (span, settings)
            for settings in self._settings(effect)
            if (parts := self._in_parts(effect, settings)) is not None
            for span in promising(before, parts, self.basis, self._is_signed(effect), SEVERAL)
        ]
        best = sorted(spans, key=lambda pair: -pair[0].gain)[:SEVERAL]
        return self._looks(effect, [{**settings, **_hours(span[:2])} for span, settings in best], before)

    def _settings(self, effect: EffectType) -> Iterator[Values]:
        """Yield values of an effect with hours but for these: as strong as it starts, all else from low to high."""
        space, starts = Space(effect), effect.starts(self.problem.belief)
        first = space.inside(starts[0]) if starts else np.full(len(space.names), LEVELS[1])
        place = dict(zip(space.names, first.tolist(), strict=True))
        others = sorted(set(space.names) - {*HOURS, *(effect.neutral(self.problem.belief) or {})})
        for levels in product(LEVELS, repeat=len(others)):
            there = {**place, **dict(zip(others, levels, strict=True))}
            yield space.values(np.array([there[name] for name in space.names]))

    def _in_parts(self, effect: EffectType, settings: Values) -> FloatArray | None:
        """Return what an effect changes that acts in one part of the day (m + nuisances, parts)."""
        key = effect, *sorted(settings.items())
        if key not in self._parts:
            changes = [self._changed(effect, {**settings, **_hours(each)}) for each in parts_of_day()]
            found = [each for each in changes if each is not None]
            self._parts[key] = np.column_stack(found) if len(found) == len(changes) else None
        return self._parts[key]

    def _sharpened(self, effect: EffectType, look: Look, before: FloatArray) -> Look:
        """Return a look at the hours near those of another one at which the effect promises most."""
        step_h = LONGEST_STEP_H
        while step_h >= LEAST_STEP_H:
            near = [
                {**look.values, **{name: (look.values[name] + way * step_h) % DAY_H for name in names}}
                for names in (*((each,) for each in HOURS), HOURS)
                for way in (-1.0, 1.0)
            ]
            best = max(self._looks(effect, near, before), key=lambda each: each.gain, default=look)
            if best.gain > look.gain:
                look = best
            else:
                step_h *= 0.5
        return look

    def _change(self, effect: EffectType, values: Values) -> FloatArray | None:
        """Return the same as `_changed`, of what was looked at before as well."""
        key = effect, *sorted(values.items())
        if key not in self._changes:
            self._changes[key] = self._changed(effect, values)
        return self._changes[key]

    def _changed(self, effect: EffectType, values: Values) -> FloatArray | None:
        """Return how what is missed changes with an effect (m + nuisances,), None where it cannot be."""
        look = self.problem.at(((effect, values),), self.still.departures, self.still.convention)
        if look is None:
            return None
        return np.concatenate((look.whitened - self.still.whitened, np.zeros(len(self.problem.sd))))

    def _free(self, missed: FloatArray) -> FloatArray:
        """Return what the nuisances cannot take of what is missed."""
        return np.asarray(missed - self.basis @ (self.basis.T @ missed))


def _hours(hours: Sequence[float]) -> Values:
    return dict(zip(HOURS, hours, strict=True))
