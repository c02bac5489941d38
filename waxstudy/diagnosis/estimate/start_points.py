"""Where to start a fit of an effect: points all over its parameters, the nuisances following in a straight line."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import itemgetter

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Problem
from waxstudy.diagnosis.estimate.parameter_space import Space
from waxstudy.diagnosis.estimate.solver import MOST_SD
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.edits import Edits, EffectType, Values
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray

IMPOSSIBLE = 1e12  # score of a belief that cannot be
MOST_SCALED = 4.0  # chosen, of a search: times a point of a first look
SCALED = 4  # such points that are tried at the strength that suits the record
TINY = 1e-12
MANY = 4  # parameters of a chain, from which on the best point of a first look may lead nowhere
# chosen, effort of searches all over the parameters, in a quick look too: 27 searches of nine records ended as low as
# longer ones; with 25 generations some did not. Where slopes lead on from there a few generations are enough
MEMBERS, GENERATIONS, FEW = 32, 30, 10
SHORT = 0.5  # chosen: how far a search for little of an effect goes, as a share of the logarithm of noticeable steps


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
        strength = min(MOST_SCALED, max(0.0, along / power))
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
        self.changed: set[str] = set()  # channels that the effect changes anywhere
        self.problem, self.score, self.effect, self.given, self.parts = problem, score, effect, given, parts
        self.straight, self.thorough, self.space = straight, thorough, Space(effect)

    def best(self, convention: Convention) -> tuple[float, Values]:
        """Return the least score, and the values that it is found at, with one way to read the record."""
        given = self.given
        neutral = self.effect.neutral(self.problem.edited(given.effects, given.departures))
        is_scaled = bool(self.straight and neutral)
        still = self._at(given.effects, convention)
        before = still.missed(self.parts) if still and is_scaled else None
        scored, scaled = list[tuple[float, Values]](), list[tuple[float, Values]]()
        spread = *self.space.points(self.thorough), *self.effect.starts(self.problem.belief)
        found_before = self.near if self._is_near else (*spread, *self.near)
        points = *found_before, *self.space.near(neutral)
        for values in points:
            look = self._with(values, convention)  # one at a time: each is several times as long as the record
            if not self.straight:  # a room is never searched all over
                self._note_changes(still, look)
            self._screened(values, look, still, neutral, convention)
            if before is not None and neutral is not None:
                scaled.append(self._scaled(values, look, before, neutral))
            scored.append((self.score(look, self.parts), values))
        more = [values for _, values in sorted(scaled, key=itemgetter(0))[:SCALED]]
        scored += [(self.score(self._with(values, convention), self.parts), values) for values in more]
        return min(scored, key=itemgetter(0))

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

    def evolved(self, convention: Convention) -> Iterator[tuple[float, Values, Convention]]:
        """Yield the best places that searches all over the parameters find, of an effect of a chain that needs them.

        No way leads downhill to hours that are far off, nor from much of an effect at wrong hours to little at right
        ones: a few switches tell little. Of many parameters a first look is too coarse, if it promises anything.
        Nothing is looked for where too little is missed, and where a look before began near.
        """
        neutral = self.effect.neutral(self.problem.edited(self.given.effects, self.given.departures)) or {}
        # some parameters, as hours, do not matter where an effect does nothing
        has_free = bool(neutral) and not neutral.keys() >= set(self.space.names)
        is_many = len(self.space.names) >= MANY and not self.is_hopeless
        if self._is_near or not self._is_worth_it or not (has_free or is_many):
            return
        still = self._still(convention)  # once: a long record is not remembered
        for most in (SHORT, 1.0) if has_free else (1.0,):
            values = self._searched(neutral, most, replace(convention, is_rough=True), GENERATIONS if has_free else FEW)
            yield *self._looked(values, convention, still), convention

    def _searched(self, neutral: Values, most: float, convention: Convention, generations: int) -> Values:
        """Return the values of the least score up to a share `most` of the way, as differential evolution finds them.

        Storn and Price (1997, doi:10.1023/A:1008202821328).
        """
        from scipy.optimize import Bounds, differential_evolution

        def score(x: FloatArray) -> float:
            return self.score(self._with(self.space.away(neutral, x, most), convention), self.parts)

        count = len(self.space.names)
        found = differential_evolution(
            score,
            Bounds(np.zeros(count), np.ones(count)),
            popsize=MEMBERS // count,
            maxiter=generations,
            tol=0.0,
            rng=np.random.default_rng(3),
            polish=False,
            init="sobol",  # takes the next power of 2 of members
        )
        return self.space.away(neutral, found.x, most)

    @property
    def _is_near(self) -> bool:
        """Whether an effect by itself was looked for before."""
        return bool(self.near) and not self.given.effects

    @property
    def _is_worth_it(self) -> bool:
        """Whether what an effect changes is missed by more, beyond what it is weighed by, than its parameters cost."""
        missed = [each for each in self.given.residuals if each.channel in self.changed]
        beyond = sum(max(0.0, each.loss() - float(each.judged.sum())) for each in missed)
        return 0.5 * beyond > WEIGHTS.price * len(self.space.names)

    def _note_changes(self, still: Hypothesis | None, look: Hypothesis | None) -> None:
        if still and look:
            pairs = zip(still.residuals, look.residuals, strict=True)
            self.changed |= {old.channel for old, new in pairs if not np.array_equal(old.whitened, new.whitened)}

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

    def _still(self, convention: Convention) -> Hypothesis | None:
        """Return what looks are screened against: the given hypothesis; nothing without a screen."""
        return self._at(self.given.effects, convention) if self.screen else None

    def _looked(self, values: Values, convention: Convention, still: Hypothesis | None) -> tuple[float, Values]:
        """Return the score of values, with them; what they promise is noted."""
        neutral = self.effect.neutral(self.problem.edited(self.given.effects, self.given.departures))
        look = self._with(values, convention)
        self._screened(values, look, still, neutral, convention)
        return self.score(look, self.parts), values

    def _scaled(
        self, values: Values, look: Hypothesis | None, before: FloatArray, neutral: Values
    ) -> tuple[float, Values]:
        """Return what the strength that suits the record would leave, and such values: a room answers in proportion.

        A window of the right hours, but of thrice the flow, would look worse than none.
        """
        change = look.missed(self.parts) - before if look else np.zeros(len(before))
        along = float(before @ change) / max(float(change @ change), TINY)
        strength = min(MOST_SCALED, max(0.0, -along))
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
