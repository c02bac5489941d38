"""What speaks for each hypothesis of a link, as numbers, and how probable that makes them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.diagnosis.criteria import LIMITS, Limits

LIKELIER = 0.5
UNKNOWN = "unknown"
NONE = "none"


@dataclass(frozen=True)
class Evidence:
    """What speaks for a hypothesis, as logarithms of likelihood where nothing else is said."""

    effects: tuple[str, ...]  # in the order in which they were added
    names: tuple[str, ...]  # of those that are large enough to be worth a name, in alphabetical order
    gain: float  # over nothing, by what is missed
    ease: float  # the same by how far the room need not depart
    always: float  # how much likelier the healthy record would be, had it been so from the start
    misfit: float  # what it leaves beyond what healthy records do, in standard deviations
    price: float  # of its parameters, and that anything of the kind happens
    spread: float  # variance of the gain from day to day or cycle to cycle, over that which independent errors have
    most: float  # gain that so many days or cycles can tell at all
    left: float = 1.0  # share of what is missed beyond what nothing amiss leaves
    stands: float = np.inf  # how far what is missed without the last effect stands out, in standard deviations
    of_room: bool = False

    @property
    def score(self) -> float:
        """What speaks for a hypothesis by itself, with nothing unknown beside it."""
        gain = self.gain / self.spread + self.ease - max(0.0, self.always)
        return gain - 0.5 * self.misfit**2 - self.price


def posterior(found: Sequence[Evidence], limits: Limits = LIMITS) -> dict[str, float]:
    """Return the probability of each hypothesis of a link, with something unknown beside it or not; they sum to 1.

    The first is that nothing differs. What was so from the start is no change.
    """
    best = max(found, key=lambda each: each.score)
    logs: dict[str, float] = {}
    for each, gain in zip(found, _gains(found, best, limits), strict=True):
        _add(logs, each.names, gain - max(0.0, each.always) - each.price, each.misfit, limits)
        if len(each.effects) == 1:
            _raise(logs, UNKNOWN, _mimicked(each, gain, limits))
        if each.always > 0.0:
            _add(logs, (), gain - each.price, each.misfit, limits)
    most = max(logs.values())
    weights = {name: float(np.exp(value - most)) for name, value in logs.items()}
    whole = sum(weights.values())
    return {name: weight / whole for name, weight in weights.items()}


def _mimicked(each: Evidence, gain: float, limits: Limits) -> float:
    """Return what speaks for something unknown that looks like an effect: the less likely the more alike."""
    freedom = each.price + float(np.log(limits.prior))  # of its parameters, and of when it acts
    return gain - max(0.0, each.always) - freedom + limits.alike * float(np.log(each.left)) - limits.unknown_price


def _gains(found: Sequence[Evidence], best: Evidence, limits: Limits) -> list[float]:
    """Return what speaks for each hypothesis; more cannot outdo less by more than what stands out without it."""
    gains = [each.gain / (best.spread if best.names else each.spread) + each.ease for each in found]
    order = sorted(range(len(found)), key=lambda place: -len(found[place].effects))
    for place in order:
        each = found[place]
        if best.names and not each.names:
            # days and cycles can speak against it only so much
            gains[place] = max(gains[place], best.gain / best.spread - best.most)
        more = [
            gains[n] - limits.sure * other.stands**2
            for n, other in enumerate(found)
            if other.effects and other.effects[:-1] == each.effects
        ]
        gains[place] = max([gains[place], *more])
    return _with_peers(found, gains, limits)


def _with_peers(found: Sequence[Evidence], gains: Sequence[float], limits: Limits) -> list[float]:
    """Return what speaks for each: of single effects of a chain one that leaves nothing amiss is outdone by little.

    A finer name must be earned: real motors have no form of the library exactly.
    """
    singles = [place for place, each in enumerate(found) if len(each.effects) == 1 and not each.of_room]
    most = max((gains[place] for place in singles), default=0.0)
    least = {place: most - limits.unknown_price - limits.sure * found[place].misfit ** 2 for place in singles}
    return [max(gain, least.get(place, gain)) for place, gain in enumerate(gains)]


def _add(logs: dict[str, float], names: Sequence[str], value: float, misfit: float, limits: Limits) -> None:
    """Take a hypothesis in, with something unknown beside it and without; of several the best counts."""
    pairs = (("+".join(names) or NONE, 0.5 * misfit**2), ("+".join((*names, UNKNOWN)), limits.unknown_price))
    for key, price in pairs:
        _raise(logs, key, value - price)


def _raise(logs: dict[str, float], key: str, value: float) -> None:
    logs[key] = max(logs.get(key, -np.inf), value)
