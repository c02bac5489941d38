"""Which effects a link of the loop shows: forward selection on days that took no part in the fit, with honest nulls."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.gap.fit import Fitted, Fitter
from waxstudy.gap.floor import Floor
from waxstudy.gap.judge import FIT, SELECT, SHRINK
from waxstudy.gap.links import SUPPLY, Reading
from waxstudy.gap.space import EffectType
from waxstudy.gap.stray import is_covered
from waxstudy.plugin import Belief, FloatArray

LEVEL = 0.01  # family-wise, over the effects of a link
LEAST_SHARE = 0.5  # of a gap above its floor that an effect must explain
LEAST_GAP = 1.1  # over the floor
LEAST_SMOOTHED_GAP = 1.5
LEAST_PART = 0.15  # that one of them must explain alone
LEAST_JOINT_SHARE = 0.7  # that two effects together must explain where none does alone
EXPLAINED = 1.5  # what is left over the floor, where nothing else can be in it
LEAST_GAIN = 10.0  # whitened
CLEAR_GAIN = 50.0
MOST_EFFECTS = 3
ALIKE = 9.0  # difference of loss at which two effects cannot be told apart, in units of what is left
SAME = 1e-6  # share of a gain that is but rounding
DRAWS = 400
CONFIRMED = 0.25  # of the square of a gap that an effect must take away on days that nobody looked at
PAIRED = 2  # effects that others are tried beside, where none is enough alone

Tick = Callable[[str], None]


@dataclass(frozen=True)
class Candidate:
    """An effect tried on top of a model: fitted on the first part, judged on the second."""

    effect: EffectType
    fitted: Fitted
    gain: float  # loss that it takes away on the second part, but for what the drive's noise adds to it
    loss: float  # on both parts, likewise
    strain: float  # squares of how far the room had to depart from what is believed, in standard deviations
    p: float  # family-wise
    share: float  # of the gap above the floor, of the channel where it acts most, on the second part
    plain_share: float  # the same of errors in the channel's unit
    left: float  # whitened gap that is left of that channel, over its floor
    missed: float  # the same, in standard deviations
    channel: str  # where it acts most
    over: float  # the gap of that channel before it, over the floor of both models, in the channel's unit
    is_covered: bool  # by what real actuators are known to stray from the believed one
    is_worth_naming: bool  # far enough from what is believed

    @property
    def is_seen(self) -> bool:
        return self.p <= LEVEL and self.gain >= LEAST_GAIN

    @property
    def is_part(self) -> bool:
        """Whether it may be one of two effects that explain a gap together."""
        return self.is_seen and self.over >= self.least_gap and self.share >= LEAST_PART and not self.is_covered

    @property
    def least_gap(self) -> float:
        """Gap over the floor below which nothing is claimed: more for a control output that runs on.

        Its drive is smoothed, and where it is cut off at 0 or 1 that looks like another tuning.
        """
        is_smoothed = self.channel == "control_output" and self.fitted.unit(self.channel) != "s"
        return LEAST_SMOOTHED_GAP if is_smoothed else LEAST_GAP

    @property
    def is_accepted(self) -> bool:
        is_gap = self.over >= self.least_gap and min(self.share, self.plain_share) >= LEAST_SHARE
        # a heating curve is claimed to be shifted only where nothing else is left of its gap
        is_whole = self.channel != SUPPLY or self.left <= EXPLAINED
        return self.is_seen and is_gap and is_whole and self.is_worth_naming and not self.is_covered


@dataclass(frozen=True)
class Found:
    """An accepted effect, the names that cannot be told from it (its own first), and how often it is chosen again."""

    candidate: Candidate
    group: tuple[str, ...]
    inclusion: float

    @property
    def effect(self) -> EffectType:
        return self.candidate.effect


@dataclass(frozen=True)
class Selection:
    """What was found at one link; `models` are the believed one and each with one more effect, on both first parts."""

    fitter: Fitter
    models: tuple[Fitted, ...]
    without: tuple[Fitted, ...]  # the last model without each effect found
    found: tuple[Found, ...]
    tried: tuple[Candidate, ...]  # of the first round
    floor: Floor
    withdrawn: tuple[Found, ...] = ()  # accepted, but not confirmed by the last part

    @property
    def before(self) -> Fitted:
        return self.models[0]

    @property
    def after(self) -> Fitted:
        return self.models[-1]


def select(fitter: Fitter, effects: Sequence[EffectType], seed: int, tick: Tick) -> Selection:
    """Add the effects of a link one by one, as long as one of them explains enough of what is left."""
    return _Search(fitter, effects, np.random.default_rng(seed), tick).run()


class _Search:
    def __init__(self, fitter: Fitter, effects: Sequence[EffectType], random: np.random.Generator, tick: Tick) -> None:
        self.fitter, self.random, self.tick = fitter, random, tick
        # what can be only because another effect is there would change that one's parameters, and means nothing alone
        self.effects = [effect for effect in effects if not effect.hindrance(fitter.belief)]

    def run(self) -> Selection:
        current = self.fitter.base
        found: list[Found] = []
        first: list[Candidate] = []
        while len(found) < MOST_EFFECTS:
            candidates = self.tried(current)
            first = first or candidates
            chosen = [c for c in candidates if c.is_accepted]
            if chosen:
                best = best_of(chosen)
                found.append(self.found(best, candidates, current))
            elif pair := self.pair(current, candidates):
                best = pair[-1]
                found += [self.found(c, [*candidates, best], current) for c in pair]
            else:
                break
            current = best.fitted
        models, without = self.models(found)
        withdrawn: list[Found] = []
        while doubtful := unconfirmed(found, models[-1], without):
            withdrawn.append(doubtful)
            found.remove(doubtful)
            models, without = self.models(found)
        floor = Floor.of(self.fitter, models[-1])
        return Selection(self.fitter, models, without, tuple(found), tuple(first), floor, tuple(withdrawn))

    def models(self, found: Sequence[Found]) -> tuple[tuple[Fitted, ...], tuple[Fitted, ...]]:
        """Return the believed model and those with one more effect each, and the last without each one of them.

        All are fitted to both first parts.
        """
        base = self.fitter.base
        reading = found[0].candidate.fitted.reading if found else base.reading
        whole = [self.fitter.refined((), base.departures, reading, (FIT, SELECT)) or base]
        for each in found:
            fitted = each.candidate.fitted
            earlier = dict(whole[-1].effects)
            values = dict(fitted.effects) | earlier
            effects = [(effect, values[effect]) for effect in (*earlier, each.effect)]
            again = self.fitter.refined(effects, fitted.departures, fitted.reading, (FIT, SELECT))
            whole.append(again or fitted)
        if len(found) < 2:
            return tuple(whole), tuple(whole[:-1])
        return tuple(whole), tuple(self.without(each.effect, whole) for each in found)

    def without(self, effect: EffectType, models: Sequence[Fitted]) -> Fitted:
        """Return the last model without one of its effects, the rest fitted again."""
        last = models[-1]
        rest = [(other, values) for other, values in last.effects if other is not effect]
        return self.fitter.refined(rest, last.departures, last.reading, (FIT, SELECT)) or models[0]

    def tried(self, current: Fitted) -> list[Candidate]:
        """Return every effect that applies, fitted on top of a model and judged."""
        fitted = []
        for effect in self.effects:
            if effect.name not in current.names:
                self.tick(effect.name)
                one = self.fitter.fit(effect, current)
                if one is not None:
                    fitted.append((effect, one))
        return self.judged(current, fitted)

    def judged(self, current: Fitted, fitted: Sequence[tuple[EffectType, Fitted]]) -> list[Candidate]:
        if not fitted:
            return []
        best = min((one for _, one in fitted), key=lambda one: one.loss(SELECT))
        floor, own = Floor.of(self.fitter, best), Floor.of(self.fitter, current)
        highest = null(current, best, [one for _, one in fitted], floor, self.random)
        read_as = {one.reading: self.read_as(current, one.reading) for _, one in fitted}
        most = self.loss(current, SELECT)
        return [self.candidate(effect, one, read_as[one.reading], most, floor, own, highest) for effect, one in fitted]

    def read_as(self, current: Fitted, reading: Reading) -> Fitted:
        """Return a model under another reading of the record: what that alone changes is no effect's doing."""
        if reading == current.reading:
            return current
        return self.fitter.refined(current.effects, current.departures, reading) or current

    def candidate(
        self,
        effect: EffectType,
        fitted: Fitted,
        current: Fitted,
        most: float,
        floor: Floor,
        own: Floor,
        highest: FloatArray,
    ) -> Candidate:
        """Return a candidate beside a model under its own reading; its gain is over the better of both readings."""
        gain = min(most, self.loss(current, SELECT)) - self.loss(fitted, SELECT)
        channel, share, left = shared(current, fitted, floor)
        p = float((1 + np.sum(highest >= gain)) / (1 + len(highest)))
        covered = effect.stage == "actuator" and gain > 0.0 and is_covered(self.fitter, current, fitted)
        before, after = (next(e for e in each.errors if e.channel == channel).gap(SELECT) for each in (current, fitted))
        least = floor.plain[channel]
        plain_share = (before**2 - after**2) / (before**2 - least**2) if before > least else 0.0
        over = min(over_floor(current, channel, each, gain < CLEAR_GAIN) for each in (floor, own))
        both = self.loss(fitted, FIT) + self.loss(fitted, SELECT)
        strain = self.fitter.strain(fitted)
        missed = left * floor.white[channel]
        believed = self.fitter.edited(fitted.effects[:-1], fitted.departures)  # what it was added to
        worth = is_worth_naming(effect, dict(fitted.effects)[effect], believed)
        return Candidate(
            effect, fitted, gain, both, strain, p, share, plain_share, left, missed, channel, over, covered, worth
        )

    def loss(self, fitted: Fitted, part: int) -> float:
        """Return a model's loss without what the noise of its drive adds to it."""
        return fitted.loss(part) - self.fitter.drive_noise(fitted).get(part, 0.0)

    def pair(self, current: Fitted, candidates: Sequence[Candidate]) -> tuple[Candidate, Candidate] | None:
        """Return two effects that explain together what neither does alone, or None; a quick search does not look."""
        if self.fitter.thorough < 1.0:
            return None
        seen = sorted((c for c in candidates if c.is_part), key=lambda c: -c.gain)
        best: tuple[Candidate, Candidate] | None = None
        for first in seen[:PAIRED]:
            for second in self.tried(first.fitted):
                whole = self.judged(current, [(second.effect, second.fitted)])[0]
                enough = whole.share >= LEAST_JOINT_SHARE and second.is_accepted
                if enough and (best is None or whole.gain > best[1].gain):
                    best = first, whole
        return best

    def found(self, best: Candidate, candidates: Sequence[Candidate], current: Fitted) -> Found:
        group = alike(best, candidates)
        return Found(best, group, inclusion(group, candidates, current, self.random))


def best_of(candidates: Sequence[Candidate]) -> Candidate:
    """Return the candidate that gains most; of those that gain the same but for rounding, the first by name."""
    most = max(c.gain for c in candidates)
    return min((c for c in candidates if c.gain >= most * (1.0 - SAME)), key=lambda c: c.effect.name)


def is_worth_naming(effect: EffectType, values: Mapping[str, float], believed: Belief) -> bool:
    """Whether a parameter lies farther from what is believed than what the effect calls noticeable."""
    neutral = effect.neutral(believed)
    if neutral is None or not effect.priors:
        return True
    for name, prior in effect.priors.items():
        value, still = values[name], neutral[name]
        if prior.is_log and max(value / still, still / value) > prior.noticeable:
            return True
        if not prior.is_log and abs(value - still) > prior.noticeable:
            return True
    return False


def unconfirmed(found: Sequence[Found], after: Fitted, without: Sequence[Fitted]) -> Found | None:
    """Return an effect without which its channel's gap is hardly larger on the last part, the last such, or None."""
    for each, before in zip(reversed(found), reversed(without), strict=True):
        old, new = (next(e for e in m.errors if e.channel == each.candidate.channel) for m in (before, after))
        had, left = old.gap(SHRINK), new.gap(SHRINK)
        if (old.judged & (old.part == SHRINK)).any() and left**2 > (1.0 - CONFIRMED) * had**2:
            return each
    return None


def over_floor(current: Fitted, channel: str, floor: Floor, is_slight: bool) -> float:
    """Return a channel's gap over a floor, in its unit; of a slight gain in what runs on also weighed as errors are.

    A model that passes less noise on misses less, right or wrong: the gap must stand out of its own model's floor too.
    """
    errors = next(e for e in current.errors if e.channel == channel)
    if errors.unit == "s" or not is_slight:
        return errors.gap(SELECT) / floor.plain[channel] if floor.plain[channel] else np.inf
    weighed = float(np.sqrt(errors.loss(SELECT) / max(1, int(np.sum(errors.judged & (errors.part == SELECT))))))
    pairs = ((errors.gap(SELECT), floor.plain[channel]), (weighed, floor.white[channel]))
    return min(gap / least if least else np.inf for gap, least in pairs)


def shared(current: Fitted, fitted: Fitted, floor: Floor) -> tuple[str, float, float]:
    """Return the channel that gains most, the share of its gap above the floor that is explained, and what is left."""
    changes = [old.loss(SELECT) - new.loss(SELECT) for old, new in zip(current.errors, fitted.errors, strict=True)]
    place = int(np.argmax(changes))
    old, new = current.errors[place], fitted.errors[place]
    least = floor.white[old.channel] ** 2 * max(1, int(np.sum(old.judged & (old.part == SELECT))))
    before, after = old.loss(SELECT), new.loss(SELECT)
    share = (before - after) / (before - least) if before > least else 0.0
    return old.channel, min(share, 1.5), float(np.sqrt(after / least)) if least > 0 else np.inf


def whole(fitted: Fitted) -> tuple[FloatArray, np.ndarray, np.ndarray]:
    """Return whitened errors, parts and blocks of all channels, one after the other."""
    errors = fitted.errors
    return (
        np.concatenate([each.whitened for each in errors]),
        np.concatenate([each.part for each in errors]),
        np.concatenate([each.block for each in errors]),
    )


def null(
    current: Fitted, best: Fitted, fitted: Sequence[Fitted], floor: Floor, random: np.random.Generator
) -> FloatArray:
    """Return the highest gain over the effects, in draws in which none is true.

    What the best of them leaves is noise and discrepancy; its blocks are drawn with random signs (wild bootstrap), with
    the floor's noise, and each effect is fitted along the direction in which it moved the prediction.
    """
    rest, part, block = whole(best)
    now = whole(current)[0]
    ways = np.array([now - whole(each)[0] for each in fitted])
    numbers, member = np.unique(block, return_inverse=True)
    first, second = part == FIT, part == SELECT
    power_1 = np.maximum(np.sum(ways[:, first] ** 2, axis=1), 1e-12)
    power_2 = np.sum(ways[:, second] ** 2, axis=1)
    along_1 = by_block(ways * (rest * first), member, len(numbers))
    along_2 = by_block(ways * (rest * second), member, len(numbers))
    signs = random.choice((-1.0, 1.0), (len(numbers), DRAWS))
    noise = max(floor.white.values(), default=0.0) * random.normal(size=(2, len(ways), DRAWS))
    first_part = along_1 @ signs + noise[0] * np.sqrt(power_1)[:, None]
    second_part = along_2 @ signs + noise[1] * np.sqrt(power_2)[:, None]
    size = np.maximum(first_part / power_1[:, None], 0.0)
    gains = 2.0 * size * second_part - size**2 * power_2[:, None]
    return np.asarray(gains.max(axis=0))


def by_block(values: FloatArray, member: np.ndarray, count: int) -> FloatArray:
    """Return the sums of each row (k, m) over its blocks (k, blocks)."""
    return np.array([np.bincount(member, weights=row, minlength=count) for row in values])


def alike(best: Candidate, candidates: Sequence[Candidate]) -> tuple[str, ...]:
    """Return the effects that cannot be told from the best one on what it was chosen by, the best first."""
    left = max(1.0, best.missed) ** 2

    def worse(other: Candidate) -> float:
        return other.loss + other.strain - best.loss - best.strain

    others = sorted((c for c in candidates if c.effect is not best.effect and c.is_seen), key=worse)
    return (best.effect.name, *(c.effect.name for c in others if worse(c) <= ALIKE * left))


def inclusion(
    group: tuple[str, ...], candidates: Sequence[Candidate], current: Fitted, random: np.random.Generator
) -> float:
    """Return how often one of the group would be chosen again, were other cycles or days recorded."""
    base, part, block = whole(current)
    seen = (part == FIT) | (part == SELECT)
    numbers, member = np.unique(block[seen], return_inverse=True)
    loss = by_block(np.array([whole(c.fitted)[0][seen] ** 2 for c in candidates]), member, len(numbers))
    # what the drive's noise adds is spread evenly
    loss += np.array([[(c.loss - own.sum()) / len(numbers)] for c, own in zip(candidates, loss, strict=True)])
    weights = random.multinomial(len(numbers), np.full(len(numbers), 1.0 / len(numbers)), DRAWS).T
    gains = (by_block(base[None, seen] ** 2, member, len(numbers)) - loss) @ weights
    names = [c.effect.name for c in candidates]
    chosen = [names[best] in group for best in np.argmax(gains, axis=0)]
    return float(np.mean(np.array(chosen) & (gains.max(axis=0) > LEAST_GAIN)))
