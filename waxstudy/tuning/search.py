"""The search: a landscape on a grid, and differential evolution (Storn and Price 1997, by scipy) around its best.

It is the same search for the same seed: interrupted, it asks for the same settings again and finds them computed.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import Bounds, differential_evolution
from scipy.stats import qmc

from waxstudy.plugin import FloatArray
from waxstudy.tuning.evaluate import Settings
from waxstudy.tuning.space import Axis

LANDSCAPE = 0.4  # of the budget: the grid is a search as well, and shows that nothing better lies elsewhere
PER_AXIS = 6  # members of a generation for each parameter
LEAST_GENERATION, LEAST_GENERATIONS = 5, 4  # what differential evolution needs
ALIKE = 0.005  # a generation whose scores differ by less than this share is the end


@dataclass(frozen=True)
class Budget:
    """How many settings are evaluated, and for what."""

    side: int  # of the grid over the first two parameters
    generation: int
    generations: int

    @classmethod
    def of(cls, count: int, axes: int) -> Budget:
        """Share a number of evaluations out; the case as it stands is one of them."""
        over = min(axes, 2)
        side = int((LANDSCAPE * count) ** (1.0 / over))
        rest = count - side**over
        generation = max(LEAST_GENERATION, min(PER_AXIS * axes, rest // LEAST_GENERATIONS))
        return cls(side, generation, rest // generation)


def landscape(axes: Sequence[Axis], start: Settings, side: int) -> list[dict[str, float]]:
    """Return settings on a grid over the first two parameters, the others as they stand."""
    shares = np.linspace(0.0, 1.0, side)
    own = {axis.key: start[axis.key] for axis in axes}
    over = axes[:2]
    return [
        {**own, **{axis.key: axis.at(float(share)) for axis, share in zip(over, at, strict=True)}}
        for at in itertools.product(shares, repeat=len(over))
    ]


def search(
    axes: Sequence[Axis],
    best: Settings,
    budget: Budget,
    seed: int,
    scores: Callable[[Sequence[dict[str, float]]], FloatArray],
) -> None:
    """Look for the settings of the least score around the best of the landscape, which its grid may have missed.

    It begins within one step of the grid, and may go anywhere within the bounds. What is evaluated is known to
    `scores`; inf is for what cannot be had.
    """

    def at(places: FloatArray) -> FloatArray:
        return scores([{axis.key: axis.at(float(x)) for axis, x in zip(axes, row, strict=True)} for row in places.T])

    middle = np.array([axis.share(best[axis.key]) for axis in axes])
    # parameters that the grid leaves as they stand are looked for everywhere
    reach = np.array([1.0 / (budget.side - 1) if place < 2 else 1.0 for place in range(len(axes))])
    drawn = qmc.LatinHypercube(len(axes), rng=seed).random(budget.generation)
    spread = np.clip(middle + reach * (2.0 * drawn - 1.0), 0.0, 1.0)
    spread[0] = middle
    scores_of: Any = at  # vectorised: one for each column, of which the library's types know nothing
    differential_evolution(
        scores_of,
        bounds=Bounds(np.zeros(len(axes)), np.ones(len(axes))),
        init=spread,
        maxiter=budget.generations - 1,
        tol=ALIKE,
        rng=seed,
        polish=False,
        updating="deferred",
        vectorized=True,
    )
