"""How far a gain of likelihood is one of all days or cycles, and not of a few."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from waxstudy.plugin import FloatArray


class Strength(NamedTuple):
    """How much of an effect cycles have, as a mean square over its own, and how many cycles tell it."""

    square: float
    cycles: float


def along_change(errors: FloatArray, change: FloatArray, block: np.ndarray) -> tuple[FloatArray, FloatArray]:
    """Return by block how far errors (m,) lie along a change (m,), and the squares of that change, each (blocks,)."""
    _, member = np.unique(block, return_inverse=True)
    along, power = np.bincount(member, errors * change), np.bincount(member, change * change)
    return np.asarray(along, dtype=float), np.asarray(power, dtype=float)


def strength(before: FloatArray, after: FloatArray, block: np.ndarray, is_lasting: bool = False) -> Strength | None:
    """Return how much of an effect cycles have, from what is left (m,) without and with it; None if nothing changes.

    Of what is to last the cycle of most is left out: what happened once may be chance.
    """
    change = before - after
    along, power = along_change(before, change, block)
    squares = np.divide(along**2, power, out=np.zeros(len(along)), where=power > 0.0)
    if is_lasting and len(squares) > 1:
        most = np.argmax(squares)
        squares, power = np.delete(squares, most), np.delete(power, most)
    whole = float(power.sum())
    return Strength(float(squares.sum()) / whole, whole**2 / float(power @ power)) if whole else None


def gain_spread(before: FloatArray, after: FloatArray, block: np.ndarray) -> tuple[float, float]:
    """Return how much more than independent errors a gain varies over blocks, and the most that they can tell.

    Of whitened residuals (m,) without and with an effect, and the day or cycle of each. A gain that only few of them
    give is no effect's: the sandwich variance of its size (White 1980, doi:10.2307/1912934), and the logarithm of
    Student's t that so many give.
    """
    change = before - after
    along, power = along_change(before, change, block)
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
