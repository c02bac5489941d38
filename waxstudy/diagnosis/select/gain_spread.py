"""How far a gain of likelihood is one of all days or cycles, and not of a few."""

from __future__ import annotations

import numpy as np

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
    if count < 2:
        return 1.0, 0.0
    off = along - along.sum() / whole * power
    # switches that agree by rounding tell no more than noise lets them
    spread = max(1.0, float(off @ off) / whole)
    t_2 = float(along.sum()) ** 2 / (spread * whole) * (count - 1) / count
    return spread, 0.5 * count * float(np.log1p(t_2 / (count - 1)))
