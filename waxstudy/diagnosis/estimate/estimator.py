"""Fitting effects and, where a room takes part, what nobody knows of it, to a problem."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import itemgetter
from typing import Generic, TypeVar

import numpy as np

from waxstudy.diagnosis.criteria import Question, limit
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Problem
from waxstudy.diagnosis.estimate.parameter_space import NARROW, QUICK_NARROW, Space, descend, valued
from waxstudy.diagnosis.estimate.solver import CLOSE_BY, LITTLE, MOST_SD, LeastSquares
from waxstudy.diagnosis.estimate.start_points import IMPOSSIBLE, Screen, StartPoints
from waxstudy.diagnosis.model.conventions import PLAIN, Convention
from waxstudy.diagnosis.model.edits import Edits, EffectType, Values
from waxstudy.diagnosis.observations.partition import ALL, BOTH, FIT, SELECT, SHRINK
from waxstudy.plugin import FloatArray

REFINE = {1: 30, 2: 60, 3: 110}
REFINE_MORE = 160
STEPS = 25  # of Gauss and Newton
EVENT_STEPS = 3  # of what once happened, to all days
AGAIN = 2  # fits of a room from where the last one ended
TURNS = 4  # most places where the slopes of a room are taken, one after the other
FAR = 2e-3  # share of the loss that a fit takes away, from which on slopes are taken where it ended
CLOSE = 1e-5  # share of the loss that is not worth another step, where a step is but one simulation
PROMISING = 5.0  # loss that an effect must take away from a room for a closer look; a quick look asks for more
P = TypeVar("P", bound=Problem)


@dataclass(frozen=True)
class Followed:
    """A fit of the nuisances alone, with the slopes (m, nuisances) that it followed, and the departures they are of."""

    fitted: Hypothesis
    slopes: FloatArray
    place: FloatArray


class Estimator(Generic[P]):
    """Fits hypotheses to one problem, always from the same belief. `thorough` below 1 looks at less.

    One that `keeps` slopes takes those of the nuisances at its base, or has them from a fit that came `before`, and
    keeps them for all else: a room answers nearly in a straight line. Fits begin `near` what is given of effects.
    """

    def __init__(
        self,
        problem: P,
        thorough: float = 1.0,
        keeps: bool = False,
        before: Followed | None = None,
        near: Mapping[EffectType, Values] | None = None,
    ) -> None:
        self.problem, self.thorough, self.is_quick, self.near = problem, thorough, thorough < 1.0, near or {}
        self.keeps, self.before = keeps, before
        self.has_nuisances = len(problem.sd) > 0
        self.other = limit(Question.CONVENTION, "gain", PLAIN)  # loss by which another convention must be better
        self._straight: dict[tuple[int, ...], tuple[FloatArray, FloatArray, np.ndarray]] = {}
        self._on_both: dict[Convention, Hypothesis] = {}

    @cached_property
    def base(self) -> Hypothesis:
        """The belief itself, its room fitted to the first part, read in the way that fits best."""
        if self.followed:
            return self.followed.fitted
        start = np.zeros(len(self.problem.sd))
        first = self.best([self.nuisance_fit((), start, self.problem.conventions[0], (FIT,))])
        known = self.slopes_at(first) if len(self.problem.conventions) > 1 else None
        others = [
            self.nuisance_fit((), first.departures, convention, (FIT,), known)
            for convention in self.problem.conventions[1:]
        ]
        return self.settled(self.best([first, *others]))

    @cached_property
    def followed(self) -> Followed | None:
        """The belief itself where slopes are kept: fitted from what came before, or from what is believed."""
        if not self.keeps or not self.has_nuisances:
            return None
        start, convention = np.zeros(len(self.problem.sd)), self.problem.conventions[0]
        if self.before is None:
            return self.follow(start, convention, (FIT,))
        start, slopes = self.before.fitted.departures, self.before.slopes
        fitted = self.nuisance_fit((), start, self.before.fitted.convention, (FIT,), slopes)
        return replace(self.before, fitted=fitted or self.before.fitted)

    def follow(
        self, start: FloatArray, convention: Convention, parts: Sequence[int], place: FloatArray | None = None
    ) -> Followed:
        """Return a fit of the nuisances from a start, by slopes that are taken again only where it has gone far.

        The first are taken at the start, or at another place, which other problems may have simulated before.
        """
        best = self.best([self.problem.at((), start, convention)])
        place = start if place is None else place
        slopes = self.slopes_at(self.best([self.problem.at((), place, convention)]))
        for turn in range(TURNS):
            found = self.nuisance_fit((), best.departures, convention, parts, slopes) or best
            gained = self.score(best, parts) - self.score(found, parts)
            best = found
            if gained <= FAR * self.score(best, parts) or turn == TURNS - 1:
                break
            place, slopes = best.departures, self.slopes_at(best)
        return Followed(best, slopes, place)

    def base_on_both(self, convention: Convention) -> Hypothesis:
        """Return the belief itself under a convention, its room fitted to both first parts."""
        if convention not in self._on_both:
            self._on_both[convention] = self.refined((), self.base.departures, convention, BOTH) or self.base
        return self._on_both[convention]

    def settled(self, fitted: Hypothesis) -> Hypothesis:
        """Return a fit that others are compared with, gone on with to its end: else they gain what it had left."""
        for _ in range(AGAIN if self.has_nuisances and not self.keeps else 0):
            fitted = (
                self.nuisance_fit(fitted.effects, fitted.departures, fitted.convention, (FIT,), most=STEPS) or fitted
            )
        return fitted

    def with_best_convention(self, fitted: Hypothesis) -> Hypothesis:
        """Return a fit read in the way that suits it best: what had to be undone before may be needless now."""
        others = [each for each in self.conventions if each != fitted.convention]
        again = [self.refined(fitted.effects, fitted.departures, convention) for convention in others]
        best = self.best([fitted, *again])
        needed = self.other * self.form_share(fitted)
        return best if self.fair_score(best, BOTH) < self.fair_score(fitted, BOTH) - needed else fitted

    @cached_property
    def conventions(self) -> Sequence[Convention]:
        """Ways to read the record with an effect: the belief's, and those that differ from it in one choice."""
        return [each for each in self.problem.conventions if each.differs(self.base.convention) <= 1]

    def best(self, tried: Sequence[Hypothesis | None], parts: Sequence[int] = BOTH, is_fair: bool = True) -> Hypothesis:
        """Return the fit with the least score, or fair score; raise `ValueError` where none could be simulated."""
        done = [each for each in tried if each is not None]
        if not done:
            raise ValueError(f"what is believed of {self.problem.name} cannot be simulated")
        return min(done, key=lambda each: self.fair_score(each, parts) if is_fair else self.score(each, parts))

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

    def of_other(self, convention: Convention, given: Hypothesis) -> float:
        """Return by how much a convention must be better than a given one: an effect may do no more than undo it."""
        return 0.0 if convention == given.convention else self.other

    def strain(self, fitted: Hypothesis) -> float:
        """Return the squares of the room's departures, in standard deviations."""
        if not self.has_nuisances:
            return 0.0
        return float(np.sum((self.problem.prior @ (fitted.departures / self.problem.sd)) ** 2))

    def form_share(self, fitted: Hypothesis) -> float:
        """Return the square of what a room leaves, over that of what its form may leave, at most 1; 1 without a room.

        A room as believed that leaves far less, and did not have to depart for it, shows that its form is better than
        stated. Each channel counts once a day, as what a form leaves comes again every day.
        """
        if not self.has_nuisances:
            return 1.0
        days = [len(np.unique(each.block[each.judged & (each.part != SHRINK)])) for each in fitted.residuals]
        return min(1.0, (fitted.loss(FIT) + fitted.loss(SELECT) + self.strain(fitted)) / max(1, sum(days)))

    def fit(
        self, effect: EffectType, given: Hypothesis, parts: Sequence[int] = (FIT,), screen: Screen | None = None
    ) -> Hypothesis | None:
        """Return a hypothesis with one more effect, fitted to some parts of the record; None where it cannot be.

        One that promises too little by a screen is where a straight line has it best.
        """
        if effect.hindrance(self.problem.edited(given.effects, given.departures)):
            return None
        straight = self.straight(tuple(parts)) if self.has_nuisances else None
        about = straight, self.thorough, screen, self.near.get(effect)
        look = StartPoints(self.problem, self.score, effect, given, parts, *about)
        spread = [given.convention, *(each for each in self.conventions if not each.has_log_of(given.convention))]
        found = [(*look.best(convention), convention) for convention in spread]
        # another reading of the sun or of means moves an effect's best place by little, and the fit goes there
        found += [look.again(found[0][1], convention) for convention in self.conventions if convention not in spread]
        possible = [each for each in sorted(found, key=itemgetter(0)) if each[0] < IMPOSSIBLE]
        if possible and not self.has_nuisances and not look.cannot_show:
            places = [possible[0], *look.evolved(possible[0][2])]
            likeliest = min(places, key=itemgetter(0))[1]
            possible = [*places, *(look.better(each, likeliest) for each in possible[1:])]
        if look.promised and look.is_hopeless:
            _, values, convention = look.promised
            return self.problem.at((*given.effects, (effect, values)), given.departures, convention)
        if self.has_nuisances:
            # looking closer at each for a room takes too long: the best, and the best where others count less
            even = min(possible, key=lambda each: each[0] + self.of_other(each[2], given), default=None)
            possible = [each for each in possible[:1] if each is not even] + ([even] if even else [])
        ends = [
            self.refined((*given.effects, (effect, values)), given.departures, convention, parts, is_rough=True)
            for _, values, convention in possible
        ]
        done = [each for each in ends if each is not None]
        best = min(
            done, key=lambda each: self.fair_score(each, parts) + self.of_other(each.convention, given), default=None
        )
        promising = PROMISING * self.form_share(given) / self.thorough
        if best and self.has_nuisances and self.score(best, parts) < self.score(given, parts) - promising:
            return self.refined(best.effects, best.departures, best.convention, parts, is_rough=self.is_quick)
        return best

    def straight(self, parts: tuple[int, ...]) -> tuple[FloatArray, FloatArray, np.ndarray]:
        """Return how the room follows at the base: slopes, what solves for the departures, which residuals are fitted.

        Shapes (m, nuisances), (nuisances, m + nuisances), (m,) bool.
        """
        if parts not in self._straight:
            fit = np.concatenate([np.isin(each.part, parts) for each in self.base.residuals])
            solution = np.linalg.pinv(np.vstack((self.base_slopes[fit], self.problem.prior / self.problem.sd)))
            self._straight[parts] = self.base_slopes, solution, fit
        return self._straight[parts]

    @cached_property
    def base_slopes(self) -> FloatArray:
        return self.followed.slopes if self.followed else self.slopes_at(self.base)

    def slopes_at(self, fitted: Hypothesis, places: Sequence[int] | None = None) -> FloatArray:
        """Change of the whitened residuals with each departure of the room (m, nuisances), or with some of them."""
        whole = fitted.whitened
        columns = [np.zeros((len(whole), 0))]
        wanted = range(len(self.problem.sd)) if places is None else places
        of_heat = self.problem.added_heat_slopes(fitted, wanted)
        for place in wanted:
            if place in of_heat:
                columns.append(of_heat[place][:, None])
                continue
            sd = self.problem.sd[place]
            step = 0.1 * sd * (1.0 if fitted.departures[place] <= 0.0 else -1.0)
            moved = fitted.departures.copy()
            moved[place] += step
            other = self.problem.at(fitted.effects, moved, fitted.convention)
            there = other.whitened if other else whole
            columns.append((there - whole)[:, None] / step)
        return np.hstack(columns)

    def nearest(self, effects: Edits, starts: Sequence[FloatArray], convention: Convention) -> FloatArray:
        """Return the departures of several (nuisances,) with which effects miss least of the first part."""
        return min(starts, key=lambda each: self.score(self.problem.at(effects, each, convention), (FIT,)))

    def refined(
        self,
        effects: Edits,
        departures: FloatArray,
        convention: Convention,
        parts: Sequence[int] = (FIT,),
        is_rough: bool = False,
    ) -> Hypothesis | None:
        """Return a hypothesis with all its parameters fitted together from given ones.

        A rough fit takes the room's answer to its departures as it was at the base.
        """
        if self.has_nuisances:
            return self.nuisance_fit(
                effects, departures, convention, parts, self.base_slopes if is_rough or self.keeps else None
            )
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
        most: int | None = None,
    ) -> Hypothesis | None:
        """Fit departures and effects together by damped Gauss-Newton steps, the departures held by their priors.

        The slopes of the departures are kept as long as they serve, they hardly change; known ones are kept throughout.
        """
        if not self.has_nuisances:
            return self.problem.at(effects, departures, convention)
        problem = LeastSquares(self.problem, effects, convention, parts, CLOSE_BY)
        little = CLOSE if self.keeps and known is not None and not effects else LITTLE
        if most is None:
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
        departures[events] = np.clip(now + share * steps, -MOST_SD * sd, MOST_SD * sd)
        return self.problem.at(fitted.effects, departures, fitted.convention)

    @cached_property
    def _event_slopes(self) -> FloatArray:
        """Change of the whitened residuals with each event (m, events), of the room as believed."""
        believed = self.problem.at((), np.zeros(len(self.problem.sd)), self.problem.conventions[0])
        assert believed
        return self.slopes_at(believed, self.problem.events)
