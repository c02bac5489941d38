"""Every span in which a room may depart: how far each stands out of the room's own unrest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf, lgamma

import numpy as np

from waxstudy.diagnosis.neighbours.limits import (
    DAILY_MOST_H,
    FEWEST_SPANS,
    LEAST_DAYS,
    LEAST_SEEN,
    UNREST_MOST_H,
    USUAL,
)
from waxstudy.diagnosis.neighbours.noise import Fit
from waxstudy.diagnosis.neighbours.pattern import Pattern, Scored
from waxstudy.diagnosis.neighbours.series import House, response
from waxstudy.plugin import FloatArray

# how soon a room answers: its air at once, air with what it moves, furniture and linings, structure
TAUS_H = (0.0, 1.0, 4.0, 16.0)
LENGTHS_H = (1, 1.5, 2, 2.5, 3, 3.5, 4, 5, 6, 7, 8, 9, 10, 12, 14, 17, 20, 24, 30, 36, 48, 72, 96)
USUAL_SD = 1.2816  # of a normal distribution: this share keeps so near to 0


def tried(house: House) -> int:
    """Return how many spans are looked at, in all rooms."""
    return len(TAUS_H) * len(LENGTHS_H) * len(house) * len(house.rooms)


def scored(house: House, fit: Fit, most_h: float = inf) -> Iterator[Scored]:
    """Yield for each length (up to `most_h`) and answer the best single span, and the best hours on several days."""
    for tau_h in TAUS_H:
        steady, unrest = Steady.of(house, fit, tau_h), 1.0
        for length_h in (each for each in LENGTHS_H if each <= most_h):
            steps = round(length_h / house.step_h)
            if 1 <= steps < len(house) // 2:
                pull, weight = steady.pulls(steps)
                unrest = _unrest(pull, weight) if length_h <= UNREST_MOST_H else unrest
                yield _single(pull, weight, unrest, Pattern(((0, steps),), (tau_h,)))
                if length_h <= DAILY_MOST_H:
                    yield from _daily(house, (pull, weight), unrest, Pattern(((0, steps),), (tau_h,)))


@dataclass(frozen=True)
class Steady:
    """A shape that begins at a step and never ends: a span is one from its first step, less one from its end."""

    shape: FloatArray  # (n,) its innovations, from its first step on
    known: FloatArray  # (n,) one over the square of the errors' spread, 0 where unknown
    products: FloatArray  # (n, 1 + p) for each first step, with what is left and with the regressors
    square: FloatArray  # (n,) of the shape itself

    @classmethod
    def of(cls, house: House, fit: Fit, tau_h: float) -> Steady:
        shape = fit.errors.of_shape(response(np.ones(len(house)), tau_h, house.step_h))
        by = 1.0 / fit.errors.sd_K
        rows, known = np.column_stack((fit.white, fit.basis)) * by[:, None], fit.known * by**2
        return cls(shape, known, _from_each(rows, shape), _from_each(known, shape**2))

    def pulls(self, steps: int) -> tuple[FloatArray, FloatArray]:
        """Return for each first step (n,) the product of a span's shape with what is left, and the shape's own square.

        Both by the errors' spread, and without what the regressors could take of the shape.
        """
        products = self.products - _later(self.products, steps)
        both = np.concatenate((np.zeros(steps), self.shape[steps:] * self.shape[:-steps]))
        square = self.square + _later(self.square, steps) - 2.0 * _from_each(self.known, both)
        left = square - np.sum(products[:, 1:] ** 2, axis=1)
        seen = left > LEAST_SEEN * np.median(square[self.known > 0.0])  # the rest is rounding
        return np.where(seen, products[:, 0], 0.0), np.where(seen, left, 0.0)


def _from_each(rows: FloatArray, shape: FloatArray) -> FloatArray:
    """Return the products of a shape (n,) that begins at each step with rows (n, ...)."""
    from scipy.signal import fftconvolve  # no diagnosis of a single loop waits for it

    back = shape[::-1].reshape(-1, *[1] * (rows.ndim - 1))
    return np.asarray(fftconvolve(rows, back, axes=0)[len(shape) - 1 :])


def _later(values: FloatArray, steps: int) -> FloatArray:
    return np.concatenate((values[steps:], np.zeros((steps, *values.shape[1:]))))


def _unrest(pull: FloatArray, weight: FloatArray) -> float:
    """Return by how much the variance of spans of one length is above what the errors alone would give, at least 1."""
    seen = weight > 0.0
    if seen.sum() < FEWEST_SPANS:
        return 1.0
    usual = np.quantile(np.abs(pull[seen]) / np.sqrt(weight[seen]), USUAL) / USUAL_SD
    return max(1.0, float(usual) ** 2)


def days_paid(count: int, chosen: int) -> float:
    """Return twice the logarithm of in how many ways so many days can be chosen."""
    return 2.0 * (lgamma(count + 1) - lgamma(chosen + 1) - lgamma(count - chosen + 1))


def unrest_of(house: House, fit: Fit, pattern: Pattern) -> float:
    """Return by how much the variance of a pattern's size is above what the errors alone would give, at least 1."""
    begin, end = pattern.spans[0]
    steps = max(1, min(end - begin, round(UNREST_MOST_H / house.step_h)))
    return max(_unrest(*Steady.of(house, fit, tau_h).pulls(steps)) for tau_h in pattern.taus_h)


def _gains(pull: FloatArray, weight: FloatArray) -> FloatArray:
    return np.asarray(np.where(weight > 0.0, pull**2 / np.where(weight > 0.0, weight, 1.0), 0.0))


def _single(pull: FloatArray, weight: FloatArray, unrest: float, pattern: Pattern) -> Scored:
    gains = _gains(pull, weight) / unrest
    first = int(np.argmax(gains))
    size = pull[first] / weight[first] if weight[first] > 0.0 else 0.0
    return Scored(pattern.moved(first, first), float(size), float(gains[first]))


def _daily(house: House, found: tuple[FloatArray, FloatArray], unrest: float, pattern: Pattern) -> Iterator[Scored]:
    """Yield the best hours of the day, on the days that show them most; which days is paid for, but for all of them."""
    per_day = round(24.0 / house.step_h)
    day, place = house.days, np.floor(house.hour / house.step_h).astype(int) % per_day
    count = int(day[-1]) + 1
    pull, weight = np.zeros((2, count, per_day))
    pull[day, place], weight[day, place] = found
    first = np.full((count, per_day), -1)
    first[day, place] = np.arange(len(house))
    ways = np.array([days_paid(count, chosen) for chosen in range(1, count + 1)])
    for sign in (-1.0, 1.0):
        order = np.argsort(-sign * pull, axis=0)
        pulls, weights = (np.cumsum(np.take_along_axis(each, order, axis=0), axis=0) for each in (pull, weight))
        alone = np.cumsum(np.take_along_axis(_gains(pull, weight), order, axis=0), axis=0)
        gains = _gains(np.maximum(sign * pulls, 0.0), weights)
        # what sizes of their own would gain counts against hours that come back: one day must not stand for the rest
        gains = (2.0 * gains - alone) / unrest - ways[:, None]
        gains[: LEAST_DAYS - 1] = 0.0
        last, hour = np.unravel_index(int(np.argmax(gains)), gains.shape)
        begins = sorted(int(first[each, hour]) for each in order[: last + 1, hour] if weight[each, hour] > 0.0)
        if len(begins) >= LEAST_DAYS:
            spans = tuple((each, each + pattern.spans[0][1]) for each in begins)
            size = pulls[last, hour] / weights[last, hour]
            yield Scored(Pattern(spans, pattern.taus_h), float(size), float(gains[last, hour]))
