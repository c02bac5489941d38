"""Which effects are named, by the probabilities of hypotheses; those of a link, and of the whole loop."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from waxstudy.diagnosis.criteria import LIMITS
from waxstudy.diagnosis.select.evidence import LIKELIER, NONE, UNKNOWN

LEAST_TOLD = 1e-4  # of a joint hypothesis


@dataclass(frozen=True)
class Choice:
    """The effects that are named, each with those that may stand in its place, itself first."""

    groups: tuple[tuple[str, ...], ...]

    @classmethod
    def of(cls, beliefs: Mapping[str, float]) -> Choice:
        """Return the answer of least expected cost: nothing where that is likelier, names, or the smallest groups."""
        sets: dict[frozenset[str], float] = {}
        for name, probability in beliefs.items():
            effects = frozenset(name.split("+")) - {NONE, UNKNOWN}
            sets[effects] = sets.get(effects, 0.0) + probability
        if sets.get(frozenset(), 0.0) > 1.0 - LIMITS.named:
            return cls(())
        best = max((each for each in sets if each), key=lambda each: sets[each])
        groups = [_group(name, best, sets) for name in sorted(best)]
        return cls(tuple(group for group in groups if group))


def _group(name: str, best: frozenset[str], sets: Mapping[frozenset[str], float]) -> tuple[str, ...]:
    """Return an effect and what may stand in its place, the likeliest first; nothing where it may as well not be."""
    rest = best - {name}
    held = sum(probability for effects, probability in sets.items() if name in effects)
    if held >= LIMITS.named:
        return (name,)
    if rest and held < LIKELIER:
        return ()
    instead: dict[str, float] = {}
    for effects, probability in sets.items():
        others = effects - rest
        if rest <= effects and len(others) == 1:
            (other,) = others
            instead[other] = instead.get(other, 0.0) + probability
    chosen, sum_, all_ = [name], instead.pop(name, 0.0), sum(instead.values())
    whole = sum_ + all_
    for other in sorted(instead, key=lambda each: -instead[each]):
        if sum_ >= LIMITS.credible * whole:
            break
        chosen.append(other)
        sum_ += instead[other]
    return tuple(chosen)


def joint(links: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the probability of each hypothesis of the whole loop, whose links are independent; they sum to 1."""
    found: dict[frozenset[str], float] = {frozenset(): 1.0}
    for link in links:
        more: dict[frozenset[str], float] = {}
        for names, probability in found.items():
            for name, own in link.items():
                both = names | (frozenset(name.split("+")) - {NONE})
                more[both] = more.get(both, 0.0) + probability * own
        found = {names: probability for names, probability in more.items() if probability >= LEAST_TOLD}
    whole = sum(found.values())
    told = {_joined(names): probability / whole for names, probability in found.items()} if links else {}
    return dict(sorted(told.items(), key=lambda each: -each[1]))


def _joined(names: frozenset[str]) -> str:
    known = sorted(names - {UNKNOWN})
    return "+".join([*known, UNKNOWN] if UNKNOWN in names else known) or NONE


def without(beliefs: Mapping[str, float], blurred: set[str]) -> dict[str, float]:
    """Return probabilities where effects that may as well be what is believed are none."""
    found: dict[str, float] = {}
    for name, probability in beliefs.items():
        rest = [each for each in name.split("+") if each not in blurred]
        key = "+".join(rest) or NONE
        found[key] = found.get(key, 0.0) + probability
    return found
