"""What the form of a model leaves of a healthy building, as a covariance in time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray

STEPS_MOST = 400  # of the search for a discrepancy


@dataclass(frozen=True)
class Discrepancy:
    """An error that hangs together over time, and one that does not.

    Covariance of two means that lie t apart: sd_K² exp(-t / length_s), plus noise_K² at t = 0 (an Ornstein-Uhlenbeck
    process; Kennedy and O'Hagan 2001, doi:10.1111/1467-9868.00294, call it model discrepancy).
    `shared` says how many channels tell the same: each counts by that less.
    """

    sd_K: float
    length_s: float
    noise_K: float
    shared: float = 1.0

    @property
    def rms_K(self) -> float:
        return float(np.hypot(self.sd_K, self.noise_K))

    def whitened(self, error: FloatArray, known: np.ndarray, step_s: float) -> FloatArray:
        """Return the innovations (n,) of means over steps over their standard deviations, 0 where nothing is known."""
        found, _ = _innovations(error, known, self.sd_K, self.length_s / step_s, self.noise_K)
        return np.asarray(found / self.shared**0.5)

    @classmethod
    def of(cls, error: FloatArray, known: np.ndarray, step_s: float, least_K: float) -> Discrepancy:
        """Return what is likeliest to have left an error (n,) of means over steps, its noise at least `least_K`.

        The prior is a factor of e wide around what is missed: a few days say little of what hangs together for days.
        """
        from scipy.optimize import minimize

        def loss(x: FloatArray) -> float:
            sd, length, noise = np.exp(x)
            white, log_sd = _innovations(error, known, sd, length, float(np.hypot(noise, least_K)))
            return float(white @ white + 2.0 * log_sd) + float(np.sum((x - start) ** 2))

        rms_K = float(np.sqrt(np.mean(error[known] ** 2))) if known.any() else 0.0
        expected_K = max(least_K, rms_K)
        start = np.log([expected_K, WEIGHTS.expected_s / step_s, 0.3 * expected_K])
        found = minimize(loss, start, method="Nelder-Mead", options={"maxfev": STEPS_MOST, "xatol": 1e-3})
        sd, length, noise = np.exp(found.x)
        return cls(float(sd), float(length) * step_s, float(np.hypot(noise, least_K)))


@njit(cache=True)  # type: ignore[untyped-decorator]
def _innovations(
    error: FloatArray, known: np.ndarray, sd: float, length: float, noise: float
) -> tuple[FloatArray, float]:
    """Return the innovations over their standard deviations, and the sum of the logarithms of these (Kalman filter)."""
    found = np.zeros(len(error))
    kept, power = np.exp(-1.0 / length), sd * sd
    mean, variance, log_sd = 0.0, sd * sd, 0.0
    for place in range(len(error)):
        if known[place]:
            spread = variance + noise * noise
            missed = error[place] - mean
            found[place] = missed / np.sqrt(spread)
            log_sd += 0.5 * np.log(spread)
            gain = variance / spread
            mean += gain * missed
            variance *= 1.0 - gain
        mean *= kept
        variance = kept * kept * variance + (1.0 - kept * kept) * power
    return found, log_sd
