"""Fitting effects and, where a room takes part, what nobody knows of it, to one segment of a record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import takewhile
from operator import itemgetter

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.parameter_space import NARROW, QUICK_NARROW, EffectType, Space, Values, descend, valued
from waxstudy.diagnosis.estimate.solver import MOST_SD, LeastSquares
from waxstudy.diagnosis.estimate.start_points import FirstLook
from waxstudy.diagnosis.model.conventions import Convention, Perturbation
from waxstudy.diagnosis.model.nuisance import nuisances
from waxstudy.diagnosis.model.prediction import Prediction
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.judge import ALL, BOTH, FIT, SELECT, SHRINK, Judge
from waxstudy.plugin import Belief, FloatArray, SimulationError

IMPOSSIBLE = 1e12  # loss of a belief that cannot be
REFINE = {1: 30, 2: 60, 3: 110}
REFINE_MORE = 160
STEPS = 25  # of Gauss and Newton
OTHER = 9.0  # loss by which another convention must be better
EVENT_STEPS = 3  # of what once happened, to all days
AGAIN = 2  # fits of a room from where the last one ended
PROMISING = 5.0  # loss that an effect must take away from a room for a closer look; a quick diagnosis asks for more


class Fitter:
    """Fits hypotheses to one segment, always from the same belief."""

    def __init__(
        self,
        segment: Segment,
        record: Record,
        belief: Belief,
        thorough: float = 1.0,
        room_tolerance: float = 1.0,
        holds_out: bool = True,
    ) -> None:
        self.segment, self.record, self.belief, self.thorough = segment, record, belief, thorough
        self.holds_out, self.room_tolerance = holds_out, room_tolerance
        self.is_quick = thorough < 1.0
        self.is_exact_room = segment.with_room and room_tolerance == 0.0
        self.predicted = Prediction(segment, record, belief, self.is_exact_room)
        self.judge = Judge(segment, record, belief, holds_out, self.is_exact_room)
        self.nuisances = nuisances(belief, record, segment.driven_by, room_tolerance) if segment.with_room else []
        self.sd = np.array([nuisance.sd for nuisance in self.nuisances])
        self._events = [place for place, nuisance in enumerate(self.nuisances) if nuisance.is_event]
        self._straight: dict[tuple[int, ...], tuple[FloatArray, FloatArray, np.ndarray]] = {}
        self._on_both: dict[Convention, Hypothesis] = {}
        self._edits: list[tuple[float, Belief]] = []  # by nuisance: what was departed to last, and the belief so far

    # --- one hypothesis at given values ---

    def edited(self, effects: Sequence[tuple[EffectType, Values]], departures: FloatArray) -> Belief:
        """Return the belief with departures of the room and with effects; raise `ValueError` where it cannot be."""
        belief = self._departed(departures, frozenset(name for effect, _ in effects for name in effect.absorbs))
        for effect, values in effects:
            belief = effect.apply(belief, effect.Parameters(**values))
        return belief

    def _departed(self, departures: FloatArray, absorbed: frozenset[str]) -> Belief:
        """Return the belief with departures of the room, but for those that an effect takes the place of."""
        values = [
            0.0 if each.name in absorbed else float(d) for each, d in zip(self.nuisances, departures, strict=True)
        ]
        # slopes change one nuisance at a time: what was edited before it stays
        same = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1][0], zip(values, self._edits, strict=False)))
        del self._edits[same:]
        for nuisance, value in zip(self.nuisances[same:], values[same:], strict=True):
            before = self._edits[-1][1] if self._edits else self.belief
            self._edits.append((value, nuisance.apply(before, value)))
        return self._edits[-1][1] if self._edits else self.belief

    def at(
        self, effects: Sequence[tuple[EffectType, Values]], departures: FloatArray, convention: Convention
    ) -> Hypothesis | None:
        """Return what a hypothesis misses at given values, or None where it cannot be simulated."""
        try:
            predicted = self.predicted(self.edited(effects, departures), convention)
        except (SimulationError, ValueError, ArithmeticError):
            return None
        return Hypothesis(tuple(effects), convention, departures, self.judge.residuals(predicted))

    def drive_noise(self, fitted: Hypothesis) -> Mapping[int, float]:
        """Return what noise of the drive adds to a model's loss, by part: a low-pass lets less of it through."""
        if self.segment.with_room or self.segment.driven_by in self.record.binary or fitted.convention.is_raw:
            return {}
        belief = self.edited(fitted.effects, fitted.departures)
        perturbation = Perturbation(np.random.default_rng(11), is_twice=False)
        still = self.predicted(belief, fitted.convention)
        shaken = self.predicted(belief, fitted.convention, perturbation)
        found: dict[int, float] = {}
        for now, moved in zip(self.judge.residuals(still), self.judge.residuals(shaken), strict=True):
            if now.channel not in self.record.binary:
                for part in BOTH:
                    chosen = now.part == part
                    added = float(np.sum((moved.whitened[chosen] - now.whitened[chosen]) ** 2))
                    found[part] = found.get(part, 0.0) + added
        return found

    # --- fitting ---

    @cached_property
    def base(self) -> Hypothesis:
        """The belief itself, its room fitted to the first part, read in the way that fits best."""
        start = np.zeros(len(self.sd))
        first = self._best([self._room_fit((), start, self.segment.conventions[0], (FIT,))])
        known = self._slopes_at(first) if len(self.segment.conventions) > 1 else None
        others = [
            self._room_fit((), first.departures, convention, (FIT,), known)
            for convention in self.segment.conventions[1:]
        ]
        return self.settled(self._best([first, *others]))

    def base_on_both(self, convention: Convention) -> Hypothesis:
        """Return the belief itself under a convention, its room fitted to both first parts."""
        if convention not in self._on_both:
            self._on_both[convention] = self.refined((), self.base.departures, convention, BOTH) or self.base
        return self._on_both[convention]

    def settled(self, fitted: Hypothesis) -> Hypothesis:
        """Return a fit that others are compared with, gone on with to its end: else they gain what it had left."""
        for _ in range(AGAIN if self.nuisances else 0):
            fitted = self._room_fit(fitted.effects, fitted.departures, fitted.convention, (FIT,), most=STEPS) or fitted
        return fitted

    def with_best_convention(self, fitted: Hypothesis) -> Hypothesis:
        """Return a fit read in the way that suits it best: what had to be undone before may be needless now."""
        others = [each for each in self.conventions if each != fitted.convention]
        again = [self.refined(fitted.effects, fitted.departures, convention) for convention in others]
        best = self._best([fitted, *again])
        needed = OTHER * self.spread(fitted)
        return best if self.fair_score(best, BOTH) < self.fair_score(fitted, BOTH) - needed else fitted

    @cached_property
    def conventions(self) -> Sequence[Convention]:
        """Ways to read the record with an effect: the belief's, and those that differ from it in one choice."""
        return [each for each in self.segment.conventions if each.differs(self.base.convention) <= 1]

    def _best(self, tried: Sequence[Hypothesis | None]) -> Hypothesis:
        done = [each for each in tried if each is not None]
        if not done:
            raise ValueError(f"what is believed of {self.segment.name} cannot be simulated")
        return min(done, key=lambda each: self.fair_score(each, BOTH))

    def score(self, fitted: Hypothesis | None, parts: Sequence[int]) -> float:
        """Return what a fit misses on some parts, with how far its departures went; much where it cannot be."""
        if fitted is None:
            return IMPOSSIBLE
        return sum(fitted.loss(part) for part in parts) + self.strain(fitted) + fitted.convention.handicap

    def fair_score(self, fitted: Hypothesis, parts: Sequence[int]) -> float:
        """Return the score without what the drive's noise adds to a controller's output that runs on.

        Of two conventions one may let less of it through.
        """
        runs_on = "control_output" in self.segment.judged and "control_output" not in self.record.binary
        noise = self.drive_noise(fitted) if runs_on else {}
        return self.score(fitted, parts) - sum(noise.get(part, 0.0) for part in parts)

    def strain(self, fitted: Hypothesis) -> float:
        """Return the squares of the room's departures, in standard deviations."""
        return float(np.sum((fitted.departures / self.sd) ** 2)) if len(self.sd) else 0.0

    def spread(self, fitted: Hypothesis) -> float:
        """Return the square of what a room leaves by its form, in units of what it may leave; 1 where none takes part.

        A room as believed that leaves far less, and did not have to depart for it, shows that its form is better than
        that.
        """
        return min(1.0, self.form(fitted)) if self.nuisances else 1.0

    def form(self, fitted: Hypothesis) -> float:
        """Return the same without the limit at what a form may leave.

        Each channel counts once a day, as what a form leaves comes again every day.
        """
        days = [len(np.unique(each.block[each.judged & (each.part != SHRINK)])) for each in fitted.residuals]
        return (fitted.loss(FIT) + fitted.loss(SELECT) + self.strain(fitted)) / max(1, sum(days))

    def fit(self, effect: EffectType, given: Hypothesis, parts: Sequence[int] = (FIT,)) -> Hypothesis | None:
        """Return a hypothesis with one more effect, fitted to some parts of the record; None where it cannot be."""
        if effect.hindrance(self.edited(given.effects, given.departures)):
            return None
        look = FirstLook(self, effect, given, parts)
        found = [(*look.best(convention), convention) for convention in self.conventions]
        possible = [each for each in sorted(found, key=itemgetter(0)) if each[0] < IMPOSSIBLE]
        if self.nuisances:
            # looking closer at each for a room takes too long: the best, and the best where others count less
            fair = min(possible, key=lambda each: each[0] + of_other(each[2], given), default=None)
            possible = [each for each in possible[:1] if each is not fair] + ([fair] if fair else [])
        ends = [self._from(effect, given, parts, values, convention) for _, values, convention in possible]
        done = [each for each in ends if each is not None]
        best = min(done, key=lambda each: self.fair_score(each, parts) + of_other(each.convention, given), default=None)
        promising = PROMISING * self.spread(given) / self.thorough
        if best and self.nuisances and self.score(best, parts) < self.score(given, parts) - promising:
            return self.refined(best.effects, best.departures, best.convention, parts, is_rough=self.is_quick)
        return best

    def _from(
        self, effect: EffectType, given: Hypothesis, parts: Sequence[int], values: Values, convention: Convention
    ) -> Hypothesis | None:
        return self.refined((*given.effects, (effect, values)), given.departures, convention, parts, is_rough=True)

    def straight(self, parts: tuple[int, ...]) -> tuple[FloatArray, FloatArray, np.ndarray]:
        """Return how the room follows at the base: slopes, what solves for the departures, which residual are fitted.

        Shapes (m, nuisances), (nuisances, m + nuisances), (m,) bool.
        """
        if parts not in self._straight:
            fit = np.concatenate([np.isin(each.part, parts) for each in self.base.residuals])
            solution = np.linalg.pinv(np.vstack((self._slopes[fit], np.diag(1.0 / self.sd))))
            self._straight[parts] = self._slopes, solution, fit
        return self._straight[parts]

    @cached_property
    def _slopes(self) -> FloatArray:
        return self._slopes_at(self.base)

    def _slopes_at(self, fitted: Hypothesis, places: Sequence[int] | None = None) -> FloatArray:
        """Change of the whitened residual with each departure of the room (m, nuisances), or with some of them."""
        whole = fitted.whitened
        columns = [np.zeros((len(whole), 0))]
        for place in range(len(self.sd)) if places is None else places:
            sd = self.sd[place]
            step = 0.1 * sd * (1.0 if fitted.departures[place] <= 0.0 else -1.0)
            moved = fitted.departures.copy()
            moved[place] += step
            other = self.at(fitted.effects, moved, fitted.convention)
            there = other.whitened if other else whole
            columns.append((there - whole)[:, None] / step)
        return np.hstack(columns)

    def refined(
        self,
        effects: Sequence[tuple[EffectType, Values]],
        departures: FloatArray,
        convention: Convention,
        parts: Sequence[int] = (FIT,),
        is_rough: bool = False,
    ) -> Hypothesis | None:
        """Return a hypothesis with all its parameters fitted together from given ones.

        A rough fit takes the room's answer to its departures as it was at the base.
        """
        if self.nuisances:
            return self._room_fit(effects, departures, convention, parts, self._slopes if is_rough else None)
        if not any(effect.priors for effect, _ in effects):
            return self.at(effects, departures, convention)
        smooth = self._smooth_fit(effects, departures, convention, parts)
        spaces = [Space(effect) for effect, _ in effects]
        start = np.concatenate([space.inside(v) for space, (_, v) in zip(spaces, smooth, strict=True)])

        def loss(x: FloatArray) -> float:
            return self.score(self.at(valued(effects, spaces, x), departures, convention), parts)

        most = REFINE.get(len(start), REFINE_MORE)
        found = descend(loss, start, round(most * self.thorough), QUICK_NARROW if self.is_quick else NARROW)
        return self.at(valued(effects, spaces, found), departures, convention)

    def _smooth_fit(
        self,
        effects: Sequence[tuple[EffectType, Values]],
        departures: FloatArray,
        convention: Convention,
        parts: Sequence[int],
    ) -> Sequence[tuple[EffectType, Values]]:
        """Return parameters after Gauss-Newton steps, which go far along a valley; what switches is left as it is."""
        if all(channel in self.record.binary for channel in self.segment.judged):
            return effects
        problem = LeastSquares(self, effects, convention, parts)
        found = problem.solved(problem.vector(departures), round(STEPS * self.thorough), None)
        return found.effects if found else effects

    def _room_fit(
        self,
        effects: Sequence[tuple[EffectType, Values]],
        departures: FloatArray,
        convention: Convention,
        parts: Sequence[int],
        known: FloatArray | None = None,
        most: int | None = None,
    ) -> Hypothesis | None:
        """Fit departures and effects together by damped Gauss-Newton steps, the departures held by their priors.

        The slopes of the departures are kept as long as they serve, they hardly change; known ones are kept throughout.
        """
        if not self.nuisances:
            return self.at(effects, departures, convention)
        problem = LeastSquares(self, effects, convention, parts)
        if most is None:
            most = round(STEPS * self.thorough) if effects else STEPS  # all else is compared with what is believed
        return self._with_events(problem.solved(problem.vector(departures), most, known))

    def _with_events(self, fitted: Hypothesis | None) -> Hypothesis | None:
        """Return a fit with its events fitted to all days, not only to those that a property is learned from."""
        if fitted is None or not len(self._events):
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
        sd = self.sd[self._events]
        missed = np.concatenate((fitted.whitened, fitted.departures[self._events] / sd))
        steps = -sd * np.linalg.lstsq(np.vstack((self._event_slopes * sd, np.eye(len(sd)))), missed, rcond=None)[0]
        departures = fitted.departures.copy()
        departures[self._events] = np.clip(departures[self._events] + share * steps, -MOST_SD * sd, MOST_SD * sd)
        return self.at(fitted.effects, departures, fitted.convention)

    @cached_property
    def _event_slopes(self) -> FloatArray:
        """Change of the whitened residual with each event (m, events), of the room as believed."""
        believed = self.at((), np.zeros(len(self.sd)), self.segment.conventions[0])
        assert believed
        return self._slopes_at(believed, self._events)


def of_other(convention: Convention, given: Hypothesis) -> float:
    """Return by how much another convention than a given one must be better: an effect may do no more than undo it."""
    return 0.0 if convention == given.convention else OTHER
