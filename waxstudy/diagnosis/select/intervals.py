"""Intervals of what was fitted and of how far the gap shrinks, from whole cycles or days."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.estimate.parameter_space import Space
from waxstudy.diagnosis.model.edits import EffectType, Values
from waxstudy.diagnosis.model.travel import opening, opening_difference_s
from waxstudy.diagnosis.observations.partition import BOTH, FIT, SELECT, SHRINK
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.result import NORMAL, Interval
from waxstudy.diagnosis.select.null import by_block, redrawn, whole
from waxstudy.plugin import HOURS, FloatArray, Prior
from waxstudy.plugin.hours import DAY_H

DRAWS = 1000
WIDER = 1.4  # chosen: by so much intervals that are straight lines from one fit have to be wider to cover the truth
WIDTH = 0.02  # of a parameter's range, over which slopes are taken
# chosen: an end farther than this share of a range is looked at; where by so many times more is missed than a straight
# line has it, it is drawn in: a setback below what the night cools to says no more than that it is one
FAR, BENT, HALVINGS = 0.1, 4.0, 8
LEAST_WIDTH = 1e-5  # over which it is seen whether anything changes at all
RANGE = (2.5, 97.5)
TIMING = 1.0 / 6.0  # of an interval: standard deviation of a time that switches within it leave open
CLOCK_S = 3.0  # chosen: the same of when a motor was told, by a controller that looks every ten seconds or so


Intervals = Mapping[EffectType, Mapping[str, Interval]]


def parameter_intervals(estimator: Estimator[SegmentProblem], fitted: Hypothesis) -> Intervals:
    """Return the parameters of each effect with 95 % intervals from the scatter of blocks.

    That is a sandwich estimate (Huber 1967, White 1980, doi:10.2307/1912934). An effect may take the place of an
    uncertainty of the room. That uncertainty still widens the effect's interval: beside a healthy record by its
    covariance with all others, without one by its spread, added to the factor. Where another convention of the record
    fits as well, the intervals reach to what it gives.
    """
    others = [dict(other.effects) for other in _as_good(estimator, fitted)]
    return {
        effect: {
            name: _reach(effect, name)(interval, [other[effect][name] for other in others])
            for name, interval in each.items()
        }
        for effect, each in _Local(estimator.problem, fitted).intervals().items()
    }


def _as_good(estimator: Estimator[SegmentProblem], fitted: Hypothesis) -> Iterator[Hypothesis]:
    """Yield the fits under other conventions that cannot be told from this one."""
    most = estimator.score(fitted, BOTH) + estimator.other * estimator.form_share(fitted)
    for convention in estimator.conventions:
        if convention != fitted.convention:
            other = estimator.refined(fitted.effects, fitted.departures, convention, BOTH)
            if other and estimator.score(other, BOTH) <= most:
                yield other


def _reach(effect: EffectType, name: str) -> Callable[[Interval, Sequence[float]], Interval]:
    """Return what widens the interval of a parameter; hours of the day go round."""
    is_hour = effect.has_hours() and name in HOURS
    return _reaching_round if is_hour else partial(_reaching, prior=effect.priors[name])


def _reaching(interval: Interval, values: Sequence[float], prior: Prior) -> Interval:
    """Return an interval that holds other values too, with as much around each of them."""

    def moved(end: float, value: float) -> float:
        return end * value / interval.value if prior.is_log else end + value - interval.value

    low = min([interval.low, *(moved(interval.low, value) for value in values)])
    high = max([interval.high, *(moved(interval.high, value) for value in values)])
    return Interval(interval.value, max(prior.low, low), min(prior.high, high))


def _reaching_round(interval: Interval, values: Sequence[float]) -> Interval:
    """Return the same of hours of the day, which go on after midnight."""
    value = interval.value
    before, after = (value - interval.low) % DAY_H, (interval.high - value) % DAY_H
    steps = [(each - value + 0.5 * DAY_H) % DAY_H - 0.5 * DAY_H for each in values]
    before, after = before - min([0.0, *steps]), after + max([0.0, *steps])
    if before + after >= DAY_H:
        return Interval(value, 0.0, DAY_H)
    return Interval(value, (value - before) % DAY_H, (value + after) % DAY_H)


class _Local:
    """A fitted hypothesis and what lies around it."""

    def __init__(self, problem: SegmentProblem, fitted: Hypothesis) -> None:
        self.problem, self.fitted, self.now = problem, fitted, fitted.whitened
        self.spaces = {effect: Space(effect) for effect, _ in fitted.effects}
        self.inside = {effect: self.spaces[effect].inside(values) for effect, values in fitted.effects}
        _, part, _ = whole(fitted)
        self.seen = (part == FIT) | (part == SELECT)
        self.rows = [(effect, place) for effect, space in self.spaces.items() for place in range(len(space.names))]

    def intervals(self) -> dict[EffectType, dict[str, Interval]]:
        found: dict[EffectType, dict[str, Interval]] = {effect: {} for effect in self.spaces}
        if not self.rows:
            return found
        slopes = self._slopes()
        sd, wide = self._deviations(slopes)
        for number, (effect, place) in enumerate(self.rows, start=len(self.problem.sd)):
            half = self._half_width(effect, place, wide * float(sd[number]))
            most = BENT * half**2 * float(np.sum(slopes[self.seen, number] ** 2))
            low, high = self.inside[effect].copy(), self.inside[effect].copy()
            low[place] -= max(self._drawn_in(effect, place, -half, most), self._still(effect, place, -1))
            high[place] += max(self._drawn_in(effect, place, half, most), self._still(effect, place, 1))
            space, name = self.spaces[effect], self.spaces[effect].names[place]
            is_all_day = space.wraps[place] and high[place] - low[place] >= 1.0
            ends = (0.0, DAY_H) if is_all_day else (space.values(low)[name], space.values(high)[name])
            found[effect][name] = Interval(dict(self.fitted.effects)[effect][name], *ends)
        return found

    def _drawn_in(self, effect: EffectType, place: int, step: float, most: float) -> float:
        """Return how far a parameter may go one way, no farther than where `most` more is missed."""
        if abs(step) < FAR or self._missed_more(effect, place, step) <= most:
            return abs(step)
        near, far = 0.0, step
        for _ in range(HALVINGS):
            middle = 0.5 * (near + far)
            near, far = (middle, far) if self._missed_more(effect, place, middle) <= most else (near, middle)
        return abs(far)

    def _missed_more(self, effect: EffectType, place: int, step: float) -> float:
        """Return by how much more is missed a step away than by the fit; what cannot be is missed by no more."""
        there = float(np.clip(self.inside[effect][place] + step, 0.0, 1.0))
        other = self._at(effect, place, there)
        if other is None:
            return 0.0
        before, after = (float(np.sum(each[self.seen] ** 2)) for each in (self.now, other.whitened))
        return after - before

    def _deviations(self, slopes: FloatArray) -> tuple[FloatArray, float]:
        """Return the standard deviation of each departure and parameter, and how many of them an interval is wide."""
        from scipy.stats import t

        residual, _, block = whole(self.fitted)
        seen, missed = self.seen, slopes[self.seen]
        nuisances = len(self.problem.sd)
        prior = 1e-9 * np.eye(nuisances + len(self.rows))
        prior[:nuisances, :nuisances] = self.problem.prior.T @ self.problem.prior
        scores = by_block((missed * residual[seen][:, None]).T, block[seen])
        count = scores.shape[1]
        inverse = np.linalg.pinv(missed.T @ missed + prior)
        spread = inverse @ (scores @ scores.T) @ inverse * count / max(1, count - len(self.rows))
        spread += inverse if nuisances else 0.0
        off = inverse @ (missed.T @ self.problem.inexact(self.fitted)[seen])
        sd = np.sqrt(np.clip(np.diag(spread), 0.0, None) + off**2)
        return sd, WIDER * float(t.ppf(0.975, max(1, count - 1)))

    def _slopes(self) -> FloatArray:
        """Return the change of the whitened residuals with each departure and parameter (m, k)."""
        departed = [self._departure_slope(place, sd) for place, sd in enumerate(self.problem.sd)]
        return np.column_stack([*departed, *(self._slope(*row) for row in self.rows)])

    def _departure_slope(self, place: int, sd: float) -> FloatArray:
        """Return the change of the whitened residuals with a departure, over its standard deviation.

        Beside a healthy record, effects that take the place of what departs are left out: they would hide it.
        """
        name, effects, before = self.problem.nuisances[place].name, self.fitted.effects, self.fitted
        hides = [each for each in effects if name in each[0].absorbs]
        if hides and self.problem.as_built is not None:
            effects = tuple(each for each in effects if each not in hides)
            before = self.problem.at(effects, self.fitted.departures, self.fitted.convention) or self.fitted
        departures = self.fitted.departures.copy()
        departures[place] += 0.1 * sd
        after = self.problem.at(effects, departures, self.fitted.convention)
        return (after.whitened - before.whitened) / 0.1 if after else np.zeros(len(self.now))

    def _slope(self, effect: EffectType, place: int) -> FloatArray:
        """Return the change over the range of one parameter, from both sides where both are possible."""
        found, here = [], self.inside[effect][place]
        for width in (-WIDTH, WIDTH):
            there = float(np.clip(here + width, 0.0, 1.0))
            if there != here and (other := self._at(effect, place, there)):
                found.append((other.whitened - self.now) / (there - here))
        return np.asarray(np.mean(found, axis=0)) if found else np.zeros(len(self.now))

    def _moved(self, effect: EffectType, place: int, there: float) -> list[tuple[EffectType, Values]]:
        """Return the effects with one parameter at another place of its range."""
        x = self.inside[effect].copy()
        x[place] = there
        return [(each, self.spaces[each].values(x) if each is effect else v) for each, v in self.fitted.effects]

    def _at(self, effect: EffectType, place: int, there: float) -> Hypothesis | None:
        return self.problem.at(self._moved(effect, place, there), self.fitted.departures, self.fitted.convention)

    def _half_width(self, effect: EffectType, place: int, half: float) -> float:
        """Return half the width of an interval, as a share of the range, with what the scatter of blocks leaves out."""
        prior = self.spaces[effect].priors[place]
        half = float(np.hypot(half, 2.0 * self._timing(effect, place)))
        if not (prior.is_log and effect.absorbs) or self.problem.as_built is not None:
            return half
        sds = [nuisance.sd for nuisance in self.problem.nuisances if nuisance.name in effect.absorbs]
        spread = sum(sd**2 for sd in sds) ** 0.5
        return float(np.hypot(half, NORMAL * spread / np.log(prior.high / prior.low)))

    def _still(self, effect: EffectType, place: int, way: int) -> float:
        """Return how far one way a parameter may go before anything recorded would change, as a share of its range."""
        still, width = 0.0, LEAST_WIDTH
        while still < 1.0 and self._is_as_now(effect, place, way * width):
            still, width = width, 2.0 * width
        if not 0.0 < still < 1.0:
            return still
        for _ in range(HALVINGS):
            middle = 0.5 * (still + width)
            still, width = (middle, width) if self._is_as_now(effect, place, way * middle) else (still, middle)
        return width

    def _is_as_now(self, effect: EffectType, place: int, step: float) -> bool:
        """Whether nothing recorded would change if a parameter were a step away."""
        other = self._at(effect, place, self.inside[effect][place] + step)
        return other is not None and np.array_equal(other.whitened, self.now)

    def _timing(self, effect: EffectType, place: int) -> float:
        """Return what the sampling of a drive's switches leaves open of a parameter, as a share of its range.

        Nobody knows when within an interval each of them was thrown; the residual puts it where it fits best, so that a
        time may be off by nearly as much as that lets it, and a motor's pace by what moves its opening as much. A
        motor's times are known no better than when it was told, whatever drives it.
        """
        problem, is_motor = self.problem, effect.stage == "actuator"
        is_switched = problem.segment.driven_by in problem.record.binary
        if not is_switched and not is_motor:
            return 0.0
        name, prior = self.spaces[effect].names[place], self.spaces[effect].priors[place]
        value = dict(self.fitted.effects)[effect][name]
        open_s = max(TIMING * problem.record.interval_s if is_switched else 0.0, CLOCK_S if is_motor else 0.0)
        if not name.endswith("_s"):
            return open_s / moved_s if is_motor and (moved_s := self._moved_s(effect, place)) else 0.0
        if prior.is_log:
            return float(open_s / max(value, open_s) / np.log(prior.high / prior.low))
        return float(open_s / (prior.high - prior.low))

    def _moved_s(self, effect: EffectType, place: int) -> float:
        """Return by how much of a switch [s] a parameter of an actuator moves its opening, over its whole range."""
        here = self.inside[effect][place]
        moved = self._moved(effect, place, here + (WIDTH if here < 0.5 else -WIDTH))
        beliefs = [self.problem.edited(each, self.fitted.departures) for each in (self.fitted.effects, moved)]
        before, after = (opening(self.problem.record, belief) for belief in beliefs)
        if before is None or after is None:
            return 0.0
        return opening_difference_s(self.problem.record, before - after) / WIDTH


def shrink(before: Residual, after: Residual, floor: float, random: np.random.Generator) -> Interval:
    """Return 1 - (after^2 - floor^2) / (before^2 - floor^2) on the last part, with its 95 % interval over blocks.

    No number where no gap was above the floor there, at that confidence: nothing could shrink, and a ratio to what may
    be nothing has no interval (Fieller, 1954).
    """
    part = SHRINK if (before.part == SHRINK).any() else SELECT
    chosen = before.judged & after.judged & (before.part == part)
    nothing = Interval(float("nan"), float("nan"), float("nan"))
    if not chosen.any() or np.mean(before.error[chosen] ** 2) <= floor**2:
        return nothing
    rows = np.array([before.error[chosen] ** 2, after.error[chosen] ** 2, np.ones(chosen.sum())])
    *both, count = by_block(rows, before.block[chosen])
    squares, weights = np.array(both), redrawn(len(count), DRAWS, random).T
    means = squares @ weights / (count @ weights)
    is_above = means[0] > floor**2
    if np.mean(is_above) < RANGE[1] / 100.0:
        return nothing
    drawn = _shrunk(means[:, is_above], floor)
    value = float(_shrunk((squares.sum(axis=1) / count.sum())[:, None], floor)[0])
    low, high = np.percentile(np.append(drawn, value), RANGE)
    return Interval(value, float(min(low, value)), float(max(high, value)))


def _shrunk(squares: FloatArray, floor: float) -> FloatArray:
    return np.asarray(1.0 - (squares[1] - floor**2) / (squares[0] - floor**2))
