"""What an effect of a room promises at each of its values, where all is straight: looked at once, without a fit."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.parameter_space import Space
from waxstudy.diagnosis.estimate.solver import MOST_SD, within
from waxstudy.diagnosis.estimate.start_points import MOST_SCALED, TINY
from waxstudy.diagnosis.model.edits import EffectType, Values
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.day import BINS, Span, apart, parts_of_day, promising
from waxstudy.diagnosis.select.days import Days, on_days
from waxstudy.plugin import HOURS, FloatArray
from waxstudy.plugin.hours import DAY_H, open_h

SEVERAL = 3  # spans of hours that are looked at closer, and fitted: the best one by half-hours need not be the best
FIRST_STEP_H, LAST_STEP_H = 0.25, 0.0625  # of the closer look: half a part of the day, down to four minutes
LEVELS, MIDDLE = (0.0, 0.5, 1.0), (0.5,)  # within its range, of what is neither strength nor hour; in a quick look


class Look(NamedTuple):
    """An effect at some values: the change (m + nuisances,), and the gain at the strength that suits best."""

    values: Values
    change: FloatArray
    strength: float
    gain: float


class Looks:
    """Looks at effects beside the fit of nothing, around which the room's answer is nearly linear.

    What was calibrated may be far from there: in other weather, or where nobody recorded the sun.
    """

    def __init__(self, estimator: Estimator[SegmentProblem], none: Hypothesis) -> None:
        self.problem, self.thorough, self.is_quick = estimator.problem, estimator.thorough, estimator.is_quick
        self.none = none
        slopes = estimator.slopes_at(none) * self.problem.sd  # (m, nuisances), per standard deviation
        self.basis, self.triangle = np.linalg.qr(np.vstack((slopes, self.problem.prior)))
        self._seen = self.problem.record.memory(arrays=4)
        self._in_parts: dict[tuple[object, ...], FloatArray | None] = {}

    def missed(self, given: Hypothesis) -> FloatArray:
        """Return what a hypothesis misses, and how far it pulls (m + nuisances,)."""
        return np.concatenate((given.whitened, self.problem.prior @ (given.departures / self.problem.sd)))

    def beside(self, effect: EffectType, given: Hypothesis) -> Hypothesis:
        """Return a hypothesis with the unknowns at rest whose place an effect takes."""
        rests = np.array([each.name in effect.absorbs for each in self.problem.nuisances])
        if not given.departures[rests].any():
            return given
        departures = np.where(rests, 0.0, given.departures)
        return self.problem.at(given.effects, departures, given.convention) or given

    def best(self, effect: EffectType, missed: FloatArray) -> list[Look]:
        """Return the best look at an effect beside what is missed; of one with hours several, the best first."""
        before = self._free(missed)
        if is_timed(effect):
            looks = [self._sharpened(effect, each, before) for each in self._timed(effect, before)]
            return sorted(looks, key=lambda each: -each.gain)
        points = [*Space(effect).points(self.thorough), *effect.starts(self.problem.belief)]
        return sorted(self._looks(effect, points, before), key=lambda each: -each.gain)[:1]

    def gain(self, effect: EffectType, values: Values) -> float:
        """Return the log likelihood that an effect promises at some values, as strong as suits; 0 if it cannot be."""
        look = self._look(effect, values, self._free(self.missed(self.none)))
        return look.gain if look else 0.0

    def on_days(self, effect: EffectType, values: Values, among: Sequence[Days]) -> tuple[EffectType, Look] | None:
        """Return an effect where it acts on those of some days that promise most, and a look at it.

        A course promises what its days do without the best of them.
        """
        count = len(among[0].acts) if among else 0
        alone = [self._change(on_days(effect, Days.only(day, count)), values) for day in range(count)]
        found = [each for each in alone if each is not None]
        if not found or len(found) < len(alone):
            return None
        changes, acts = np.column_stack(found), np.array([each.acts for each in among], dtype=float)
        taken, before = self.basis.T @ changes, self._free(self.missed(self.none))
        gram, pull = changes.T @ changes - taken.T @ taken, before @ changes
        power, along = np.maximum(np.sum(acts @ gram * acts, axis=1), TINY), acts @ pull
        strength = np.clip(-along / power, *self._strengths(effect, values))
        gains = -strength * along - 0.5 * strength**2 * power
        by_day = acts * (-np.outer(strength, pull) - 0.5 * np.outer(strength**2, np.diag(gram)))
        best = int(np.argmax(gains - np.maximum(0.0, by_day.max(axis=1))))
        look = Look(values, changes @ acts[best], float(strength[best]), float(gains[best]))
        return on_days(effect, among[best]), look

    def values(self, effect: EffectType, look: Look) -> Values:
        """Return the parameters of an effect at the strength of a look."""
        still = self._still(effect)
        return Space(effect).scaled(look.values, still, look.strength) if still else look.values

    def departures(self, given: Hypothesis, look: Look) -> FloatArray:
        """Return the departures (nuisances,), as far as they may go, that suit what was looked at best."""
        after = self.missed(given) + look.strength * look.change
        step = np.asarray(np.linalg.solve(self.triangle, -self.basis.T @ after))
        here = given.departures / self.problem.sd
        best = here + within(self.triangle.T @ self.triangle, step, -MOST_SD - here, MOST_SD - here)
        return np.asarray(best * self.problem.sd)

    def _looks(self, effect: EffectType, points: Sequence[Values], before: FloatArray) -> list[Look]:
        return [look for values in points if (look := self._look(effect, values, before))]

    def _look(self, effect: EffectType, values: Values, before: FloatArray) -> Look | None:
        """Return a look at one point; `before` (m + nuisances,) is missed, and no nuisance can take it."""
        change = self._change(effect, values)
        if change is None:
            return None
        way = self._free(change)
        along, power = float(before @ way), max(float(way @ way), TINY)
        strength = float(np.clip(-along / power, *self._strengths(effect, values)))
        return Look(values, change, strength, -strength * along - 0.5 * strength**2 * power)

    def _still(self, effect: EffectType) -> Values:
        """Return the parameters that make an effect nothing; it is nothing at any hours."""
        still = effect.neutral(self.problem.belief) or {}
        return {name: value for name, value in still.items() if name not in HOURS or not effect.has_hours()}

    def _strengths(self, effect: EffectType, values: Values) -> tuple[float, float]:
        """Return between which strengths an effect may act, as a factor on its distance from nothing at some values.

        An effect with hours is linear in heat, and may be as strong as its parameters can be.
        """
        still = self._still(effect)
        if not still:
            return 1.0, 1.0
        if not is_timed(effect):
            return 0.0, MOST_SCALED
        space = Space(effect)
        there, nothing = space.inside(values), space.inside({**values, **still})
        pairs = [(at, zero) for at, zero in zip(there.tolist(), nothing.tolist(), strict=True) if at != zero]
        ends = [sorted((-zero / (at - zero), (1.0 - zero) / (at - zero))) for at, zero in pairs]
        return max((low for low, _ in ends), default=0.0), min((high for _, high in ends), default=0.0)

    def _timed(self, effect: EffectType, before: FloatArray) -> list[Look]:
        """Return looks at the hours of the day between which an effect promises most."""
        found: dict[Span, Values] = {}
        for settings in self._settings(effect):
            parts = self._by_part(effect, settings)
            if parts is not None:
                strengths = self._strengths(effect, settings)
                found |= dict.fromkeys(promising(before, parts, self.basis, strengths, SEVERAL), settings)
        best = apart(list(found), SEVERAL)
        return self._looks(effect, [{**found[span], **between(span[:2])} for span in best], before)

    def _settings(self, effect: EffectType) -> Iterator[Values]:
        """Yield settings: as strong as an effect starts, every other parameter at each level; hours are set later."""
        space, starts = Space(effect), effect.starts(self.problem.belief)
        first = space.inside(starts[0]) if starts else np.ones(len(space.names))
        place = dict(zip(space.names, first.tolist(), strict=True))
        others = sorted(set(space.names) - {*HOURS, *self._still(effect)})
        for levels in product(MIDDLE if self.is_quick else LEVELS, repeat=len(others)):
            there = {**place, **dict(zip(others, levels, strict=True))}
            yield space.values(np.array([there[name] for name in space.names]))

    def _by_part(self, effect: EffectType, settings: Values) -> FloatArray | None:
        """Return what an effect changes that acts in one part of the day (m + nuisances, parts)."""
        key = effect, *sorted(settings.items())
        if key not in self._in_parts:
            changes = [self._change(effect, {**settings, **between(each)}) for each in parts_of_day()]
            found = [each for each in changes if each is not None]
            self._in_parts[key] = np.column_stack(found) if len(found) == len(changes) else None
        return self._in_parts[key]

    def _sharpened(self, effect: EffectType, look: Look, before: FloatArray) -> Look:
        """Return a look at the hours near those of another one at which the effect promises most."""
        step_h = FIRST_STEP_H
        while step_h >= LAST_STEP_H:
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
        """Return how what is missed changes with an effect (m + nuisances,), None where it cannot be."""

        def made() -> FloatArray | None:
            look = self.problem.at(((effect, values),), self.none.departures, self.none.convention)
            nothing, without = np.zeros(len(self.problem.sd)), self.beside(effect, self.none)
            return np.concatenate((look.whitened - without.whitened, nothing)) if look else None

        return self._seen.get((effect, *sorted(values.items())), made)

    def _free(self, missed: FloatArray) -> FloatArray:
        """Return what the nuisances cannot take of what is missed."""
        return np.asarray(missed - self.basis @ (self.basis.T @ missed))


def is_timed(effect: EffectType) -> bool:
    """Whether hours of an effect add up: it gives a room heat between them. Setpoints of some hours do not."""
    return effect.has_hours() and effect.stage == "room"


def has_hours(effect: EffectType, values: Values) -> bool:
    """Whether an effect gives a room heat between two hours of a day, and rests at others."""
    return is_timed(effect) and not acts_all_day(effect, values)


def acts_all_day(effect: EffectType, values: Values) -> bool:
    """Whether an effect with hours rests for less than one part of the day."""
    if not is_timed(effect):
        return False
    from_h, to_h = (values[name] for name in HOURS)
    return open_h(from_h, to_h) > DAY_H - DAY_H / BINS


def between(hours: Sequence[float]) -> Values:
    """Return the parameters of an effect that acts between two hours."""
    return dict(zip(HOURS, hours, strict=True))
