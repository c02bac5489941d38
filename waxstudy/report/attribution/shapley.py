"""Shapley values over the sets of steps that make sense.

    share(i) = sum over S of w(S, i) (v(S + i) - v(S)),   w = share of all orders in which i comes right after S

Orders are those that lead from no step to all of them through sets of the family alone. Where every set makes sense,
w = |S|! (n - |S| - 1)! / n! (Shapley 1953); under precedence constraints it is the mean over all orders that keep
them (Faigle and Kern 1992, Int. J. Game Theory 21, 249-266).

Means over other orders come from the JSON of `waxstudy report RUN --attribution`, here those with P_MC before P_WM:

    for of in json.load(open("attribution.json"))["attribution"]:
        if of["ladder"] == "pi":
            mae_K = {frozenset(chosen["steps"]): chosen["mae_K"] for chosen in of["sets"]}
            sensible = [steps for steps in mae_K if "P_WM" not in steps or "P_MC" in steps]
            print(of["week"], order_count(sensible), shapley(placements(sensible), mae_K))
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

from waxstudy.plugin import FloatArray

Subset = frozenset[int]  # places of steps in the ladder, from 0


@dataclass(frozen=True)
class Placement:
    """A step taken right after a set of others, and the share of all orders in which that happens."""

    after: Subset
    step: int
    weight: float

    def marginal(self, values: Mapping[Subset, FloatArray]) -> FloatArray:
        """Return what the step adds there."""
        return values[self.after | {self.step}] - values[self.after]


def closed_sets(needs: Sequence[Subset]) -> list[Subset]:
    """Return every set that holds, with each step, the steps that it needs; small sets first."""
    steps = range(len(needs))
    every = (frozenset(chosen) for size in range(len(needs) + 1) for chosen in combinations(steps, size))
    return [chosen for chosen in every if all(needs[step] <= chosen for step in chosen)]


def order_count(family: Collection[Subset]) -> int:
    """Return the number of orders that lead through the sets of the family from none to all."""
    return _ways_up(family)[max(family, key=len)]


def placements(family: Collection[Subset]) -> list[Placement]:
    """Return every place that a step can take in an order; raise `ValueError` where there is no order at all."""
    up, everything = _ways_up(family), max(family, key=len)
    # the ways from a set to all steps are the ways up in the family of complements
    down = {everything - chosen: ways for chosen, ways in _ways_up([everything - s for s in family]).items()}
    if not up[everything]:
        raise ValueError("no order of the steps leads from none to all of them")
    found = (
        Placement(after, step, up[after] * down[after | {step}] / up[everything])
        for after in up
        for step in sorted(everything - after)
        if after | {step} in up
    )
    return [place for place in found if place.weight]


def _ways_up(family: Collection[Subset]) -> dict[Subset, int]:
    """The number of orders that lead from no step to each set of the family."""
    ways: dict[Subset, int] = {}
    for chosen in sorted(family, key=lambda s: (len(s), sorted(s))):
        ways[chosen] = sum(ways.get(chosen - {step}, 0) for step in chosen) if chosen else 1
    return ways


def shapley(places: Iterable[Placement], values: Mapping[Subset, FloatArray]) -> dict[int, FloatArray]:
    """Return each step's share of `values` of all steps minus that of none, one per member as the values are."""
    shares: dict[int, FloatArray] = {}
    for place in places:
        part = place.weight * place.marginal(values)
        shares[place.step] = shares[place.step] + part if place.step in shares else part
    return dict(sorted(shares.items()))
