"""Heat in pieces from what a room's model misses: a Gaussian posterior, the unknowns of the room marginalised."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np

from waxstudy.diagnosis.result import NORMAL, Interval
from waxstudy.plugin import FloatArray

# chosen: how large heat may be that nobody knows of, W per m² of floor; each is as likely
SIZES_W_M2 = (0.1, 0.4, 1.6, 6.4, 25.6)
HANGS_H = 12.0  # chosen: over which heat that does not come every day hangs together
OF_DAY_H = 4.0  # chosen: over which heat that comes every day does
LEAST_WEIGHT = 1e-3  # of a size of heat, to be counted
TINY = 1e-9


@dataclass(frozen=True)
class Pieces:
    """Pieces of a record, of whole hours by the clock: the piece of each sample (n,), and middles in hours (P,)."""

    of_sample: np.ndarray
    middle_h: FloatArray  # since midnight before the record
    length_h: float

    @property
    def count(self) -> int:
        return len(self.middle_h)

    @classmethod
    def of(cls, count: int, interval_s: float, start_s: float, length_h: float) -> Pieces:
        number = ((start_s + (np.arange(count) + 0.5) * interval_s) // (3600.0 * length_h)).astype(int)
        return cls(number - number[0], (np.arange(number[0], number[-1] + 1) + 0.5) * length_h, length_h)

    def means(self, values: FloatArray) -> FloatArray:
        """Return the means of a channel (n,) over the pieces (P,)."""
        sums = np.bincount(self.of_sample, values, self.count)
        return np.asarray(sums / np.bincount(self.of_sample, minlength=self.count))

    def hours(self, interval_s: float) -> FloatArray:
        """Return how many hours of a record are in each piece (P,)."""
        return np.asarray(np.bincount(self.of_sample, minlength=self.count) * interval_s / 3600.0, dtype=float)

    def courses(self) -> Iterator[FloatArray]:
        """Yield a watt in each piece (n,)."""
        return ((self.of_sample == piece).astype(float) for piece in range(self.count))

    def within(self, other: Pieces) -> FloatArray:
        """Return which longer pieces each of these lies in (P, longer), 0 or 1."""
        found = np.zeros((self.count, other.count))
        found[self.of_sample, other.of_sample] = 1.0
        return found


@dataclass(frozen=True)
class Unknowns:
    """What else moves whitened residuals: by `slopes` (m, k), with a normal prior around 0 of a `covariance` (k, k)."""

    slopes: FloatArray
    covariance: FloatArray

    @classmethod
    def none(cls, count: int) -> Unknowns:
        return cls(np.zeros((count, 0)), np.zeros((0, 0)))


@dataclass(frozen=True)
class HeatData:
    """What whitened residuals tell of heat in pieces, `missed` (m,) without it; they move by `slopes` (m, P) with it.

    What was `lost` of the record is fitted along. What is `doubted` of the room is not, as it would take the heat: it
    blurs what is told by as much as it may be off (Schmidt 1966 calls such parameters considered).
    """

    missed: FloatArray
    slopes: FloatArray
    lost: Unknowns
    doubted: Unknowns

    def merged(self, within: FloatArray) -> HeatData:
        return HeatData(self.missed, self.slopes @ within, self.lost, self.doubted)

    @cached_property
    def told(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the precision of heat (P, P) by the data alone, that times the heat that fits best (P,), and its blur.

        The blur is the covariance (P, P) of the second by what is doubted.
        """
        count = self.slopes.shape[1]
        all_ = np.column_stack((self.slopes, self.missed, self.doubted.slopes))
        found = self.slopes.T @ all_
        if ways := self.lost.slopes.shape[1]:
            across = self.lost.slopes.T @ all_
            inner = self.lost.slopes.T @ self.lost.slopes + np.linalg.solve(self.lost.covariance, np.eye(ways))
            found = found - across[:, :count].T @ np.linalg.solve(inner, across)
        doubt = found[:, count + 1 :]
        return found[:, :count], -found[:, count], doubt @ self.doubted.covariance @ doubt.T

    def resolved(self, sd_W: float) -> float:
        """Return the share of the variance of heat of a size that the data take away, the mean over the pieces."""
        precision, _, _ = self.told
        left = np.linalg.inv(precision + np.eye(len(precision)) / sd_W**2)
        return float(np.mean(1.0 - np.diag(left) / sd_W**2))


@dataclass(frozen=True)
class HeatEstimate:
    """Heat in pieces: its posterior mean (P,) and covariance (P, P)."""

    mean_W: FloatArray
    covariance: FloatArray

    def of(self, weights: FloatArray) -> Interval:
        """Return a weighted sum of the pieces, as a mean or a slope over them is."""
        value = float(weights @ self.mean_W)
        wide = NORMAL * max(0.0, float(weights @ self.covariance @ weights)) ** 0.5
        return Interval(value, value - wide, value + wide)

    @property
    def size_W(self) -> float:
        """The standard deviation of heat of a piece, as likely as the data have it."""
        return float(np.sqrt(np.mean(self.mean_W**2 + np.diag(self.covariance))))

    def pieces(self) -> list[Interval]:
        return [self.of(each) for each in np.eye(len(self.mean_W))]


def estimated(data: HeatData, pieces: Pieces, floor_m2: float, usual_W: float = 0.0) -> HeatEstimate:
    """Return the heat that data tell, its prior's sizes weighed by the evidence for them.

    Heat is a constant, a course that comes every day, and a rest that hangs together over some hours; each may be of
    any of the sizes. What a healthy record has of it, `usual_W`, is no finding: it blurs what is told, one half of
    it every day alike.
    """
    precision, pull, blur = data.told
    shapes = _shapes(pieces)
    blur = blur + usual_W**2 * precision @ (0.5 * (shapes[1] + shapes[2])) @ precision
    found = []
    for sizes in product(np.array(SIZES_W_M2) * floor_m2, repeat=len(shapes)):
        prior = sum(size**2 * shape for size, shape in zip(sizes, shapes, strict=True))
        found.append(_given(np.asarray(prior), precision, pull))
    return _mixed(found, blur)


def _shapes(pieces: Pieces) -> Sequence[FloatArray]:
    """Return the covariances (P, P) of a constant, of a course that comes every day, and of a rest, of spread 1."""
    apart_h = np.abs(pieces.middle_h[:, None] - pieces.middle_h)
    of_day_h = np.minimum(apart_h % 24.0, -apart_h % 24.0)
    return np.ones_like(apart_h), np.exp(-of_day_h / OF_DAY_H), np.exp(-apart_h / HANGS_H)


Given = tuple[float, FloatArray, FloatArray]  # log evidence, mean, root of the covariance (P, P)


def _given(prior: FloatArray, precision: FloatArray, pull: FloatArray) -> Given:
    """Return the evidence for a prior covariance of heat, and the posterior that it gives."""
    root = np.linalg.cholesky(prior + TINY * np.trace(prior) * np.eye(len(prior)))
    inner = np.linalg.cholesky(np.eye(len(prior)) + root.T @ precision @ root)
    spread = np.linalg.solve(inner, root.T).T  # its square is the covariance
    along = spread.T @ pull
    evidence = 0.5 * float(along @ along) - float(np.sum(np.log(np.diag(inner))))
    return evidence, spread @ along, spread


def _mixed(found: Sequence[Given], blur: FloatArray) -> HeatEstimate:
    """Return the mean and covariance of several posteriors, each weighed by its evidence, and blurred."""
    logs = np.array([evidence for evidence, _, _ in found])
    weights = np.exp(logs - logs.max())
    weights = np.where(weights < LEAST_WEIGHT, 0.0, weights) / weights[weights >= LEAST_WEIGHT].sum()
    mean = sum(weight * each for weight, (_, each, _) in zip(weights, found, strict=True))
    covariance = np.zeros((len(found[0][1]),) * 2)
    for weight, (_, each, spread) in zip(weights, found, strict=True):
        if weight:
            off = each - mean
            own = spread @ spread.T
            covariance += weight * (own + own @ blur @ own + np.outer(off, off))
    return HeatEstimate(np.asarray(mean), covariance)
