"""Which effects a link of the loop shows: forward selection on days that took no part in the fit, with honest nulls."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.gap.candidate import (
    Candidate,
    alike,
    best_of,
    explained,
    is_worth_naming,
    over_floor,
    shared,
)
from waxstudy.gap.claim import CLEAR_GAIN, EXPLAINED, LEAST_OF_FORM, LEAST_SHARE, Needs
from waxstudy.gap.fit import Fitter
from waxstudy.gap.fitted import Fitted
from waxstudy.gap.floor import Floor
from waxstudy.gap.judge import BOTH, FIT, SELECT
from waxstudy.gap.links import ROOM_STAGES
from waxstudy.gap.reading import Reading
from waxstudy.gap.resampling import inclusion, null
from waxstudy.gap.room import room_error
from waxstudy.gap.space import EffectType
from waxstudy.gap.stray import is_covered
from waxstudy.gap.trust import is_confirmed, is_late, is_poor, kept_share
from waxstudy.plugin import FloatArray

LEAST_JOINT_SHARE = 0.7  # that two effects together must explain where none does alone
MOST_EFFECTS = 3
PAIRED = 2  # effects that others are tried beside, where none is enough alone

Tick = Callable[[str], None]


@dataclass(frozen=True)
class Found:
    """An accepted effect, the names that cannot be told from it (its own first), and how often it is chosen again."""

    candidate: Candidate
    group: tuple[str, ...]
    inclusion: float
    others: tuple[Candidate, ...] = ()  # of its group

    @property
    def effect(self) -> EffectType:
        return self.candidate.effect

    @property
    def channel(self) -> str:
        """Where it acts most."""
        return self.candidate.channel


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
    distrusted: tuple[Found, ...] = ()  # accepted, but they leave too much over the whole record

    @property
    def is_late(self) -> bool:
        """Whether nothing was found, and the last days, which took no part in it, show a gap that the others do not."""
        return not self.found and any(is_late(self.fitter, errors, self.floor) for errors in self.after.errors)

    @property
    def slight(self) -> frozenset[str]:
        """Channels whose gap an effect explains that is too small to be named."""
        return frozenset(candidate.channel for candidate in self.tried if candidate.is_slight)

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
            # what cannot be told from an effect that is there would but add to its parameters
            known = {name for each in found for name in each.group}
            chosen = [c for c in candidates if c.is_accepted and c.effect.name not in known]
            if chosen:
                best = best_of(chosen)
                found.append(self.found(best, candidates, current))
            elif pair := self.pair(current, candidates):
                best = pair[-1]
                names = tuple(each.effect.name for each in pair)
                found += [self.found(each, [*candidates, best], current, names) for each in pair]
            else:
                break
            if self.fitter.is_quick and is_enough(self.fitter, best):
                current = best.fitted
                break
            current = self.fitter.reread(self.fitter.settled(best.fitted))
        models, without = self.models(found, current.reading)
        withdrawn: list[Found] = []
        while doubtful := unconfirmed(found, models[-1], without):
            withdrawn.append(doubtful)
            found.remove(doubtful)
            models, without = self.models(found, current.reading if found else self.fitter.base.reading)
        floor = Floor.of(self.fitter, models[-1])
        if distrusted := self.distrusted(found, models, without, floor):
            found = [each for each in found if each not in distrusted]
            models, without = self.models(found, current.reading if found else self.fitter.base.reading)
            floor = Floor.of(self.fitter, models[-1])
        parts = tuple(found), tuple(first), floor, tuple(withdrawn), tuple(distrusted)
        return Selection(self.fitter, models, without, *parts)

    def distrusted(
        self, found: Sequence[Found], models: Sequence[Fitted], without: Sequence[Fitted], floor: Floor
    ) -> Sequence[Found]:
        """Return effects of a room that is not understood, and those that explain too little of the whole record."""
        if is_poor(self.fitter, models[0], models[-1]):
            return [each for each in found if each.effect.stage in ROOM_STAGES]
        pairs = zip(found, without, strict=True)
        return [each for each, before in pairs if kept_share(each.channel, before, models[-1], floor) < least(each)]

    def models(self, found: Sequence[Found], reading: Reading) -> tuple[tuple[Fitted, ...], tuple[Fitted, ...]]:
        """Return the believed model and those with one more effect each, and the last without each one of them.

        All are fitted to both first parts, under one reading.
        """
        whole = [self.fitter.base_on_both(reading)]
        for each in found:
            fitted = each.candidate.fitted
            earlier = dict(whole[-1].effects)
            values = dict(fitted.effects) | earlier
            effects = [(effect, values[effect]) for effect in (*earlier, each.effect)]
            again = self.fitter.refined(effects, fitted.departures, reading, BOTH)
            whole.append(again or fitted)
        if len(found) < 2:
            return tuple(whole), tuple(whole[:-1])
        return tuple(whole), tuple(self.without(each.effect, whole) for each in found)

    def without(self, effect: EffectType, models: Sequence[Fitted]) -> Fitted:
        """Return the last model without one of its effects, the rest fitted again."""
        last = models[-1]
        rest = [(other, values) for other, values in last.effects if other is not effect]
        return self.fitter.refined(rest, last.departures, last.reading, BOTH) or models[0]

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
        spread = self.fitter.spread(best)
        return [
            self.candidate(effect, one, read_as[one.reading], most, floor, own, highest, spread)
            for effect, one in fitted
        ]

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
        spread: float,
    ) -> Candidate:
        """Return a candidate beside a model under its own reading; its gain is over the better of both readings."""
        gain = min(most, self.loss(current, SELECT)) - self.loss(fitted, SELECT)
        channel, share, left = shared(current, fitted, floor)
        p = float((1 + np.sum(highest >= gain)) / (1 + len(highest)))
        covered = effect.stage == "actuator" and gain > 0.0 and is_covered(self.fitter, current, fitted)
        before, after = (each.errors_of(channel).gap(SELECT) for each in (current, fitted))
        plain_share = explained(before**2, after**2, floor.plain[channel] ** 2)
        over = min(over_floor(current, channel, each, gain < CLEAR_GAIN) for each in (floor, own))
        both = self.loss(fitted, FIT) + self.loss(fitted, SELECT)
        strain = self.fitter.strain(fitted)
        missed = left * floor.white[channel]
        believed = self.fitter.edited(fitted.effects[:-1], fitted.departures)  # what it was added to
        worth = is_worth_naming(effect, dict(fitted.effects)[effect], believed)
        return Candidate(
            effect=effect,
            fitted=fitted,
            gain=gain,
            loss=both,
            strain=strain,
            p=p,
            share=share,
            plain_share=plain_share,
            left=left,
            missed=missed,
            channel=channel,
            spread=spread,
            over=over,
            needs=Needs.of(self.fitter, effect.stage, channel, fitted.errors_of(channel).unit, gain, over),
            is_covered=covered,
            is_worth_naming=worth,
        )

    def loss(self, fitted: Fitted, part: int) -> float:
        """Return a model's loss without what the noise of its drive adds to it."""
        return fitted.loss(part) - self.fitter.drive_noise(fitted).get(part, 0.0)

    def pair(self, current: Fitted, candidates: Sequence[Candidate]) -> tuple[Candidate, Candidate] | None:
        """Return two effects that explain together what neither does alone, or None; a quick search does not look."""
        if self.fitter.is_quick:
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

    def found(
        self, best: Candidate, candidates: Sequence[Candidate], current: Fitted, pair: Sequence[str] = ()
    ) -> Found:
        """Return an effect with its group; of a pair, which explains enough together, none stands for the other."""
        group = alike(best, [each for each in candidates if each.effect.name not in pair])
        others = {c.effect.name: c for c in candidates}
        often = inclusion((*group, *pair), candidates, current, self.random)
        return Found(best, group, often, tuple(others[name] for name in group[1:]))


def least(found: Found) -> float:
    """Return the share of its gap that an effect must explain over the whole record, all else fitted again."""
    if found.effect.stage in ROOM_STAGES:
        return LEAST_SHARE
    return LEAST_OF_FORM if len(found.effect.priors) > 1 else -np.inf


def is_enough(fitter: Fitter, best: Candidate) -> bool:
    """Whether what an effect leaves would be no finding: of a room its form, of a chain little over the floor."""
    if not fitter.link.with_room or fitter.is_to_the_letter:
        return best.left <= EXPLAINED
    return all(errors.gap() <= room_error(fitter.belief, errors.channel).most_K for errors in best.fitted.errors)


def unconfirmed(found: Sequence[Found], after: Fitted, without: Sequence[Fitted]) -> Found | None:
    """Return the last effect that the last days do not confirm, or None."""
    pairs = zip(reversed(found), reversed(without), strict=True)
    return next((each for each, before in pairs if not is_confirmed(each.channel, before, after)), None)
