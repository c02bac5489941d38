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


def told_apart(better: FloatArray, worse: FloatArray) -> float:
    """Return the most that cycles tell between two hypotheses, from the squares that each leaves of them (cycles,).

    Neither holds the other: what tells is how far their difference stands out of its own scatter (Vuong 1989,
    doi:10.2307/1912557), as the logarithm of Student's t that so many cycles give.
    """
    each = 0.5 * (worse - better)
    count, scatter = len(each), float(np.sum((each - each.mean()) ** 2)) if len(each) else 0.0
    if not scatter:
        return np.inf if count > 1 and each[0] > 0.0 else 0.0
    t_2 = max(0.0, float(each.sum())) ** 2 / scatter * (count - 1) / count
    return 0.5 * count * float(np.log1p(t_2 / (count - 1)))
