"""What chance gives: gains where no effect is true, and choices were other cycles or days recorded."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from waxstudy.diagnosis.criteria import Question, limit
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.observations.partition import FIT, SELECT
from waxstudy.diagnosis.residuals.noise_floor import NoiseFloor
from waxstudy.diagnosis.select.candidate import Candidate
from waxstudy.plugin import FloatArray

DRAWS = 400


def null(
    current: Hypothesis, best: Hypothesis, fitted: Sequence[Hypothesis], floor: NoiseFloor, random: np.random.Generator
) -> FloatArray:
    """Return the highest gain over the effects, in draws in which none is true.

    What the best of them leaves is noise and discrepancy; its blocks are drawn with random signs (wild bootstrap, Wu
    1986, doi:10.1214/aos/1176350142), with the floor's noise, and each effect is fitted along the direction in which it
    moved the prediction.
    """
    rest, part, block = whole(best)
    now = current.whitened
    ways = np.array([now - each.whitened for each in fitted])
    first, second = part == FIT, part == SELECT
    power_1 = np.maximum(np.sum(ways[:, first] ** 2, axis=1), 1e-12)
    power_2 = np.sum(ways[:, second] ** 2, axis=1)
    along_1 = by_block(ways * (rest * first), block)
    along_2 = by_block(ways * (rest * second), block)
    signs = random.choice((-1.0, 1.0), (along_1.shape[1], DRAWS))
    noise = max(floor.white.values(), default=0.0) * random.normal(size=(2, len(ways), DRAWS))
    first_part = along_1 @ signs + noise[0] * np.sqrt(power_1)[:, None]
    second_part = along_2 @ signs + noise[1] * np.sqrt(power_2)[:, None]
    size = np.maximum(first_part / power_1[:, None], 0.0)
    gains = 2.0 * size * second_part - size**2 * power_2[:, None]
    return np.asarray(gains.max(axis=0))


def inclusion(
    group: tuple[str, ...], candidates: Sequence[Candidate], current: Hypothesis, random: np.random.Generator
) -> float:
    """Return how often one of the group would be chosen again, were other cycles or days recorded."""
    base, part, block = whole(current)
    seen = (part == FIT) | (part == SELECT)
    loss = by_block(np.array([c.fitted.whitened[seen] ** 2 for c in candidates]), block[seen])
    count = loss.shape[1]
    # what the drive's noise adds is spread evenly
    loss += np.array([[(c.evidence.loss - own.sum()) / count] for c, own in zip(candidates, loss, strict=True)])
    gains = (by_block(base[None, seen] ** 2, block[seen]) - loss) @ redrawn(count, DRAWS, random).T
    names, least = [c.effect.name for c in candidates], limit(Question.CLAIM, "gain_per_form", candidates[0].evidence)
    chosen = [names[best] in group for best in np.argmax(gains, axis=0)]
    return float(np.mean(np.array(chosen) & (gains.max(axis=0) > least * candidates[0].evidence.form_share)))


def whole(fitted: Hypothesis) -> tuple[FloatArray, np.ndarray, np.ndarray]:
    """Return whitened residual, parts and blocks of all channels, one after the other."""
    residual = fitted.residuals
    return (
        fitted.whitened,
        np.concatenate([each.part for each in residual]),
        np.concatenate([each.block for each in residual]),
    )


def by_block(values: FloatArray, block: np.ndarray) -> FloatArray:
    """Return the sums of each row (k, m) over its blocks (k, blocks)."""
    numbers, member = np.unique(block, return_inverse=True)
    return np.array([np.bincount(member, weights=row, minlength=len(numbers)) for row in values])


def redrawn(count: int, draws: int, random: np.random.Generator) -> np.ndarray:
    """Return how often each of some blocks is drawn (draws, count), as many each time as there are."""
    return random.multinomial(count, np.full(count, 1.0 / count), draws)
