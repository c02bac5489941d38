"""Slow departures: a balance over hours to days, in which a room's quick unrest cancels, and its wandering is learnt."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from scipy.linalg import solve_triangular

from waxstudy.diagnosis.neighbours.pattern import Pattern, Scored
from waxstudy.diagnosis.neighbours.series import House, coarse
from waxstudy.diagnosis.neighbours.spans import LEAST_DAYS, days_paid
from waxstudy.plugin import FloatArray

STEP_H = 2.0  # longer than what a window or a cook leaves, short enough for where a night begins
MOST_STEPS = 180  # of a record; a longer one is looked at in longer steps
# how a room comes to where less heat leaves it: linings, a light and a heavy structure
TAUS_H = (6.0, 18.0, 54.0)
LAGS_H = (0.0, 3.0)  # of what heats a room, before that: air or radiators, a heated floor or wall
LENGTHS_H = (12, 16, 20, 24, 30, 36, 48, 60, 72, 96, 120)
DAILY_H = (6, 8, 10, 12, 14)
# a room wanders over one of these times, and its quick unrest, over an hour or two, has the rest of the variance
WANDER_H, QUICK_H = (6.0, 15.0, 40.0, 100.0), 1.5
SHARES = (0.5, 0.8, 0.95)
BEFORE_H = (3.0, 12.0, 48.0)  # in which a room forgets what it was like before the record
SAME = 0.25  # of its length by which a span is moved, and is still about the same
LEAST_SHARE = 0.1  # of a shape's weight that the regressors must leave, for it to be seen at all
TINY = 1e-9


@dataclass(frozen=True)
class _Wander:
    """What is left of a room (m,) by one way of wandering, whitened, and without its regressors."""

    factor: FloatArray  # (m, m) of the errors' correlation, lower
    basis: FloatArray  # (m, p) orthonormal, of the whitened regressors
    white: FloatArray  # (m,)
    price: float  # minus twice its likelihood beside the sum of squares

    def of(self, shapes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return shapes (m, k) whitened and without the regressors, and their squares (k,), 0 where little is left."""
        found = solve_triangular(self.factor, shapes, lower=True, check_finite=False)
        before = np.sum(found**2, axis=0)
        found -= self.basis @ (self.basis.T @ found)
        square = np.sum(found**2, axis=0)
        return found, np.where(square > LEAST_SHARE * before, square, 0.0)

    @property
    def free(self) -> int:
        return len(self.white) - self.basis.shape[1]

    def loss(self, square: FloatArray) -> FloatArray:
        """Return minus twice the log likelihood, at the spread that fits best, of what is left in squares."""
        return np.asarray(self.free * np.log(np.maximum(square, TINY)) + self.price)


@dataclass(frozen=True)
class Slow:
    """A room on a coarse scale: what its neighbours and drives leave of it, and the ways in which it may wander."""

    house: House
    left_K: FloatArray  # (n,)
    regressors: FloatArray  # (n, p)

    @cached_property
    def per_step(self) -> int:
        longest = len(self.house) * self.house.step_h / MOST_STEPS
        day = round(24.0 / self.house.step_h)
        least = max(1, round(max(STEP_H, longest) / self.house.step_h))
        return next(each for each in range(least, day + 1) if day % each == 0)

    @property
    def step_h(self) -> float:
        return self.per_step * self.house.step_h

    @cached_property
    def known(self) -> np.ndarray:
        return np.isfinite(coarse(self.left_K, self.per_step))

    def means(self, shapes: FloatArray) -> FloatArray:
        """Return the means of shapes (n, k) over the coarse steps that are known (m, k)."""
        return np.column_stack([coarse(each, self.per_step)[self.known] for each in shapes.T])

    @cached_property
    def wanders(self) -> list[_Wander]:
        left = coarse(self.left_K, self.per_step)[self.known]
        since_h = (np.arange(len(self.house)) + 0.5) * self.house.step_h
        before = [np.exp(-since_h / tau_h) for tau_h in BEFORE_H]
        rows = self.means(np.column_stack((self.regressors, *before)))
        rows = rows / np.maximum(np.sqrt(np.mean(rows**2, axis=0)), TINY)
        lag_h = np.abs(np.subtract.outer(*2 * (np.flatnonzero(self.known) * self.step_h,)))
        return [
            _wander(share * np.exp(-lag_h / tau_h) + (1.0 - share) * np.exp(-lag_h / QUICK_H), left, rows)
            for tau_h in WANDER_H
            for share in SHARES
        ]

    @cached_property
    def best_loss(self) -> float:
        """The least loss with no departure."""
        return min(float(each.loss(np.sum(each.white**2))) for each in self.wanders)

    def gains(self, shapes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what each of some shapes (m, k) gains alone, and its size, each with the wander that fits it best."""
        best, sizes = np.full(shapes.shape[1], np.inf), np.zeros(shapes.shape[1])
        for each in self.wanders:
            found, square = each.of(shapes)
            pull = found.T @ each.white
            size = np.where(square > 0.0, pull / np.where(square > 0.0, square, 1.0), 0.0)
            loss = each.loss(np.sum(each.white**2) - size * pull)
            sizes = np.where(loss < best, size, sizes)
            best = np.minimum(best, loss)
        return self.best_loss - best, sizes

    def gained(self, pattern: Pattern) -> float:
        """Return what a pattern gains, twice the log likelihood, less the price of its size and of its days."""
        gain = float(self.gains(self.means(pattern.shapes(self.house)))[0][0])
        return gain - self.price(pattern)

    def price(self, pattern: Pattern) -> float:
        """Return what a size costs, and the choice of days."""
        per_day = round(24.0 / self.house.step_h)
        days = np.array([begin for begin, _ in pattern.spans]) // per_day
        paid = which_days_paid(days, -(-len(self.house) // per_day)) if len(days) > 1 else 0.0
        return float(np.log(len(self.known))) + paid

    def best(self) -> Iterator[Scored]:
        """Yield for each answer and length the best single span, and the best hours on several days."""
        for answer in product(LAGS_H, TAUS_H):
            for length_h in LENGTHS_H:
                if 2 * length_h <= len(self.house) * self.house.step_h:
                    yield self._single(answer, length_h)
            for length_h in DAILY_H:
                yield from self._daily(answer, length_h)

    @property
    def tried(self) -> int:
        """How many spans are looked at that differ, in all rooms."""
        record_h = len(self.house) * self.house.step_h
        singles = sum(max(1.0, record_h / (SAME * each)) for each in LENGTHS_H)
        count = singles + len(DAILY_H) * 24.0 / self.step_h
        return round(count * len(LAGS_H) * len(TAUS_H) * len(self.house.rooms))

    def _shapes(self, answer: tuple[float, float], length_h: float) -> tuple[FloatArray, int]:
        """Return the shape of a span from each coarse step on (m, steps), and its length in steps of the house."""
        steps = round(length_h / self.house.step_h)
        shape = coarse(Pattern(((0, steps),), answer[1:], answer[0]).shapes(self.house)[:, 0], self.per_step)
        found = np.zeros((len(shape), len(shape)))
        for begin in range(len(shape)):
            found[begin:, begin] = shape[: len(shape) - begin]
        return found[self.known], steps

    def _single(self, answer: tuple[float, float], length_h: float) -> Scored:
        shapes, steps = self._shapes(answer, length_h)
        gains, sizes = self.gains(shapes)
        first = int(np.argmax(gains))
        begin = first * self.per_step
        pattern = Pattern(((begin, begin + steps),), answer[1:], answer[0])
        return Scored(pattern, float(sizes[first]), float(gains[first]), 1.0)

    def _daily(self, answer: tuple[float, float], length_h: float) -> Iterator[Scored]:
        """Yield the best hours of the day, on the days that show them most; which days is paid for."""
        shapes, steps = self._shapes(answer, length_h)
        _, alone = self.gains(shapes)
        per_day = round(24.0 / self.step_h)
        places = np.arange(shapes.shape[1])
        sets: list[np.ndarray] = []
        for hour in range(per_day):
            own = places[hour::per_day]
            for order in (own[np.argsort(alone[own])], own[np.argsort(-alone[own])]):
                sets += [np.sort(order[:chosen]) for chosen in range(LEAST_DAYS, len(order) // 2 + 2)]
            sets += [own[a:b] for a in range(len(own)) for b in range(a + LEAST_DAYS, min(a + len(own) // 2 + 2, len(own) + 1))]
        if not sets:
            return
        gains, sizes = self.gains(np.column_stack([shapes[:, each].sum(axis=1) for each in sets]))
        paid = np.array([which_days_paid(each // per_day, -(-len(places) // per_day)) for each in sets])
        most = int(np.argmax(gains - paid))
        begins = [int(each) * self.per_step for each in sets[most]]
        pattern = Pattern(tuple((begin, begin + steps) for begin in begins), answer[1:], answer[0])
        yield Scored(pattern, float(sizes[most]), float(gains[most]), 1.0)


def which_days_paid(days: np.ndarray, count: int) -> float:
    """Return what the choice of days costs: one after the other are fewer ways than any."""
    any_ = days_paid(count, len(days))
    return min(any_, 2.0 * float(np.log(count * (count + 1) / 2))) if np.all(np.diff(days) == 1) else any_


def _wander(correlation: FloatArray, left: FloatArray, rows: FloatArray) -> _Wander:
    factor = np.linalg.cholesky(correlation + TINY * np.eye(len(left)))
    basis, upper = np.linalg.qr(solve_triangular(factor, rows, lower=True))
    white = solve_triangular(factor, left, lower=True)
    white = white - basis @ (basis.T @ white)
    price = 2.0 * float(np.sum(np.log(np.diag(factor))) + np.sum(np.log(np.abs(np.diag(upper)) + TINY)))
    return _Wander(np.asarray(factor), np.asarray(basis), np.asarray(white), price)
