"""Where to start a fit of an effect: points all over its parameters, the nuisances following in a straight line."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from operator import itemgetter

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Problem
from waxstudy.diagnosis.estimate.parameter_space import Edits, EffectType, Space, Values, stepped
from waxstudy.diagnosis.estimate.solver import MOST_SD, LeastSquares
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.plugin import HOURS, FloatArray

IMPOSSIBLE = 1e12  # score of a belief that cannot be
STRONGEST = 4.0  # times a point of a first look
SCALED = 4  # such points that are tried at the strength that suits the record
TINY = 1e-12
MANY = 4  # parameters of a chain, from which on the best point of a first look may lead nowhere
SCANNED = 24  # hours of a day, in a quick look too: fewer lie too far apart to lead to the right ones
STARTS, STEPS, FAR = 8, 5, 0.1  # such points, steps from each, and the share of a range that their slopes look over


@dataclass(frozen=True)
class Screen:
    """What an effect must promise for a closer look: log likelihood that it would gain, were all straight."""

    least: float  # infinite for an effect that could not show whatever it promised
    share: Mapping[str, float]  # by channel: how many samples count as one

    def gain(self, given: Hypothesis, look: Hypothesis) -> tuple[float, float]:
        """Return the most that is gained along the change that a look makes, and how far along it."""
        weight = [each.weights(self.share) for each in given.residuals]
        pairs = zip(given.residuals, look.residuals, weight, strict=True)
        along, power = 0.0, TINY
        for old, new, each in pairs:
            change = each * (new.whitened - old.whitened)
            along -= float(change @ (each * old.whitened))
            power += float(change @ change)
        strength = min(STRONGEST, max(0.0, along / power))
        return strength * along - 0.5 * strength**2 * power, strength


class StartPoints:
    """Where an effect, added to a hypothesis, may be worth a closer look.

    `straight` is how the nuisances follow: slopes, what solves for them, which residuals are fitted; None without any.
    `near` are values that another look at the record found; an effect by itself then needs no points that are spread.
    """

    def __init__(
        self,
        problem: Problem,
        score: Callable[[Hypothesis | None, Sequence[int]], float],
        effect: EffectType,
        given: Hypothesis,
        parts: Sequence[int],
        straight: tuple[FloatArray, FloatArray, np.ndarray] | None,
        thorough: float,
        screen: Screen | None = None,
        near: Values | None = None,
    ) -> None:
        self.screen = screen
        self.near = [] if near is None else [near]
        self.promised: tuple[float, Values, Convention] | None = None  # log likelihood, at most, and where
        self.problem, self.score, self.effect, self.given, self.parts = problem, score, effect, given, parts
        self.straight, self.thorough, self.space = straight, thorough, Space(effect)

    def best(self, convention: Convention) -> tuple[float, Values]:
        """Return the least score, and the values that it is found at, with one way to read the record."""
        given = self.given
        neutral = self.effect.neutral(self.problem.edited(given.effects, given.departures))
        is_scaled = bool(self.straight and neutral)
        still = self._at(given.effects, convention) if self.screen or is_scaled else None
        before = still.missed(self.parts) if still and is_scaled else None
        scored, scaled = list[tuple[float, Values]](), list[tuple[float, Values]]()
        spread = *self.space.points(self.thorough), *self.effect.starts(self.problem.belief)
        found_before = self.near if self.near and not given.effects else (*spread, *self.near)
        points = *found_before, *self.space.near(neutral)
        for values in points:
            look = self._with(values, convention)  # one at a time: each is several times as long as the record
            self._screened(values, look, still, neutral, convention)
            if before is not None and neutral is not None:
                scaled.append(self._scaled(values, look, before, neutral))
            scored.append((self.score(look, self.parts), values))
        more = [values for _, values in sorted(scaled, key=itemgetter(0))[:SCALED]]
        scored += [(self.score(self._with(values, convention), self.parts), values) for values in more]
        found = sorted(scored, key=itemgetter(0))
        if self.straight or len(self.space.names) < MANY or self.is_hopeless:
            return found[0]
        starts = round(STARTS * min(1.0, self.thorough))
        walked = [self._walked(values, convention) for _, values in found[:starts]]
        return min((found[0], *walked), key=itemgetter(0))

    @property
    def is_hopeless(self) -> bool:
        """Whether the effect would gain too little for a closer look, by all that was looked at."""
        return bool(self.screen and self.promised and self.promised[0] < self.screen.least)

    @property
    def cannot_show(self) -> bool:
        """Whether no promise is enough for a closer look."""
        return self.screen is not None and self.screen.least == np.inf

    def _screened(
        self,
        values: Values,
        look: Hypothesis | None,
        still: Hypothesis | None,
        neutral: Values | None,
        convention: Convention,
    ) -> None:
        if look is None or still is None or self.screen is None:
            return
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

    def scanned(
        self, score: float, values: Values, convention: Convention
    ) -> Iterator[tuple[float, Values, Convention]]:
        """Yield a place with the hours of an effect of a chain looked at all over the day, and such of little of it.

        A few switches tell little of hours that are far off: no way leads downhill to the right ones, nor from much of
        an effect at wrong hours to little at the right ones.
        """
        neutral = self.effect.neutral(self.problem.edited(self.given.effects, self.given.departures))
        hours = [name for name in self.space.names if neutral is not None and name not in neutral]
        if neutral is None or not hours:
            yield score, values, convention
            return
        yield *self._scanned(score, values, hours, convention), convention
        steps = [(name, stepped(self.effect.priors[name], neutral[name], way)) for name in neutral for way in (-1, 1)]
        little = [{**values, **neutral, name: value} for name, value in steps if value != neutral[name]]
        found = [self._scanned(IMPOSSIBLE, each, hours, convention) for each in little]
        best = min(found, key=itemgetter(0), default=(IMPOSSIBLE, values))
        if best[0] < IMPOSSIBLE:
            yield *best, convention

    def again(self, values: Values, convention: Convention) -> tuple[float, Values, Convention]:
        """Return the score of values with another way to read the record, with them and it."""
        return *self._looked(values, convention, self._still(convention)), convention

    def better(self, place: tuple[float, Values, Convention], values: Values) -> tuple[float, Values, Convention]:
        """Return a place, or the same way to read the record with other values, whichever misses less.

        Hours that were looked at all over the day in one way are a start in any other.
        """
        convention = place[2]
        other = *self._looked(values, convention, self._still(convention)), convention
        return min(place, other, key=itemgetter(0))

    def _scanned(
        self, score: float, values: Values, hours: Sequence[str], convention: Convention
    ) -> tuple[float, Values]:
        """Return the best of a place, of the hours that promise most, and of each hour in turn, twice."""
        still = self._still(convention)  # once: a long record is not remembered
        most = self._looked(self._between(values, hours, convention), convention, still)
        best = min((score, values), most, key=itemgetter(0))
        for name in (*hours, *hours):
            prior = self.effect.priors[name]
            for at in np.linspace(prior.low, prior.high, SCANNED, endpoint=False):
                best = min(best, self._looked({**best[1], name: float(at)}, convention, still), key=itemgetter(0))
        return best

    def _still(self, convention: Convention) -> Hypothesis | None:
        """Return what looks are screened against: the given hypothesis; nothing without a screen."""
        return self._at(self.given.effects, convention) if self.screen else None

    def _looked(self, values: Values, convention: Convention, still: Hypothesis | None) -> tuple[float, Values]:
        """Return the score of values, with them; what they promise is noted."""
        neutral = self.effect.neutral(self.problem.edited(self.given.effects, self.given.departures))
        look = self._with(values, convention)
        self._screened(values, look, still, neutral, convention)
        return self.score(look, self.parts), values

    def _between(self, values: Values, hours: Sequence[str], convention: Convention) -> Values:
        """Return values with the hours between which an effect that acts always would gain most.

        As if what happens at each hour hung on nothing before it: one hour after the other may lead nowhere.
        """
        if set(hours) != set(HOURS):  # else something that is no matter where the effect does nothing
            return values
        first, last = HOURS
        always = {**values, first: self.effect.priors[first].low, last: self.effect.priors[last].high}
        still, look = self._at(self.given.effects, convention), self._with(always, convention)
        if still is None or look is None:
            return values
        gain = np.zeros(SCANNED)
        for old, new in zip(still.residuals, look.residuals, strict=True):
            fitted, hour = np.isin(new.part, self.parts), self.problem.clock_h[new.sample].astype(int)
            gain += np.bincount(hour[fitted], (old.whitened**2 - new.whitened**2)[fitted], SCANNED)
        until = np.concatenate(([0.0], np.cumsum((*gain, *gain))))
        spans = product(range(SCANNED), range(1, SCANNED))
        start, lasts = max(spans, key=lambda span: until[sum(span)] - until[span[0]])
        return {**values, first: float(start), last: float((start + lasts) % SCANNED)}

    def _scaled(
        self, values: Values, look: Hypothesis | None, before: FloatArray, neutral: Values
    ) -> tuple[float, Values]:
        """Return what the strength that suits the record would leave, and such values: a room answers in proportion.

        A window of the right hours, but of thrice the flow, would look worse than none.
        """
        change = look.missed(self.parts) - before if look else np.zeros(len(before))
        along = float(before @ change) / max(float(change @ change), TINY)
        strength = min(STRONGEST, max(0.0, -along))
        left = before + strength * change
        return float(left @ left), self.space.scaled(values, neutral, strength)

    def _with(self, values: Values, convention: Convention) -> Hypothesis | None:
        return self._at((*self.given.effects, (self.effect, values)), convention)

    def _at(self, effects: Edits, convention: Convention) -> Hypothesis | None:
        """Return a hypothesis with the room's departures where they would go, were everything straight from here."""
        fitted = self.problem.at(effects, self.given.departures, convention)
        if fitted is None or self.straight is None:
            return fitted
        (slopes, solution, fit), sd = self.straight, self.problem.sd
        whole = fitted.whitened
        step = -solution @ np.concatenate((whole[fit], self.problem.prior @ (fitted.departures / sd)))
        step = np.clip(fitted.departures + step, -MOST_SD * sd, MOST_SD * sd) - fitted.departures
        moved = _parted(whole + slopes @ step, fitted)
        return replace(fitted, residuals=[replace(e, whitened=v) for e, v in zip(fitted.residuals, moved, strict=True)])


def _parted(whole: FloatArray, fitted: Hypothesis) -> Sequence[FloatArray]:
    """Return a vector of all channels as one of each."""
    return np.split(whole, np.cumsum([len(each.whitened) for each in fitted.residuals])[:-1])
