"""Fitting effects and, where a room takes part, what nobody knows of it, to one link of a record."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from operator import itemgetter

import numpy as np

from waxstudy.gap.judge import FIT, SELECT, SHRINK, Errors, Judge
from waxstudy.gap.links import Link
from waxstudy.gap.newton import MOST_SD, LeastSquares
from waxstudy.gap.reading import STILL, Drift, Reading
from waxstudy.gap.record import Record
from waxstudy.gap.room import Predicted
from waxstudy.gap.space import EffectType, Space, Values, descend, valued
from waxstudy.gap.unknowns import unknowns
from waxstudy.plugin import Belief, FloatArray, SimulationError

IMPOSSIBLE = 1e12  # loss of a belief that cannot be
REFINE = {1: 30, 2: 60, 3: 110}
REFINE_MORE = 160
STEPS = 25  # of Gauss and Newton
OTHER = 9.0  # loss by which another reading must be better
AGAIN = 2  # fits of a room from where the last one ended
STRONGEST = 4.0  # times a point of a first look
SCALED = 4  # such points that are tried at the strength that suits the record
REFINED = ("air_temperature_C", "operative_temperature_C", "floor_surface_temperature_C")
TINY = 1e-12
PROMISING = 5.0  # loss that an effect must take away from a room for a closer look; a quick diagnosis asks for more


@dataclass(frozen=True)
class Fitted:
    """A belief with effects and departures fitted to a link: what it says, and what it misses."""

    effects: tuple[tuple[EffectType, Values], ...]
    reading: Reading
    departures: FloatArray
    errors: Sequence[Errors] = field(repr=False)

    def loss(self, part: int) -> float:
        return sum(each.loss(part) for each in self.errors)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(effect.name for effect, _ in self.effects)

    def unit(self, channel: str) -> str:
        return next(each.unit for each in self.errors if each.channel == channel)


class Fitter:
    """Fits hypotheses to one link, always from the same belief."""

    def __init__(
        self,
        link: Link,
        record: Record,
        belief: Belief,
        thorough: float = 1.0,
        room_tolerance: float = 1.0,
        holds_out: bool = True,
    ) -> None:
        self.link, self.record, self.belief, self.thorough = link, record, belief, thorough
        self.holds_out, self.is_to_the_letter = holds_out, link.with_room and room_tolerance == 0.0
        self.judge = Judge(link, record, belief, holds_out)
        self.unknowns = unknowns(belief, record, link.driven_by, room_tolerance) if link.with_room else []
        self.sd = np.array([unknown.sd for unknown in self.unknowns])
        self._events = [place for place, unknown in enumerate(self.unknowns) if unknown.is_event]
        self._refinements: dict[Reading, Mapping[str, FloatArray]] = {}
        self._solutions: dict[tuple[int, ...], tuple[FloatArray, np.ndarray]] = {}
        self._last: tuple[tuple[bytes, frozenset[str]], Belief] | None = None  # what was departed to last

    # --- one hypothesis at given values ---

    def edited(self, effects: Sequence[tuple[EffectType, Values]], departures: FloatArray) -> Belief:
        """Return the belief with departures of the room and with effects; raise `ValueError` where it cannot be."""
        belief = self._departed(departures, frozenset(name for effect, _ in effects for name in effect.absorbs))
        for effect, values in effects:
            belief = effect.apply(belief, effect.Parameters(**values))
        return belief

    def _departed(self, departures: FloatArray, absorbed: frozenset[str]) -> Belief:
        """Return the belief with departures of the room, but for those that an effect takes the place of."""
        key = (departures.tobytes(), absorbed)
        if self._last is None or self._last[0] != key:
            belief = self.belief
            for unknown, value in zip(self.unknowns, departures, strict=True):
                if unknown.name not in absorbed:
                    belief = unknown.apply(belief, float(value))
            self._last = key, belief
        return self._last[1]

    def at(
        self, effects: Sequence[tuple[EffectType, Values]], departures: FloatArray, reading: Reading
    ) -> Fitted | None:
        """Return what a hypothesis misses at given values, or None where it cannot be simulated."""
        try:
            predicted = self.predicted(self.edited(effects, departures), reading)
        except (SimulationError, ValueError, ArithmeticError):
            return None
        return Fitted(tuple(effects), reading, departures, self.judge.errors(predicted))

    def predicted(self, belief: Belief, reading: Reading, drift: Drift = STILL) -> Predicted:
        """Return what the link makes of a belief, a room's as if its steps were those of the record.

        What shorter steps change of the room as believed is added: with the same flow they change as much of any other.
        Not of the return, whose first minutes of each pulse are a matter of form, unless that is as believed.
        """
        found = self.link.predict(self.record, belief, reading, drift)
        for channel, change in self._refinement(reading).items():
            found[channel] = found[channel] + change
        return found

    def _refinement(self, reading: Reading) -> Mapping[str, FloatArray]:
        if not self.link.with_room or self.link.driven_by != "flow_L_h":
            return {}
        if reading not in self._refinements:
            coarse, fine = (self.link.predict(self.record, self.belief, reading, is_fine=way) for way in (False, True))
            refined = [channel for channel in fine if channel in REFINED or self.is_to_the_letter]
            changes = {channel: fine[channel] - coarse[channel] for channel in refined}
            self._refinements[reading] = {channel: np.nan_to_num(change) for channel, change in changes.items()}
        return self._refinements[reading]

    def drive_noise(self, fitted: Fitted) -> Mapping[int, float]:
        """Return what noise of the link's drive adds to a model's loss, by part: a low-pass lets less of it through."""
        if self.link.with_room or self.link.driven_by in self.record.binary or fitted.reading.is_raw:
            return {}
        belief = self.edited(fitted.effects, fitted.departures)
        drift = Drift(np.random.default_rng(11), is_twice=False)
        still = self.predicted(belief, fitted.reading)
        shaken = self.predicted(belief, fitted.reading, drift)
        found: dict[int, float] = {}
        for now, moved in zip(self.judge.errors(still), self.judge.errors(shaken), strict=True):
            if now.channel not in self.record.binary:
                for part in (FIT, SELECT):
                    chosen = now.part == part
                    added = float(np.sum((moved.whitened[chosen] - now.whitened[chosen]) ** 2))
                    found[part] = found.get(part, 0.0) + added
        return found

    # --- fitting ---

    @cached_property
    def base(self) -> Fitted:
        """The belief itself, its room fitted to the first part, read in the way that fits best."""
        start = np.zeros(len(self.sd))
        first = self._best([self._room_fit((), start, self.link.readings[0], (FIT,))])
        known = self._slopes_at(first) if len(self.link.readings) > 1 else None
        others = [self._room_fit((), first.departures, reading, (FIT,), known) for reading in self.link.readings[1:]]
        return self.settled(self._best([first, *others]))

    def settled(self, fitted: Fitted) -> Fitted:
        """Return a fit that others are compared with, gone on with to its end: else they gain what it had left."""
        for _ in range(AGAIN if self.unknowns else 0):
            fitted = self._room_fit(fitted.effects, fitted.departures, fitted.reading, (FIT,), most=STEPS) or fitted
        return fitted

    def reread(self, fitted: Fitted) -> Fitted:
        """Return a fit read in the way that suits it best: what had to be undone before may be needless now."""
        most = self.fair_score(fitted, (FIT, SELECT)) - OTHER * self.spread(fitted)
        others = [each for each in self.readings if each != fitted.reading]
        again = [self.refined(fitted.effects, fitted.departures, reading) for reading in others]
        return self._best([fitted, *(each for each in again if each and self.fair_score(each, (FIT, SELECT)) < most)])

    @cached_property
    def readings(self) -> Sequence[Reading]:
        """Ways to read the record with an effect: the belief's, and those that differ from it in one choice."""
        return [each for each in self.link.readings if each.differs(self.base.reading) <= 1]

    def _best(self, tried: Sequence[Fitted | None]) -> Fitted:
        done = [each for each in tried if each is not None]
        if not done:
            raise ValueError(f"what is believed of {self.link.name} cannot be simulated")
        return min(done, key=lambda each: self.fair_score(each, (FIT, SELECT)))

    def score(self, fitted: Fitted | None, parts: Sequence[int]) -> float:
        """Return what a fit misses on some parts, with how far its departures went; much where it cannot be."""
        if fitted is None:
            return IMPOSSIBLE
        return sum(fitted.loss(part) for part in parts) + self.strain(fitted) + fitted.reading.handicap

    def fair_score(self, fitted: Fitted, parts: Sequence[int]) -> float:
        """Return the score without what the drive's noise adds to a controller's output that runs on.

        Of two readings one may let less of it through.
        """
        runs_on = "control_output" in self.link.judged and "control_output" not in self.record.binary
        noise = self.drive_noise(fitted) if runs_on else {}
        return self.score(fitted, parts) - sum(noise.get(part, 0.0) for part in parts)

    def strain(self, fitted: Fitted) -> float:
        """Return the squares of the room's departures, in standard deviations."""
        return float(np.sum((fitted.departures / self.sd) ** 2)) if len(self.sd) else 0.0

    def spread(self, fitted: Fitted) -> float:
        """Return the square of what a room leaves by its form, in units of what it may leave; 1 where none takes part.

        A room as believed that leaves far less, and did not have to depart for it, shows that its form is better than
        that.
        """
        return min(1.0, self.form(fitted)) if self.unknowns else 1.0

    def form(self, fitted: Fitted) -> float:
        """Return the same without the limit at what a form may leave.

        Each channel counts once a day, as what a form leaves comes again every day.
        """
        days = [len(np.unique(each.block[each.judged & (each.part != SHRINK)])) for each in fitted.errors]
        return (fitted.loss(FIT) + fitted.loss(SELECT) + self.strain(fitted)) / max(1, sum(days))

    def fit(self, effect: EffectType, given: Fitted, parts: Sequence[int] = (FIT,)) -> Fitted | None:
        """Return a hypothesis with one more effect, fitted to some parts of the record; None where it cannot be."""
        if effect.hindrance(self.edited(given.effects, given.departures)):
            return None
        space = Space(effect)
        scanned = [self._scanned(effect, space, given, reading, parts) for reading in self.readings]
        possible = [each for each in sorted(scanned, key=itemgetter(0)) if each[0] < IMPOSSIBLE]
        # a first look cannot choose between ways to read the record; for a room looking closer at each takes too long
        ends = [self._from(effect, given, parts, *each[1:]) for each in possible[: 1 if self.unknowns else None]]
        done = [each for each in ends if each is not None]
        best = min(done, key=lambda each: self.fair_score(each, parts) + of_other(each.reading, given), default=None)
        promising = PROMISING * self.spread(given) / self.thorough
        if best and self.unknowns and self.score(best, parts) < self.score(given, parts) - promising:
            return self.refined(best.effects, best.departures, best.reading, parts)
        return best

    def _from(
        self, effect: EffectType, given: Fitted, parts: Sequence[int], values: Values, reading: Reading
    ) -> Fitted | None:
        return self.refined((*given.effects, (effect, values)), given.departures, reading, parts, is_rough=True)

    def _scanned(
        self, effect: EffectType, space: Space, given: Fitted, reading: Reading, parts: Sequence[int]
    ) -> tuple[float, Values, Reading]:
        tried = [*space.points(self.thorough), *effect.starts(self.belief)]
        looks = [self._at((*given.effects, (effect, v)), given, reading, parts) for v in tried]
        more = self._scaled(effect, space, tried, looks, given, reading, parts)
        tried += more
        looks += [self._at((*given.effects, (effect, v)), given, reading, parts) for v in more]
        scores = [self.score(each, parts) for each in looks]
        best = int(np.argmin(scores))
        return scores[best] + of_other(reading, given), tried[best], reading

    def _scaled(
        self,
        effect: EffectType,
        space: Space,
        tried: Sequence[Values],
        looks: Sequence[Fitted | None],
        given: Fitted,
        reading: Reading,
        parts: Sequence[int],
    ) -> list[Values]:
        """Return points of a first look as strong as suits the record: a room answers nearly in proportion.

        A window of the right hours, but of thrice the flow, would look worse than none.
        """
        neutral = effect.neutral(self.edited(given.effects, given.departures))
        still = self._at(given.effects, given, reading, parts) if self.unknowns and neutral else None
        if still is None or neutral is None:
            return []
        before = _missed(still, parts)
        found = []
        for values, look in zip(tried, looks, strict=True):
            change = _missed(look, parts) - before if look else np.zeros(len(before))
            along = float(before @ change) / max(float(change @ change), TINY)
            strength = min(STRONGEST, max(0.0, -along))
            left = before + strength * change
            found.append((float(left @ left), space.scaled(values, neutral, strength)))
        return [values for _, values in sorted(found, key=itemgetter(0))[:SCALED]]

    def _at(
        self, effects: Sequence[tuple[EffectType, Values]], given: Fitted, reading: Reading, parts: Sequence[int]
    ) -> Fitted | None:
        """Return a hypothesis with the room's departures where they would go, were everything straight from here."""
        fitted = self.at(effects, given.departures, reading)
        if fitted is None or not self.unknowns:
            return fitted
        return replace(fitted, errors=self._followed(fitted, parts))

    def _followed(self, fitted: Fitted, parts: Sequence[int]) -> list[Errors]:
        """Return the errors after the room's departures follow, by the slopes at the base."""
        sizes = [len(each.whitened) for each in fitted.errors]
        whole = np.concatenate([each.whitened for each in fitted.errors])
        solution, fit = self._solution(tuple(parts))
        step = -solution @ np.concatenate((whole[fit], fitted.departures / self.sd))
        most = MOST_SD * self.sd
        step = np.clip(fitted.departures + step, -most, most) - fitted.departures
        moved = np.split(whole + self._slopes @ step, np.cumsum(sizes)[:-1])
        return [replace(each, whitened=vector) for each, vector in zip(fitted.errors, moved, strict=True)]

    def _solution(self, parts: tuple[int, ...]) -> tuple[FloatArray, np.ndarray]:
        """Return what solves for the departures (unknowns, m + unknowns), and which errors are fitted (bool)."""
        if parts not in self._solutions:
            fit = np.concatenate([np.isin(each.part, parts) for each in self.base.errors])
            self._solutions[parts] = np.linalg.pinv(np.vstack((self._slopes[fit], np.diag(1.0 / self.sd)))), fit
        return self._solutions[parts]

    @cached_property
    def _slopes(self) -> FloatArray:
        return self._slopes_at(self.base)

    def _slopes_at(self, fitted: Fitted, places: Sequence[int] | None = None) -> FloatArray:
        """Change of the whitened errors with each departure of the room (m, unknowns), or with some of them."""
        whole = np.concatenate([each.whitened for each in fitted.errors])
        columns = [np.zeros((len(whole), 0))]
        for place in range(len(self.sd)) if places is None else places:
            sd = self.sd[place]
            step = 0.1 * sd * (1.0 if fitted.departures[place] <= 0.0 else -1.0)
            moved = fitted.departures.copy()
            moved[place] += step
            other = self.at(fitted.effects, moved, fitted.reading)
            there = np.concatenate([each.whitened for each in other.errors]) if other else whole
            columns.append((there - whole)[:, None] / step)
        return np.hstack(columns)

    def refined(
        self,
        effects: Sequence[tuple[EffectType, Values]],
        departures: FloatArray,
        reading: Reading,
        parts: Sequence[int] = (FIT,),
        is_rough: bool = False,
    ) -> Fitted | None:
        """Return a hypothesis with all its parameters fitted together from given ones.

        A rough fit takes the room's answer to its departures as it was at the base.
        """
        if self.unknowns:
            return self._room_fit(effects, departures, reading, parts, self._slopes if is_rough else None)
        if not any(effect.priors for effect, _ in effects):
            return self.at(effects, departures, reading)
        smooth = self._smooth_fit(effects, departures, reading, parts)
        spaces = [Space(effect) for effect, _ in effects]
        start = np.concatenate([space.inside(v) for space, (_, v) in zip(spaces, smooth, strict=True)])

        def loss(x: FloatArray) -> float:
            return self.score(self.at(valued(effects, spaces, x), departures, reading), parts)

        most = REFINE.get(len(start), REFINE_MORE)
        found = descend(loss, start, round(most * self.thorough))
        return self.at(valued(effects, spaces, found), departures, reading)

    def _smooth_fit(
        self,
        effects: Sequence[tuple[EffectType, Values]],
        departures: FloatArray,
        reading: Reading,
        parts: Sequence[int],
    ) -> Sequence[tuple[EffectType, Values]]:
        """Return parameters after Gauss-Newton steps, which go far along a valley; what switches is left as it is."""
        if all(channel in self.record.binary for channel in self.link.judged):
            return effects
        problem = LeastSquares(self, effects, reading, parts)
        found = problem.solved(problem.vector(departures), round(STEPS * self.thorough), None)
        return found.effects if found else effects

    def _room_fit(
        self,
        effects: Sequence[tuple[EffectType, Values]],
        departures: FloatArray,
        reading: Reading,
        parts: Sequence[int],
        known: FloatArray | None = None,
        most: int | None = None,
    ) -> Fitted | None:
        """Fit departures and effects together by damped Gauss-Newton steps, the departures held by their priors.

        The slopes of the departures are kept as long as they serve, they hardly change; known ones are kept throughout.
        """
        if not self.unknowns:
            return self.at(effects, departures, reading)
        problem = LeastSquares(self, effects, reading, parts)
        if most is None:
            most = round(STEPS * self.thorough) if effects else STEPS  # all else is compared with what is believed
        return self._with_events(problem.solved(problem.vector(departures), most, known))

    def _with_events(self, fitted: Fitted | None) -> Fitted | None:
        """Return a fit with its events fitted to all days, not only to those that a property is learned from."""
        if fitted is None or not len(self._events):
            return fitted
        sd = self.sd[self._events]
        missed = np.concatenate((*(each.whitened for each in fitted.errors), fitted.departures[self._events] / sd))
        steps = -sd * np.linalg.lstsq(np.vstack((self._event_slopes * sd, np.eye(len(sd)))), missed, rcond=None)[0]
        departures = fitted.departures.copy()
        departures[self._events] = np.clip(departures[self._events] + steps, -MOST_SD * sd, MOST_SD * sd)
        return self.at(fitted.effects, departures, fitted.reading) or fitted

    @cached_property
    def _event_slopes(self) -> FloatArray:
        """Change of the whitened errors with each event (m, events), of the room as believed."""
        believed = self.at((), np.zeros(len(self.sd)), self.link.readings[0])
        assert believed
        return self._slopes_at(believed, self._events)


def _missed(fitted: Fitted, parts: Sequence[int]) -> FloatArray:
    return np.concatenate([each.whitened[np.isin(each.part, parts)] for each in fitted.errors])


def of_other(reading: Reading, given: Fitted) -> float:
    """Return by how much another reading than a given one must be better: an effect may do no more than undo it."""
    return 0.0 if reading == given.reading else OTHER
