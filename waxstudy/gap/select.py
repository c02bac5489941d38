"""Which effects a link of the loop shows: forward selection on days that took no part in the fit, with honest nulls."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.gap.fit import EffectType, Fitted, Fitter, Values
from waxstudy.gap.floor import Floor
from waxstudy.gap.judge import FIT, SELECT
from waxstudy.plugin import Belief, FloatArray

LEVEL = 0.01  # family-wise, over the effects of a link
LEAST_SHARE = 0.5  # of a gap above its floor that an effect must explain
EXPLAINED = 1.5  # what is left over the floor, where nothing else can be in it
LEAST_GAIN = 10.0  # whitened
MOST_EFFECTS = 3
ALIKE = 9.0  # difference of loss at which two effects cannot be told apart, in units of what is left
DRAWS = 400

Tick = Callable[[str], None]


@dataclass(frozen=True)
class Candidate:
    """An effect tried: fitted on the first part, judged on the second."""

    effect: EffectType
    fitted: Fitted
    gain: float  # loss that it takes away on the second part
    p: float  # family-wise
    share: float  # of the gap above the floor, of the channel where it acts most, on the second part
    left: float  # whitened gap that is left of that channel, over its floor
    is_covered: bool  # its departure lies within what the believed model's published uncertainty covers

    @property
    def is_accepted(self) -> bool:
        if self.p > LEVEL or self.gain < LEAST_GAIN or self.share < LEAST_SHARE:
            return False
        return self.left <= EXPLAINED or not self.is_covered


@dataclass(frozen=True)
class Selection:
    """What was found at one link, in order; `fitted` is the last model, `tried` the first round's candidates."""

    fitter: Fitter
    base: Fitted
    fitted: Fitted
    accepted: tuple[Candidate, ...]
    groups: tuple[tuple[str, ...], ...]  # of each accepted effect, its own name first
    inclusion: tuple[float, ...]
    tried: tuple[Candidate, ...]
    floor: Floor


def select(fitter: Fitter, effects: Iterable[EffectType], seed: int, tick: Tick) -> Selection:
    """Add the effects of a link one by one, as long as one of them explains enough of what is left."""
    chosen = [effect for effect in effects if effect.stage in fitter.link.stages]
    current, random = fitter.base, np.random.default_rng(seed)
    accepted: list[Candidate] = []
    groups: list[tuple[str, ...]] = []
    inclusion: list[float] = []
    tried: list[Candidate] = []
    while len(accepted) < MOST_EFFECTS:
        candidates = _tried(fitter, [e for e in chosen if e.name not in current.names], current, random, tick)
        tried = tried or candidates
        best = max((c for c in candidates if c.is_accepted), key=lambda c: c.gain, default=None)
        if best is None:
            break
        group = _group(best, candidates)
        accepted.append(best)
        groups.append(group)
        inclusion.append(_inclusion(group, candidates, current, random))
        again = fitter.refined(best.fitted.effects, best.fitted.departures, best.fitted.reading, (FIT, SELECT))
        current = again or best.fitted
    floor = Floor.of(fitter, current)
    return Selection(
        fitter, fitter.base, current, tuple(accepted), tuple(groups), tuple(inclusion), tuple(tried), floor
    )


def _tried(
    fitter: Fitter, effects: Sequence[EffectType], current: Fitted, random: np.random.Generator, tick: Tick
) -> list[Candidate]:
    found = []
    for effect in effects:
        tick(effect.name)
        fitted = fitter.fit(effect, current)
        if fitted is not None:
            found.append((effect, fitted))
    if not found:
        return []
    best = min((fitted for _, fitted in found), key=lambda f: f.loss(SELECT))
    highest = _null(current, best, [fitted for _, fitted in found], random)
    floor = Floor.of(fitter, best)
    believed = fitter.edited(current.effects, current.departures)
    return [_candidate(believed, effect, fitted, current, floor, highest) for effect, fitted in found]


def _candidate(
    believed: Belief, effect: EffectType, fitted: Fitted, current: Fitted, floor: Floor, highest: FloatArray
) -> Candidate:
    gain = current.loss(SELECT) - fitted.loss(SELECT)
    share, left = _share(current, fitted, floor)
    p = float((1 + np.sum(highest >= gain)) / (1 + len(highest)))
    return Candidate(effect, fitted, gain, p, share, left, _is_covered(believed, effect, dict(fitted.effects)[effect]))


def _share(current: Fitted, fitted: Fitted, floor: Floor) -> tuple[float, float]:
    """Return the share of the gap explained where it is explained most, and what is left there over the floor."""
    changes = [old.loss(SELECT) - new.loss(SELECT) for old, new in zip(current.errors, fitted.errors, strict=True)]
    place = int(np.argmax(changes))
    old, new = current.errors[place], fitted.errors[place]
    least = floor.whitened(old.channel) ** 2 * max(1, int(np.sum(old.judged & (old.part == SELECT))))
    before, after = old.loss(SELECT), new.loss(SELECT)
    above = before - least
    share = (before - after) / above if above > 0 else 0.0
    return min(share, 1.5), float(np.sqrt(after / least)) if least > 0 else np.inf


def _is_covered(believed: Belief, effect: EffectType, values: Values) -> bool:
    """Whether every parameter lies as near to neutral as the believed model's published uncertainty reaches."""
    neutral = effect.neutral(believed)
    if neutral is None:
        return any(prior.tolerance for prior in effect.priors.values())
    for name, prior in effect.priors.items():
        if prior.is_log:
            away = abs(np.log(values[name] / neutral[name])) if neutral[name] > 0 else np.inf
            if away > np.log(max(prior.tolerance, 1.0)):
                return False
        elif abs(values[name] - neutral[name]) > prior.tolerance:
            return False
    return True


def _whole(fitted: Fitted) -> tuple[FloatArray, np.ndarray, np.ndarray]:
    errors = fitted.errors
    return (
        np.concatenate([each.whitened for each in errors]),
        np.concatenate([each.part for each in errors]),
        np.concatenate([each.block for each in errors]),
    )


def _null(current: Fitted, best: Fitted, fitted: Sequence[Fitted], random: np.random.Generator) -> FloatArray:
    """Return the highest gain over the effects, in draws in which none is true.

    What the best of them leaves is noise and discrepancy; its blocks are drawn with random signs (wild bootstrap), and
    each effect is fitted along the direction in which it moved the prediction.
    """
    rest, part, block = _whole(best)
    now = _whole(current)[0]
    ways = np.array([now - _whole(each)[0] for each in fitted])
    numbers, member = np.unique(block, return_inverse=True)
    highest = np.zeros(DRAWS)
    first, second = part == FIT, part == SELECT
    power_1 = np.maximum(np.sum(ways[:, first] ** 2, axis=1), 1e-12)
    power_2 = np.sum(ways[:, second] ** 2, axis=1)
    along_1 = _by_block(ways * (rest * first), member, len(numbers))
    along_2 = _by_block(ways * (rest * second), member, len(numbers))
    for draw in range(DRAWS):
        signs = random.choice((-1.0, 1.0), len(numbers))
        size = np.maximum(along_1 @ signs / power_1, 0.0)
        highest[draw] = np.max(2.0 * size * (along_2 @ signs) - size**2 * power_2)
    return highest


def _by_block(values: FloatArray, member: np.ndarray, count: int) -> FloatArray:
    return np.array([np.bincount(member, weights=row, minlength=count) for row in values])


def _group(best: Candidate, candidates: Sequence[Candidate]) -> tuple[str, ...]:
    """Return the effects that cannot be told from the best one on what it was chosen by, the best first."""
    left = max(1.0, best.left) ** 2
    alike = [
        c.effect.name
        for c in sorted(candidates, key=lambda c: -c.gain)
        if c is not best and c.p <= LEVEL and best.gain - c.gain + _fit_loss(c) - _fit_loss(best) <= ALIKE * left
    ]
    return (best.effect.name, *alike)


def _fit_loss(candidate: Candidate) -> float:
    return candidate.fitted.loss(FIT)


def _inclusion(
    group: tuple[str, ...], candidates: Sequence[Candidate], current: Fitted, random: np.random.Generator
) -> float:
    """Return how often the group would be chosen again, were other cycles or days recorded."""
    base, part, block = _whole(current)
    seen = (part == FIT) | (part == SELECT)
    numbers, member = np.unique(block[seen], return_inverse=True)
    rows = np.array([base[seen] ** 2, *(_whole(c.fitted)[0][seen] ** 2 for c in candidates)])
    loss = _by_block(rows, member, len(numbers))
    names = [c.effect.name for c in candidates]
    hits = 0
    for _ in range(DRAWS):
        weight = np.bincount(random.integers(len(numbers), size=len(numbers)), minlength=len(numbers))
        gains = loss[0] @ weight - loss[1:] @ weight
        best = int(np.argmax(gains))
        hits += names[best] in group and gains[best] > LEAST_GAIN
    return hits / DRAWS
