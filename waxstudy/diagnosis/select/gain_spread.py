"""How far a gain of likelihood is one of all days or cycles, and not of a few."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray


def gain_spread(before: FloatArray, after: FloatArray, block: np.ndarray) -> tuple[float, float]:
    """Return how much more than independent errors a gain varies over blocks, and the most that they can tell.

    Of whitened residuals (m,) without and with an effect, and the day or cycle of each. A gain that only few of them
    give is no effect's: the sandwich variance of its size (White 1980, doi:10.2307/1912934), and the logarithm of
    Student's t that so many give.
    """
    change = before - after
    _, member = np.unique(block, return_inverse=True)
    along, power = np.bincount(member, before * change), np.bincount(member, change * change)
    count, whole = int(np.count_nonzero(power)), float(power.sum())
    if count < 2 or whole <= 0.0:
        return 1.0, 0.0
    off = along - along.sum() / whole * power
    # switches that agree by rounding tell no more than noise lets them
    spread = max(1.0, float(off @ off) / whole)
    t_2 = float(along.sum()) ** 2 / (spread * whole) * (count - 1) / count
    return spread, 0.5 * count * float(np.log1p(t_2 / (count - 1)))


@dataclass(frozen=True)
class Uneven:
    """How an effect does more at some times than at others; `times` counts the courses that were looked at."""

    apart: float = 0.0  # standard deviations by which its strengths then and else differ, the looking paid for
    gain: float = 0.0  # of likelihood, with a strength for either, as far as days or cycles tell it
    times: int = 0


def unevenness(before: FloatArray, after: FloatArray, block: np.ndarray, times: Sequence[np.ndarray]) -> Uneven:
    """Return the course along which an effect is the least even.

    Of whitened residuals (m,) without and with it, the day or cycle of each, and when each course holds (m,). Strengths
    within and beyond a course have the variance that blocks of either give; a share may be left by the effect's form.
    """
    change = before - after
    least = WEIGHTS.least_power * float(change @ change)
    told = [each for each in times if all(float(change[part] @ change[part]) > least for part in (each, ~each))]
    found = [_uneven(after, change, block, within) for within in told]
    if not found:
        return Uneven()
    most = max(found, key=lambda each: each.apart)
    apart = float(np.sqrt(max(0.0, most.apart**2 - 2.0 * np.log(len(found)))))
    return replace(most, apart=apart, times=len(found)) if apart else Uneven(times=len(found))


def _uneven(after: FloatArray, change: FloatArray, block: np.ndarray, within: np.ndarray) -> Uneven:
    strengths: list[float] = []
    variance, gain = 2.0 * WEIGHTS.form**2, 0.0
    for part in (within, ~within):
        _, member = np.unique(block[part], return_inverse=True)
        along, power = (np.bincount(member, each * change[part]) for each in (after[part], change[part]))
        whole = float(power.sum())
        more = float(along.sum()) / whole
        off = along - more * power
        spread = max(1.0, float(off @ off) / whole)
        # an effect may do nothing, or more than always, but not the opposite
        strength = min(max(1.0 + more, 0.0), WEIGHTS.strongest)
        strengths.append(strength)
        variance += spread / whole
        gain += strength * (1.0 + more - 0.5 * strength) * whole / spread
    return Uneven(abs(strengths[0] - strengths[1]) / variance**0.5, gain)
