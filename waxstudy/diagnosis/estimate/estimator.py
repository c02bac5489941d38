"""Fitting effects and, where a room takes part, what nobody knows of it, to a problem."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import itemgetter
from typing import Generic, TypeVar

import numpy as np

from waxstudy.diagnosis.criteria import LIMITS
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Problem
from waxstudy.diagnosis.estimate.parameter_space import (
    NARROW,
    QUICK_NARROW,
    Edits,
    EffectType,
    Space,
    descend,
    valued,
)
from waxstudy.diagnosis.estimate.solver import LITTLE, LeastSquares
from waxstudy.diagnosis.estimate.start_points import Screen, StartPoints
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.observations.partition import ALL, FIT
from waxstudy.plugin import FloatArray

IMPOSSIBLE = 1e12  # loss of a belief that cannot be
REFINE = {1: 30, 2: 60, 3: 110}
REFINE_MORE = 160
STEPS = 25  # of Gauss and Newton
EVENT_STEPS = 3  # of what once happened, to all days
TURNS = 4  # most places where the slopes of a room are taken, one after the other
FAR = 2e-3  # share of the loss that a fit takes away, from which on slopes are taken where it ended
CLOSE = 1e-5  # share of the loss that is not worth another step, where a step is but one simulation
P = TypeVar("P", bound=Problem)


@dataclass(frozen=True)
class Followed:
    """A fit of the nuisances alone, with the slopes (m, nuisances) that it followed, and the departures they are of."""

    fitted: Hypothesis
    slopes: FloatArray
    place: FloatArray


class Estimator(Generic[P]):
    """Fits hypotheses to one problem, always from the same belief. `thorough` below 1 looks at less.

    Slopes of the nuisances are those at its base, or of a fit that came `before`, and are kept for all else: a room
    answers nearly in a straight line.
    """

    def __init__(self, problem: P, thorough: float = 1.0, before: Followed | None = None) -> None:
        self.problem, self.thorough, self.is_quick, self.before = problem, thorough, thorough < 1.0, before
        self.has_nuisances = len(problem.sd) > 0

    @cached_property
    def base(self) -> Hypothesis:
        """The belief itself, fitted, and read in the way that fits best."""
        if self.has_nuisances:
            return self.followed.fitted
        return self._best([self.problem.at((), np.zeros(0), convention) for convention in self.problem.conventions])

    @cached_property
    def followed(self) -> Followed:
        """The belief with its nuisances fitted from what came before, or from what is believed."""
        if self.before is None:
            return self.follow(np.zeros(len(self.problem.sd)), self.problem.conventions[0], (FIT,))
        start, slopes = self.before.fitted.departures, self.before.slopes
        fitted = self.nuisance_fit((), start, self.before.fitted.convention, (FIT,), slopes)
        return replace(self.before, fitted=fitted or self.before.fitted)

    def follow(
        self, start: FloatArray, convention: Convention, parts: Sequence[int], place: FloatArray | None = None
    ) -> Followed:
        """Return a fit of the nuisances from a start, by slopes that are taken again only where it has gone far.

        The first are taken at the start, or at another place, which other problems may have simulated before.
        """
        best = self._best([self.problem.at((), start, convention)])
        place = start if place is None else place
        slopes = self.slopes_at(self._best([self.problem.at((), place, convention)]))
        for turn in range(TURNS):
            found = self.nuisance_fit((), best.departures, convention, parts, slopes) or best
            gained = self.score(best, parts) - self.score(found, parts)
            best = found
            if gained <= FAR * self.score(best, parts) or turn == TURNS - 1:
                break
            place, slopes = best.departures, self.slopes_at(best)
        return Followed(best, slopes, place)

    def base_as(self, convention: Convention) -> Hypothesis:
        """Return the belief itself under a convention of the record."""
        if convention == self.base.convention:
            return self.base
        return self.refined((), self.base.departures, convention) or self.base

    @cached_property
    def conventions(self) -> Sequence[Convention]:
        """Ways to read the record with an effect: the belief's, and those that differ from it in one choice."""
        return [each for each in self.problem.conventions if each.differs(self.base.convention) <= 1]

    def _best(self, tried: Sequence[Hypothesis | None]) -> Hypothesis:
        done = [each for each in tried if each is not None]
        if not done:
            raise ValueError(f"what is believed of {self.problem.name} cannot be simulated")
        return min(done, key=lambda each: self.fair_score(each, (FIT,)))

    def score(self, fitted: Hypothesis | None, parts: Sequence[int]) -> float:
        """Return what a fit misses on some parts, with how far its departures went; much where it cannot be."""
        if fitted is None:
            return IMPOSSIBLE
        return sum(fitted.loss(part) for part in parts) + self.strain(fitted) + fitted.convention.handicap

    def fair_score(self, fitted: Hypothesis, parts: Sequence[int]) -> float:
        """Return the score without what the drive's noise adds to a controller's output that runs on.

        Of two conventions one may let less of it through.
        """
        noise = self.problem.drive_noise(fitted) if self.problem.discounts_noise else {}
        return self.score(fitted, parts) - sum(noise.get(part, 0.0) for part in parts)

    def strain(self, fitted: Hypothesis) -> float:
        """Return the squares of the room's departures, in standard deviations."""
        if not self.has_nuisances:
            return 0.0
        return float(np.sum((self.problem.prior @ (fitted.departures / self.problem.sd)) ** 2))

    def fit(
        self, effect: EffectType, given: Hypothesis, parts: Sequence[int] = (FIT,), screen: Screen | None = None
    ) -> Hypothesis | None:
        """Return a hypothesis of a chain with one more effect, fitted to some parts; None where it cannot be.

        One that promises too little by a screen is where a straight line has it best.
        """
        if effect.hindrance(self.problem.edited(given.effects, given.departures)):
            return None
        look = StartPoints(self.problem, self.score, effect, given, parts, self.thorough, screen)
        found = sorted([(*look.best(convention), convention) for convention in self.conventions], key=itemgetter(0))
        if look.promised and look.is_hopeless:
            _, values, convention = look.promised
            return self.problem.at((*given.effects, (effect, values)), given.departures, convention)
        ends = [
            self.refined((*given.effects, (effect, values)), given.departures, convention, parts)
            for score, values, convention in found
            if score < IMPOSSIBLE
        ]

        def cost(each: Hypothesis) -> float:
            # an effect may do no more than undo another reading of the record
            return self.fair_score(each, parts) + (0.0 if each.convention == given.convention else LIMITS.convention)

        return min((each for each in ends if each is not None), key=cost, default=None)

    @cached_property
    def base_slopes(self) -> FloatArray:
        return self.followed.slopes

    def slopes_at(self, fitted: Hypothesis, places: Sequence[int] | None = None) -> FloatArray:
        """Change of the whitened residuals with each departure of the room (m, nuisances), or with some of them."""
        whole = fitted.whitened
        columns = [np.zeros((len(whole), 0))]
        for place in range(len(self.problem.sd)) if places is None else places:
            sd = self.problem.sd[place]
            step = 0.1 * sd * (1.0 if fitted.departures[place] <= 0.0 else -1.0)
            moved = fitted.departures.copy()
            moved[place] += step
            other = self.problem.at(fitted.effects, moved, fitted.convention)
            there = other.whitened if other else whole
            columns.append((there - whole)[:, None] / step)
        return np.hstack(columns)

    def refined(
        self, effects: Edits, departures: FloatArray, convention: Convention, parts: Sequence[int] = (FIT,)
    ) -> Hypothesis | None:
        """Return a hypothesis with all its parameters fitted together from given ones."""
        if self.has_nuisances:
            return self.nuisance_fit(effects, departures, convention, parts, self.base_slopes)
        if not any(effect.priors for effect, _ in effects):
            return self.problem.at(effects, departures, convention)
        smooth = effects
        if self.problem.is_smooth:  # Gauss-Newton steps go far along a valley; what only switches has no slopes
            problem = LeastSquares(self.problem, effects, convention, parts)
            found = problem.solved(problem.vector(departures), round(STEPS * self.thorough), None)
            smooth = found.effects if found else effects
        spaces = [Space(effect) for effect, _ in effects]
        start = np.concatenate([space.inside(v) for space, (_, v) in zip(spaces, smooth, strict=True)])

        def loss(x: FloatArray) -> float:
            return self.score(self.problem.at(valued(effects, spaces, x), departures, convention), parts)

        most = REFINE.get(len(start), REFINE_MORE)
        end = descend(loss, start, round(most * self.thorough), QUICK_NARROW if self.is_quick else NARROW)
        return self.problem.at(valued(effects, spaces, end), departures, convention)

    def nuisance_fit(
        self,
        effects: Edits,
        departures: FloatArray,
        convention: Convention,
        parts: Sequence[int],
        known: FloatArray | None = None,
    ) -> Hypothesis | None:
        """Fit departures and effects together by damped Gauss-Newton steps, the departures held by their priors.

        The slopes of the departures are kept as long as they serve, they hardly change; known ones are kept throughout.
        """
        if not self.has_nuisances:
            return self.problem.at(effects, departures, convention)
        problem = LeastSquares(self.problem, effects, convention, parts, is_bounded=True)
        little = CLOSE if known is not None and not effects else LITTLE
        most = round(STEPS * self.thorough) if effects else STEPS  # all else is compared with what is believed
        return self._with_events(problem.solved(problem.vector(departures), most, known, little))

    def _with_events(self, fitted: Hypothesis | None) -> Hypothesis | None:
        """Return a fit with its events fitted to all days, not only to those that a property is learned from."""
        if fitted is None or not self.problem.events:
            return fitted
        best, share = fitted, 1.0
        for _ in range(EVENT_STEPS):
            tried = self._stepped(best, share)
            if tried and self.score(tried, ALL) < self.score(best, ALL):
                best = tried
            else:
                share *= 0.5  # no flow is below 0 or above full: beyond that a slope does not hold
        return best

    def _stepped(self, fitted: Hypothesis, share: float) -> Hypothesis | None:
        """Return a fit after a share of the step to where its events would be best, were everything straight."""
        events, departures = self.problem.events, fitted.departures.copy()
        sd, now = self.problem.sd[events], departures[events]
        missed = np.concatenate((fitted.whitened, now / sd))
        steps = -sd * np.linalg.lstsq(np.vstack((self._event_slopes * sd, np.eye(len(sd)))), missed, rcond=None)[0]
        departures[events] = np.clip(now + share * steps, -LIMITS.departure * sd, LIMITS.departure * sd)
        return self.problem.at(fitted.effects, departures, fitted.convention)

    @cached_property
    def _event_slopes(self) -> FloatArray:
        """Change of the whitened residuals with each event (m, events), of the room as believed."""
        believed = self.problem.at((), np.zeros(len(self.problem.sd)), self.problem.conventions[0])
        assert believed
        return self.slopes_at(believed, self.problem.events)
