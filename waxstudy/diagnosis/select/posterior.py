"""How probable each hypothesis of a link is: what speaks for each, weighed against the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from waxstudy.diagnosis.criteria import limits
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.select.gain_spread import told_apart
from waxstudy.diagnosis.select.instruments import OffBy
from waxstudy.diagnosis.select.patterns import Pattern
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray

UNKNOWN = "unknown"
NONE = "none"


@dataclass(frozen=True)
class Weighed:
    """A hypothesis of one link: its effects as fitted, and what speaks for it, as logarithms."""

    fitted: Hypothesis
    names: tuple[str, ...]  # of its effects that are large enough to be worth a name, in alphabetical order
    gain: float  # of likelihood over that of nothing, by what is missed
    ease: float  # the same by how far the room need not depart
    always: float  # how much likelier the healthy record would be, had it been so from the start
    misfit: float  # what it leaves beyond what healthy records do, in standard deviations
    price: float  # of its parameters, and that anything of the kind happens
    spread: float  # variance of the gain from day to day or cycle to cycle, over that which independent errors have
    most: float  # gain that so many days or cycles can tell at all
    by_cycle: FloatArray = field(compare=False)  # squares that it leaves of each cycle of a chain (cycles,)
    unlike: float = 0.0  # how much less likely the later record is then: the healthy one would have taught otherwise
    left: float = 1.0  # share of what is missed beyond what nothing amiss leaves
    is_of_room: bool = False
    is_by_noise: bool = False  # whether nothing but noise, and no healthy record, tells what is usual
    stands: float = np.inf  # how far what is missed without it stands out where it acts, in standard deviations
    pattern: Pattern | None = None  # where it does not act always
    strength: float = 1.0  # of its effect then, over that which suits all of the record best
    off_by: OffBy | None = None  # the instrument that would explain most of what it leaves


def score(weighed: Weighed) -> float:
    """Return the logarithm of what speaks for a hypothesis by itself, with nothing unknown beside it."""
    return (
        weighed.gain / weighed.spread
        + weighed.ease
        - max(0.0, weighed.always)
        - 0.5 * weighed.misfit**2
        - weighed.price
    )


def posterior(found: Sequence[Weighed], soft: float | None = None, unseen: float | None = None) -> dict[str, float]:
    """Return the probability of each hypothesis of a link, with something unknown beside it or not; they sum to 1.

    The first is that nothing changed. What was so from the start is no change. `python -m benchmarks.posterior` asks
    for other values of what is learned.
    """
    best = _best(found)
    gains = _gains(found, best)
    logs: dict[str, float] = {}
    for each, own, gain in zip(found, gains, _with_peers(found, gains), strict=True):
        _add(logs, each.names, gain - max(0.0, each.always) - each.price, each.misfit)
        if each.off_by:  # counts by itself: how little days tell against nothing speaks for no instrument
            told = _told(each, best) + each.off_by.told - max(0.0, each.always) - each.price
            _raise(logs, (*each.names, UNKNOWN), told - WEIGHTS.unknown_price)
        if each.fitted.effects:
            _raise(logs, (UNKNOWN,), _mimicked(each, own))
        if each.always > 0.0:
            _add(logs, (), gain - each.unlike - each.price, each.misfit)
    most, power = max(logs.values()), WEIGHTS.softness(found[0].is_by_noise) if soft is None else soft
    weights = {name: float(np.exp((value - most) / power)) for name, value in logs.items()}
    whole = sum(weights.values())
    share = WEIGHTS.unseen(found[0].is_of_room) if unseen is None else unseen
    return _with_unseen({name: weight / whole for name, weight in weights.items()}, found, share)


def _best(found: Sequence[Weighed]) -> Weighed:
    """Return the hypothesis that others are held against.

    In a room an effect may act always or on some days: of these the one with the greater gain by the same spread.
    """
    best = max(found, key=score)
    same = [each for each in found if best.names and best.is_of_room and each.fitted.names == best.fitted.names]
    return max(same, key=lambda each: _in_all(each, each.gain / best.spread + each.ease), default=best)


def _with_unseen(beliefs: Mapping[str, float], found: Sequence[Weighed], share: float) -> dict[str, float]:
    """Return probabilities that leave a share of nothing to effects which may be there and would not show."""
    told = dict(beliefs)
    singles = {each.fitted.names[0] for each in found if len(each.fitted.effects) == 1}
    hidden = sorted(name for name in singles if told.get(name, 0.0) < WEIGHTS.least_seen)
    if not hidden or NONE not in told:
        return told
    unseen = told[NONE] * share
    told[NONE] -= unseen
    for name in hidden:
        told[name] = told.get(name, 0.0) + unseen / len(hidden)
    return told


def _mimicked(each: Weighed, gain: float) -> float:
    """Return what speaks for something unknown that looks like effects: the less likely the more alike."""
    freedom = each.price + len(each.fitted.effects) * float(np.log(WEIGHTS.prior))  # of parameters, and of when
    return gain - max(0.0, each.always) - freedom + WEIGHTS.alike * float(np.log(each.left)) - WEIGHTS.unknown_price


def _gains(found: Sequence[Weighed], best: Weighed) -> list[float]:
    """Return what speaks for each hypothesis; more cannot outdo less by more than what stands out without it."""
    gains = [_told(each, best) for each in found]
    order = sorted(range(len(found)), key=lambda place: -len(found[place].fitted.effects))
    for place in order:
        each = found[place]
        if best.names and not each.names:
            # days and cycles can speak against it only so much
            gains[place] = max(gains[place], best.gain / best.spread - best.most)
        more = [
            gains[n] - WEIGHTS.sure * other.stands**2
            for n, other in enumerate(found)
            if _is_within(each.fitted, other.fitted)
        ]
        gains[place] = max([gains[place], *more])
    return gains


def _told(each: Weighed, best: Weighed) -> float:
    """Return what a gain tells, by the spread of the best hypothesis.

    In a room another one comes near the best so, but outdoes it only where it does by its own spread.
    """
    if not best.names:
        return each.gain / each.spread + each.ease
    told = each.gain / best.spread + each.ease
    if not each.is_of_room:
        return told
    level = _in_all(best, best.gain / best.spread + best.ease) - _in_all(each, 0.0)
    return min(told, max(each.gain / each.spread + each.ease, level))


def _in_all(each: Weighed, gain: float) -> float:
    """Return what speaks for a hypothesis with this gain, with something unknown beside it where that excuses more."""
    return gain - max(0.0, each.always) - each.price - min(0.5 * each.misfit**2, WEIGHTS.unknown_price)


def _with_peers(found: Sequence[Weighed], gains: Sequence[float]) -> list[float]:
    """Return what speaks for each: a single effect of a chain outdoes another only so far as cycles tell them apart.

    One that leaves nothing amiss is outdone by little. A finer name must be earned: real motors have no form of the
    library exactly. No effect is raised above what speaks for it against the hypothesis of no change. That hypothesis
    counts as at most `beyond_doubt` behind the best effect, for an effect that leaves nothing amiss.
    """
    singles = [place for place, each in enumerate(found) if len(each.fitted.effects) == 1 and not each.is_of_room]
    if not singles:
        return list(gains)
    best = max(singles, key=lambda place: gains[place])
    told = list(gains)
    for place in singles:
        each = found[place]
        explains_all = _is_peer(each) and each.misfit <= WEIGHTS.open
        nothing = max(gains[0], gains[best] - WEIGHTS.beyond_doubt) if explains_all else gains[0]
        alone = nothing + min(each.most, WEIGHTS.sure * each.stands**2)
        told[place] = max(gains[place], min(gains[best] - _outdone(each, found[best]), alone))
    return told


def _outdone(each: Weighed, best: Weighed) -> float:
    """Return the most by which the best single effect of a chain outdoes another one."""
    most = told_apart(best.by_cycle, each.by_cycle)
    return min(most, WEIGHTS.unknown_price + WEIGHTS.sure * each.misfit**2) if _is_peer(each) else most


def _is_peer(each: Weighed) -> bool:
    """Whether it is a single effect of a chain that takes away most of the squares that are missed."""
    return len(each.fitted.effects) == 1 and each.stands < np.inf and each.left**2 <= limits()["half"].value


def _is_within(one: Hypothesis, other: Hypothesis) -> bool:
    """Whether another hypothesis is one effect on top of this."""
    return bool(other.names) and other.names[:-1] == one.names


def _add(logs: dict[str, float], names: Sequence[str], value: float, misfit: float) -> None:
    """Take a hypothesis in, with something unknown beside it and without; of several the best counts."""
    pairs = (("+".join(names) or NONE, 0.5 * misfit**2), ("+".join((*names, UNKNOWN)), WEIGHTS.unknown_price))
    for key, price in pairs:
        _raise(logs, key.split("+"), value - price)


def _raise(logs: dict[str, float], names: Sequence[str], value: float) -> None:
    key = "+".join(names)
    logs[key] = max(logs.get(key, -np.inf), value)
