"""What a room does by itself, as autoregressive errors: whitening, and fits that single events do not bend."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from waxstudy.diagnosis.neighbours.limits import FEWEST_STEPS, FLOOR_K, HUBER, ORDER
from waxstudy.plugin import FloatArray

ROUNDS = 4  # of fitting in turn, which by then move nothing
MAD = 1.4826  # of a normal distribution: its standard deviation over its median distance from the middle
RIDGE = 1e-6  # of a regressor's own square: only keeps the solution finite


@dataclass(frozen=True)
class Errors:
    """Autoregressive errors: what is left at a step is a sum of those before it, and an innovation."""

    weights: FloatArray  # (ORDER,)
    sd_K: FloatArray  # (n,) spread of the innovations, by the regime of each step

    def innovations(self, values: FloatArray) -> FloatArray:
        """Return the innovations of a course (n, ...) along its first axis; NaN where a step before is not known."""
        found = np.array(values, dtype=float)
        for back, weight in enumerate(self.weights, 1):
            found[back:] -= weight * values[:-back]
        found[: len(self.weights)] = np.nan
        return found

    def of_shape(self, shape: FloatArray) -> FloatArray:
        """Return the innovations of a shape (n, ...) with nothing before it."""
        before = np.zeros((len(self.weights), *shape.shape[1:]))
        return self.innovations(np.concatenate((before, shape)))[len(before) :]


@dataclass(frozen=True)
class Fit:
    """A room's air by its regressors (n, p), with the errors that they leave."""

    coefficients: FloatArray  # (p,)
    covariance: FloatArray  # (p, p)
    left_K: FloatArray  # (n,)
    errors: Errors
    white: FloatArray  # (n,) innovations over their spread; 0 where unknown
    basis: FloatArray  # (n, p) orthonormal, of the regressors' innovations over that spread; 0 where unknown
    known: np.ndarray  # (n,) whether there is an innovation


def fitted(air_C: FloatArray, regressors: FloatArray, regimes: np.ndarray) -> Fit:
    """Return regressors (n, p) fitted to a room's air (n,) [C], robustly, in turn with the errors that they leave.

    `regimes` (n,) are numbers of the kinds of hours that a room is differently restless in.
    """
    errors = Errors(np.array([0.9, *[0.0] * (ORDER - 1)]), np.ones(len(air_C)))
    for _ in range(ROUNDS):
        rows, target, known = _rows(air_C, regressors, errors)
        coefficients = huber(rows, target)
        errors = _errors(air_C - regressors @ coefficients, regimes)
    rows, target, known = _rows(air_C, regressors, errors)
    white, basis = np.zeros(len(air_C)), np.zeros(regressors.shape)
    white[known], basis[known] = target - rows @ coefficients, np.asarray(np.linalg.qr(rows)[0], dtype=float)
    covariance = np.asarray(np.linalg.inv(rows.T @ rows + _ridge(rows)), dtype=float)
    return Fit(coefficients, covariance, air_C - regressors @ coefficients, errors, white, basis, known)


def _rows(air_C: FloatArray, regressors: FloatArray, errors: Errors) -> tuple[FloatArray, FloatArray, np.ndarray]:
    rows, target = errors.innovations(regressors) / errors.sd_K[:, None], errors.innovations(air_C) / errors.sd_K
    known = np.isfinite(target) & np.isfinite(rows).all(axis=1)
    return rows[known], target[known], known


def huber(rows: FloatArray, target: FloatArray) -> FloatArray:
    """Return the coefficients (p,) of least squares in which outliers count by less (Huber 1964)."""
    weights: FloatArray = np.ones(len(target))
    found: FloatArray = np.zeros(rows.shape[1])
    ridge = _ridge(rows)
    for _ in range(2 * ROUNDS):
        weighted = rows * weights[:, None]
        found = np.asarray(np.linalg.solve(weighted.T @ rows + ridge, weighted.T @ target), dtype=float)
        left = target - rows @ found
        weights = np.asarray(HUBER / np.maximum(np.abs(left) / max(spread(left), FLOOR_K * FLOOR_K), HUBER))
    return found


def _ridge(rows: FloatArray) -> FloatArray:
    return np.asarray(RIDGE * np.diag(np.sum(rows**2, axis=0) + RIDGE))


def spread(values: FloatArray) -> float:
    """Return the standard deviation that a normal distribution of this median distance from the middle has."""
    return float(MAD * np.median(np.abs(values - np.median(values))))


def _errors(left: FloatArray, regimes: np.ndarray) -> Errors:
    """Return the autoregression of what is left (n,), robustly, with a spread for each regime."""
    lagged = np.column_stack([np.concatenate((np.full(k, np.nan), left[:-k])) for k in range(1, ORDER + 1)])
    known = np.isfinite(left) & np.isfinite(lagged).all(axis=1)
    weights = huber(lagged[known], left[known])
    innovations = left - lagged @ weights
    sd_K = np.full(len(left), max(FLOOR_K, spread(innovations[known])))
    for regime in np.unique(regimes):
        among = known & (regimes == regime)
        if among.sum() >= FEWEST_STEPS:
            sd_K[regimes == regime] = max(FLOOR_K, spread(innovations[among]))
    return Errors(weights, sd_K)
