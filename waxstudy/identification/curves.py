"""One characteristic time over what happened before: t = a f(t_in / tau) + b_product, fitted by least squares.

With one regressor and an intercept per group, least squares has a closed form in the deviations from the groups'
means: a time constant is searched, and all resampled data are fitted, by two products of matrices.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from waxstudy.plugin import FloatArray

SHORTEST_S, LONGEST_S, COUNT = 20.0, 7200.0, 240
TAUS_S: FloatArray = np.geomspace(SHORTEST_S, LONGEST_S, COUNT)

IntArray = NDArray[np.intp]


@dataclass(frozen=True)
class Shape:
    """f of a curve and the sign that its a must have: dead and rise grow as it cools, hold as it heats."""

    sign: float  # of a

    def __call__(self, before_s: FloatArray, tau_s: FloatArray) -> FloatArray:
        """Return f(t_in / tau) for all taus (taus, n)."""
        decay: FloatArray = np.exp(-before_s[None, :] / np.atleast_1d(tau_s)[:, None])
        return decay if self.sign < 0.0 else 1.0 - decay


COOLING, HEATING = Shape(-1.0), Shape(1.0)  # equations 1 and 2


@dataclass(frozen=True)
class Fitted:
    """Least squares for one or many outcomes at once (m of them)."""

    tau_s: FloatArray  # (m,)
    a_s: FloatArray  # (m,)
    b_s: FloatArray  # (groups, m)
    is_inside: NDArray[np.bool_]  # (m,) the tau lies within the search, not at its end
    rss: FloatArray  # (m,)


def fit_curve(
    shape: Shape, before_s: FloatArray, group: IntArray, outcome_s: FloatArray, tau_s: float | None = None
) -> Fitted:
    """Return the curves with the tau of the highest correlation with the outcomes (n, m), less the groups' means.

    A tau that is given is not searched.
    """
    if tau_s is not None:
        given = np.full(outcome_s.shape[1], tau_s)
        return _at(shape, before_s, group, *_centred(outcome_s, group), given, np.zeros(len(given), dtype=bool))
    _, f = _centred(shape(before_s, TAUS_S).T, group)
    mean_y, y = _centred(outcome_s, group)
    square = np.maximum((f * f).sum(axis=0), 1e-12)
    product = f.T @ y  # (taus, m)
    explained = np.where(shape.sign * product > 0.0, product**2 / square[:, None], 0.0)
    best = np.argmax(explained, axis=0)
    inside = (best > 0) & (best < COUNT - 1)
    found_s = np.exp(_peak(np.log(TAUS_S), explained, best, inside))
    return _at(shape, before_s, group, mean_y, y, found_s, inside)


def _at(
    shape: Shape,
    before_s: FloatArray,
    group: IntArray,
    mean_y: FloatArray,
    y: FloatArray,
    tau_s: FloatArray,
    inside: NDArray[np.bool_],
) -> Fitted:
    """Return the curves with their own taus."""
    mean_f, f = _centred(shape(before_s, tau_s).T, group)  # (n, m): a column for each outcome
    square = np.maximum((f * f).sum(axis=0), 1e-12)
    a = (f * y).sum(axis=0) / square
    a = shape.sign * np.maximum(0.0, shape.sign * a)
    return Fitted(tau_s, a, mean_y - a * mean_f, inside, ((y - a * f) ** 2).sum(axis=0))


def _centred(values: FloatArray, group: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return the groups' means (groups, m) and the deviations from them."""
    count = int(group.max()) + 1
    member = (group[None, :] == np.arange(count)[:, None]).astype(float)
    means = member @ values / member.sum(axis=1)[:, None]
    return means, values - means[group]


def _peak(x: FloatArray, y: FloatArray, at: IntArray, inside: NDArray[np.bool_]) -> FloatArray:
    """Return where parabolas through three points around the largest have their tops."""
    middle = np.clip(at, 1, len(x) - 2)
    column = np.arange(y.shape[1])
    left, top, right = (y[middle + k, column] for k in (-1, 0, 1))
    bend = left - 2.0 * top + right
    shift = np.where(bend < 0.0, 0.5 * (left - right) / np.where(bend < 0.0, bend, 1.0), 0.0)
    return np.where(inside, x[middle] + np.clip(shift, -1.0, 1.0) * (x[1] - x[0]), x[at])


def fit_constant(group: IntArray, outcome_s: FloatArray) -> Fitted:
    """Return the groups' means as curves without a slope."""
    means, rest = _centred(outcome_s, group)
    nothing = np.zeros(outcome_s.shape[1])
    return Fitted(nothing + 1.0, nothing, means, nothing == 0.0, (rest**2).sum(axis=0))


@dataclass(frozen=True)
class Test:
    """Standard errors of a fit with its tau taken as known, and p-values, as of an ordinary linear model."""

    se_a_s: float
    se_b_s: Sequence[float]
    p_a: float
    p_b: Sequence[float]
    r_squared: float

    @property
    def largest_p(self) -> float:
        return max(self.p_a, *self.p_b)


def t_test(shape: Shape, before_s: FloatArray, group: IntArray, outcome_s: FloatArray, fitted: Fitted) -> Test:
    """Return the t-tests of one fit; cycles count as independent, as in the paper."""
    from scipy.stats import t as student

    mean_f, f = _centred(shape(before_s, fitted.tau_s[:1]).T, group)
    square = max(float((f * f).sum()), 1e-12)
    counts = np.bincount(group)
    freedom = len(before_s) - len(counts) - 1
    variance = float(fitted.rss[0]) / max(freedom, 1)
    se_a = np.sqrt(variance / square)
    se_b = np.sqrt(variance * (1.0 / counts + mean_f[:, 0] ** 2 / square))
    total = float(((outcome_s - outcome_s.mean()) ** 2).sum())

    def p(value: float, error: float) -> float:
        if freedom < 1:
            return 1.0
        return float(2.0 * student.sf(abs(value) / error, freedom)) if error > 0.0 else float(value == 0.0)

    return Test(
        float(se_a),
        [float(e) for e in se_b],
        p(float(fitted.a_s[0]), float(se_a)),
        [p(float(b), float(e)) for b, e in zip(fitted.b_s[:, 0], se_b, strict=True)],
        1.0 - float(fitted.rss[0]) / total if total > 0.0 else 0.0,
    )
