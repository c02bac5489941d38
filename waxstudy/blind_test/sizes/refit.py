"""Refits to a record without noise: what stays when the room's unknowns follow it, and an effect with them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial
from typing import Any

import numpy as np
from scipy.optimize import lsq_linear, minimize
from scipy.stats import qmc

from waxstudy.blind_test.sizes.missed import Gaps, Missed, gaps, missed
from waxstudy.blind_test.sizes.record import Record
from waxstudy.blind_test.sizes.room import Unknown, unknowns
from waxstudy.blind_test.sizes.stretch import Shown, Stretch
from waxstudy.plugin import Belief, Effect, FloatArray, Prior, SimulationError
from waxstudy.synthetic.departures import Departures

LOOKS, MANY_LOOKS = {1: 32, 2: 128}, 256  # points of a first look, by the number of parameters
OF_ROOM = 0.25  # share of them where a room takes part: it is slow, and answers smoothly
CLOSER, RUNS = 3, 40  # points that are looked at more closely, with so many runs for each parameter
SIZE = 0.06  # of the first simplex, in a cube of 1
MOST_SD = 2.5  # of a departure: what needs more is a finding
HOLD = 0.3  # chosen: what a usual departure costs; three of them cost as much as a channel at its limit
STEP = 0.1  # usual departures over which a slope is taken
SETTLED, SHORTER = 0.99, 0.3  # share of a loss that is as good as all of it; of a step that went too far
ROUNDS, STEPS = 12, 4  # of slopes, and steps with the same ones: no room answers quite straight
NEARLY = 4.0  # times the loss of all channels at their limits, from which on an effect is out of question
TINY, IMPOSSIBLE = 1e-9, 1e12  # losses

Edit = Callable[[Belief], Belief]


@dataclass(frozen=True)
class Replacing:
    """An edit that puts another block in the place of a believed one."""

    apply: Edit

    def __call__(self, belief: Belief) -> Belief:
        return self.apply(belief)


def as_believed(belief: Belief) -> Belief:
    return belief


@dataclass(frozen=True)
class Fit:
    """What an edited belief misses at given departures from what is true (unknowns,), in units of the usual ones."""

    departures: FloatArray
    missed: Missed
    weighed: FloatArray  # all fitted errors in one, whose squares add up to 1 for each channel at its limit

    @property
    def loss(self) -> float:
        return float(self.weighed @ self.weighed + HOLD**2 * self.departures @ self.departures)


@dataclass(frozen=True)
class Refit:
    """A stretch of a record without noise, and how much of each of its channels may be left (`limits`).

    What lies in the last part of the record, the share `held_out`, is not fitted. Where it is known by how much the
    true room and its heat stray from the belief (`departures`), everything is looked for from there, and as far from
    the belief as ever; `others` are effects that are known. `healthy` is what the same belief misses of the house
    without the cause: that counts for nothing, and nothing of the room follows the record any more.
    """

    stretch: Stretch
    record: Record
    belief: Belief
    limits: Gaps
    room_tolerance: float = 1.0
    held_out: float = 0.0
    departures: Departures = field(default_factory=dict)
    others: Edit = as_believed
    healthy: Missed | None = None

    def beside(self, healthy: Refit) -> Refit:
        """Return a refit of the room as it follows a healthy record, which the same house gave without the cause."""
        found = healthy.base
        belief = self._of_room(tuple(found.departures))
        return replace(self, belief=belief, departures={}, healthy=found.missed)

    @property
    def beyond(self) -> float:
        """The largest gap over its limit that is left when nothing but the unknowns follows the record."""
        return max(gap / self.limits[channel] for channel, gap in gaps(self.base.missed).items())

    def fitted(self, edit: Edit) -> Fit | None:
        """Return an edited belief whose unknowns follow the record, None where it cannot be simulated."""
        starts = (self.fit(edit, each.departures) for each in (self._believed, self.base))
        ends = [self._settled(edit, start, self._slopes) for start in starts if start]
        return min(ends, key=lambda end: end.loss, default=None)

    def is_alike(self, effect: type[Effect]) -> bool:
        """Return whether an effect, and the unknowns with it, can leave less than the limit of every channel."""
        if effect.hindrance(self._true):
            return False
        if self.beyond <= 1.0 and effect.neutral(self._true) is not None:
            return True  # the unknowns do alone, with an effect that does nothing
        return any(self._passes(effect, point) for point in self._best_points(effect))

    def nearest(self, effect: type[Effect]) -> Fit | None:
        """Return the best fit of an effect, None where none can be simulated."""
        if effect.hindrance(self._true):
            return None
        fits = [self.fitted(_with(effect, point)) for point in self._best_points(effect)]
        return min((fit for fit in fits if fit), key=lambda fit: fit.loss, default=None)

    def _passes(self, effect: type[Effect], point: FloatArray) -> bool:
        if self._look(effect, point) > NEARLY * len(self.limits):
            return False
        found = self.fitted(_with(effect, point))
        return found is not None and all(gap <= self.limits[c] for c, gap in gaps(found.missed).items())

    def _best_points(self, effect: type[Effect]) -> Iterator[FloatArray]:
        """Yield the best few of many points in the cube of an effect's parameters, and what is found near each."""
        looked = sorted((self._look(effect, point), *point) for point in self._points(effect))
        for _, *point in looked[:CLOSER]:
            yield from self._closer(effect, np.array(point))

    def _points(self, effect: type[Effect]) -> Iterator[FloatArray]:
        """Yield points all over the cube of an effect's parameters (Sobol), and where it says to start from."""
        count = len(effect.priors)
        looks = LOOKS.get(count, MANY_LOOKS) * (OF_ROOM if self.stretch.has_room else 1.0)
        yield from qmc.Sobol(count, scramble=False).random(round(looks)) if count else np.zeros((1, 0))
        for start in effect.starts(self._true):
            yield np.array([_place(prior, start[name]) for name, prior in effect.priors.items()])

    def _closer(self, effect: type[Effect], start: FloatArray) -> Iterator[FloatArray]:
        """Yield a point, and then the best one found downhill from it (Nelder and Mead: switches make it jagged)."""
        yield start
        if count := len(start):
            corners = np.vstack((start, start + SIZE * np.diag(np.where(start < 0.5, 1.0, -1.0))))
            options: Any = {"maxfev": RUNS * count, "initial_simplex": corners, "xatol": 1e-3, "fatol": 0.01}
            bounds = [(0.0, 1.0)] * count

            def loss(point: FloatArray) -> float:
                return float(np.log(max(self._look(effect, point), TINY)))

            yield np.asarray(minimize(loss, start, method="Nelder-Mead", bounds=bounds, options=options).x)

    def _look(self, effect: type[Effect], point: FloatArray) -> float:
        """Return the loss of an effect with the departures where they would go, were everything straight."""
        found = self.fit(_with(effect, point), self._believed.departures)
        if found is None:
            return IMPOSSIBLE
        departures = self._followed(found, self._slopes)
        return Fit(departures, {}, found.weighed + self._slopes @ (departures - found.departures)).loss

    # --- what nobody knows of the room ---

    @cached_property
    def _unknowns(self) -> list[Unknown]:
        is_open = self.stretch.has_room and self.healthy is None
        return list(unknowns(self.belief, self.record, self.room_tolerance)) if is_open else []

    @cached_property
    def _centre(self) -> FloatArray:
        """How far what is true lies from what is believed (unknowns,), in units of the usual departures."""
        return np.array([self.departures.get(each.name, 0.0) / each.usual for each in self._unknowns])

    @cached_property
    def _true(self) -> Belief:
        return self._departed(tuple(np.zeros(len(self._unknowns))))

    @cached_property
    def _believed(self) -> Fit:
        """The belief as far as it is known; raise `ValueError` where it cannot be simulated."""
        found = self.fit(as_believed, np.zeros(len(self._unknowns)))
        if found is None:
            raise ValueError(f"what is believed of {self.stretch.name} cannot be simulated")
        return found

    @cached_property
    def base(self) -> Fit:
        """The belief without any effect, its unknowns fitted; raise `ValueError` where it cannot be simulated."""
        found = self._believed
        for _ in range(ROUNDS if self._unknowns else 0):
            before, found = found.loss, self._settled(as_believed, found, self._slopes_at(found))
            if found.loss > SETTLED * before:
                break
        return found

    @cached_property
    def _slopes(self) -> FloatArray:
        return self._slopes_at(self._believed)

    def _slopes_at(self, fit: Fit) -> FloatArray:
        """Return the change of the weighed errors with each departure (m, unknowns)."""
        columns = [np.zeros((len(fit.weighed), 0))]
        for move in np.diag(np.where(fit.departures > 0.0, -STEP, STEP)):
            moved = self.fit(as_believed, fit.departures + move)
            columns.append(((moved.weighed if moved else fit.weighed) - fit.weighed)[:, None] / move.sum())
        return np.hstack(columns)

    def _settled(self, edit: Edit, best: Fit, slopes: FloatArray) -> Fit:
        """Return the best fit of some steps from a given one, shorter ones after a step that went too far."""
        wanted = self._followed(best, slopes)
        for _ in range(STEPS if self._unknowns else 0):
            tried = self.fit(edit, wanted)
            if tried and tried.loss < best.loss:
                best, wanted = tried, self._followed(tried, slopes)
            else:
                wanted = best.departures + SHORTER * (wanted - best.departures)
        return best

    def _followed(self, fit: Fit, slopes: FloatArray) -> FloatArray:
        """Return the departures that would take most of what is missed away, were everything straight."""
        if not self._unknowns:
            return fit.departures
        # the triangle of a QR decomposition is as good as all slopes, and small
        turned, triangle = np.linalg.qr(np.vstack((slopes, HOLD * np.eye(len(fit.departures)))))
        wanted = -turned.T @ np.concatenate((fit.weighed, HOLD * fit.departures))
        from_belief = self._centre + fit.departures
        reach = -MOST_SD - TINY - from_belief, MOST_SD + TINY - from_belief
        return np.asarray(fit.departures + lsq_linear(triangle, wanted, reach, method="bvls").x)

    def fit(self, edit: Edit, departures: FloatArray) -> Fit | None:
        """Return what an edited belief misses at given departures, None where it cannot be simulated."""
        try:
            shown = self._shown(self._edited(edit, tuple(departures)))
        except (SimulationError, ValueError, ArithmeticError):
            return None
        errors = self._beside_healthy(missed(self.stretch, self.record, shown))
        return Fit(departures, errors, np.concatenate([self._weighed(c, each) for c, each in errors.items()]))

    def _beside_healthy(self, errors: Missed) -> Missed:
        """Return errors without those of the healthy record, but for the seconds around switches, which are others."""
        if self.healthy is None:
            return errors
        known = {c: each for c, each in self.healthy.items() if c in errors and c not in self.record.switches}
        return {c: each - known[c] if c in known else each for c, each in errors.items()}

    def _weighed(self, channel: str, errors: FloatArray) -> FloatArray:
        fitted = errors[: round((1.0 - self.held_out) * len(errors))]
        return np.asarray(np.nan_to_num(fitted) / (self.limits[channel] * max(1, np.isfinite(fitted).sum()) ** 0.5))

    def _shown(self, belief: Belief) -> Shown:
        """Return what a belief shows, of a room in long steps: what short ones change hardly hangs on the belief."""
        found = self.stretch.shown(self.record, belief, is_rough=True)
        return {channel: values + self._finer[channel] for channel, values in found.items()}

    @cached_property
    def _finer(self) -> Shown:
        fine, rough = (self.stretch.shown(self.record, self._true, is_rough=way) for way in (False, True))
        return {channel: fine[channel] - rough[channel] for channel in fine}

    def _edited(self, edit: Edit, departures: tuple[float, ...]) -> Belief:
        """Return an edited belief; what replaces a block comes before the effects that are known."""
        if isinstance(edit, Replacing):
            return self.others(edit(self._of_room(departures)))
        return edit(self._departed(departures))

    def _of_room(self, departures: tuple[float, ...]) -> Belief:
        belief = self.belief
        for each, true, departure in zip(self._unknowns, self._centre, departures, strict=True):
            belief = each.apply(belief, each.usual * (true + departure))
        return belief

    @cached_property
    def _departed(self) -> Callable[[tuple[float, ...]], Belief]:
        """departures from what is true -> the belief; the last ones are kept: most is looked at from the same."""

        return lru_cache(maxsize=2)(lambda departures: self.others(self._of_room(departures)))


def _with(effect: type[Effect], point: FloatArray) -> Edit:
    values = {name: _value(prior, float(at)) for (name, prior), at in zip(effect.priors.items(), point, strict=True)}
    apply = partial(effect.apply, p=effect.Parameters(**values))
    return Replacing(apply) if effect.replaces else apply


def _value(prior: Prior, at: float) -> float:
    return prior.low * (prior.high / prior.low) ** at if prior.is_log else prior.low + (prior.high - prior.low) * at


def _place(prior: Prior, value: float) -> float:
    if prior.is_log:
        return float(np.log(max(value, prior.low) / prior.low) / np.log(prior.high / prior.low))
    return (value - prior.low) / (prior.high - prior.low)
