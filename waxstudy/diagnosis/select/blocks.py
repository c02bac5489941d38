"""Whole cycles or days of a record: sums over each, and each drawn again."""

from __future__ import annotations

import numpy as np

from waxstudy.plugin import FloatArray


def by_block(values: FloatArray, block: np.ndarray) -> FloatArray:
    """Return the sums of each row (k, m) over its blocks (k, blocks)."""
    numbers, member = np.unique(block, return_inverse=True)
    return np.array([np.bincount(member, weights=row, minlength=len(numbers)) for row in values])


def redrawn(count: int, draws: int, random: np.random.Generator) -> np.ndarray:
    """Return how often each of some blocks is drawn (draws, count), as many each time as there are."""
    return random.multinomial(count, np.full(count, 1.0 / count), draws)
