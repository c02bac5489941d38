"""Which effects a segment shows: forward selection on days that took no part in the fit, with honest nulls."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np

from waxstudy.diagnosis.criteria import ROOM_STAGES, Criterion, Question, criteria, failed, meets, meets_one
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.edits import EffectType
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.model.travel import travel
from waxstudy.diagnosis.observations.partition import BOTH, FIT, SELECT
from waxstudy.diagnosis.residuals.noise_floor import NoiseFloor
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.result import in_floors
from waxstudy.diagnosis.select.candidate import Candidate, alike, best_of
from waxstudy.diagnosis.select.evidence import (
    AirLeft,
    Evidence,
    Kept,
    Late,
    departure,
    distinct,
    explained,
    strongest,
)
from waxstudy.diagnosis.select.instruments import OffBy
from waxstudy.diagnosis.select.intervals import Intervals, parameter_intervals
from waxstudy.diagnosis.select.null import inclusion, null
from waxstudy.diagnosis.select.patterns import Pattern, acting
from waxstudy.plugin import FloatArray

MOST_EFFECTS = 3
PAIRED = 2  # effects that others are tried beside, where none is enough alone
OF_AIR = ("air_temperature_C", "operative_temperature_C")
KEEP = Question.KEEP
NOT_UNDERSTOOD = next(each for each in criteria() if Question.UNDERSTOOD in each.questions)

T = TypeVar("T")
Models = Sequence[Hypothesis]
Tick = Callable[[str], None]


@dataclass(frozen=True)
class Found:
    """An accepted effect, the names that cannot be told from it (its own first), and how often it is chosen again."""

    candidate: Candidate
    group: tuple[str, ...]
    inclusion: float
    others: tuple[Candidate, ...] = ()  # of its group
    pattern: Pattern | None = None  # where it does not act always

    @property
    def effect(self) -> EffectType:
        return self.candidate.effect

    @property
    def channel(self) -> str:
        """Where it acts most."""
        return self.candidate.evidence.channel


@dataclass(frozen=True)
class Withdrawn:
    """An effect that was accepted and then not kept, by the criterion that it does not meet."""

    found: Found
    criterion: Criterion

    @property
    def is_blurred(self) -> bool:
        """Whether it explains its gap, but may as well be what is believed."""
        return self.criterion.statistic == "distinct"


@dataclass(frozen=True)
class Selection:
    """What was found at one segment; `models`: the believed one and each with one more effect, on both parts."""

    estimator: Estimator[SegmentProblem]
    models: Models
    without: Models  # the last model without each effect found
    found: tuple[Found, ...]
    tried: tuple[Candidate, ...]  # of the first round
    floor: NoiseFloor
    withdrawn: tuple[Withdrawn, ...] = ()
    intervals: Intervals = field(default_factory=dict)  # of what was found
    posterior: Mapping[str, float] = field(default_factory=dict)  # of hypotheses, where they were weighed
    off_by: OffBy | None = None  # the instrument that would explain most of what the last model leaves
    course: FloatArray | None = None  # (n,) share of what the last model's effect does; None for all, always

    @property
    def problem(self) -> SegmentProblem:
        return self.estimator.problem

    @property
    def segment(self) -> Segment:
        return self.problem.segment

    @property
    def is_late(self) -> bool:
        """Whether nothing was found, and the last days, which took no part in it, show a gap that the others do not."""
        if self.found:
            return False
        floor = self.floor.plain
        return any(meets(Question.LATE, Late.of(each, floor[each.channel])) for each in self.after.residuals)

    @property
    def slight(self) -> frozenset[str]:
        """Channels whose gap an effect explains that is too small, or too little known, to be named."""
        if any(each.is_blurred for each in self.withdrawn):
            return frozenset(self.segment.judged)
        return frozenset(candidate.evidence.channel for candidate in self.tried if candidate.meets(Question.SLIGHT))

    @property
    def is_poor(self) -> bool:
        """Whether the air of a room by itself stays missed by too much, whatever is added."""
        return is_poor(self.segment, self.before, self.after)

    @property
    def before(self) -> Hypothesis:
        return self.models[0]

    @property
    def after(self) -> Hypothesis:
        return self.models[-1]


def select(estimator: Estimator[SegmentProblem], effects: Sequence[EffectType], seed: int, tick: Tick) -> Selection:
    """Add the effects of a segment one by one, as long as one of them explains enough of what is left."""
    return Search(estimator, effects, np.random.default_rng(seed), tick).run()


class Search:
    def __init__(
        self,
        estimator: Estimator[SegmentProblem],
        effects: Sequence[EffectType],
        random: np.random.Generator,
        tick: Tick,
    ) -> None:
        self.estimator, self.problem, self.random, self.tick = estimator, estimator.problem, random, tick
        # what can be only because another effect is there would change that one's parameters, and means nothing alone
        self.effects = [effect for effect in effects if not effect.hindrance(self.problem.belief)]
        self.made: dict[str, tuple[Hypothesis, Any]] = {}

    def run(self) -> Selection:
        return self.kept(*self.added())

    def added(self) -> tuple[list[Found], list[Candidate], Convention]:
        """Return the effects that are accepted one after the other, the first candidates, and how the log is read."""
        current = self.estimator.base
        found: list[Found] = []
        first: list[Candidate] = []
        while len(found) < MOST_EFFECTS:
            candidates = self.tried(current)
            first = first or candidates
            # what cannot be told from an effect that is there would but add to its parameters
            known = {name for each in found for name in each.group}
            chosen = [c for c in candidates if c.meets(Question.CLAIM) and c.effect.name not in known]
            if chosen:
                best = best_of(chosen)
                found.append(self.found(best, candidates, current))
            elif pair := self.pair(current, candidates):
                best = pair[-1]
                names = tuple(each.effect.name for each in pair)
                found += [self.found(each, [*candidates, best], current, names) for each in pair]
            else:
                break
            if self.estimator.is_quick and self.is_enough(best):
                return found, first, best.fitted.convention
            current = self.estimator.with_best_convention(self.estimator.settled(best.fitted))
        return found, first, current.convention

    def kept(self, found: list[Found], first: Sequence[Candidate], convention: Convention) -> Selection:
        """Return what is kept of the effects once all are fitted to all days: the last days first, one at a time."""
        withdrawn: list[Withdrawn] = []
        models, without = self.models(found, convention)
        for withdraw in (self.unconfirmed, self.distrusted, self.blurred):
            while found and (out := withdraw(found, models, without)):
                withdrawn += out
                found = [each for each in found if each not in [one.found for one in out]]
                models, without = self.models(found, convention if found else self.estimator.base.convention)
        floor, intervals = self.floor(models[-1]), self.intervals(models[-1]) if found else {}
        rest = tuple(found), tuple(first), floor, tuple(withdrawn), intervals
        return Selection(self.estimator, models, without, *rest)

    def selection(
        self, found: Sequence[Found], first: Sequence[Candidate], intervals: Intervals, of_all_days: Hypothesis
    ) -> Selection:
        """Return a selection of what was found otherwise, with the intervals of its parameters.

        What acts on the last days alone is as it was fitted to all days: the other days do not show it.
        """
        convention = found[-1].candidate.fitted.convention if found else self.estimator.base.convention
        models, without = self.models(found, convention)
        rest = tuple(found), tuple(first), self.floor(models[-1]), (), intervals
        if not found or not (pattern := found[-1].pattern):
            return Selection(self.estimator, models, without, *rest)
        samples = [each.sample[each.judged & np.isin(each.part, BOTH)] for each in models[-1].residuals]
        if pattern.strength[np.concatenate(samples)].any():
            last, strength = acting(models[-2], models[-1], pattern, parts=BOTH)
        else:
            last, strength = acting(models[-2], self.here(of_all_days), pattern)
        return Selection(self.estimator, [*models[:-1], last], without, *rest, course=strength * pattern.strength)

    def here(self, fitted: Hypothesis) -> Hypothesis:
        """Return a hypothesis that was fitted to the whole record, judged on the parts of the record."""
        return self.problem.at(fitted.effects, fitted.departures, fitted.convention) or fitted

    def floor(self, last: Hypothesis) -> NoiseFloor:
        return self.once("floor", last, lambda: NoiseFloor.of(self.problem, last))

    def intervals(self, last: Hypothesis) -> Intervals:
        return self.once("intervals", last, lambda: parameter_intervals(self.estimator, last))

    def once(self, what: str, last: Hypothesis, make: Callable[[], T]) -> T:
        """Return what belongs to the last model, made once as long as it is the last."""
        if self.made.get(what, (None, None))[0] is not last:
            self.made[what] = last, make()
        found: T = self.made[what][1]
        return found

    def unconfirmed(self, found: Sequence[Found], models: Models, without: Models) -> list[Withdrawn]:
        """Return the last effect that the last days do not confirm."""
        pairs = zip(reversed(found), reversed(without), strict=True)
        tested = ((each, failed(KEEP, Kept.of(each.effect, each.channel, one, models[-1]))) for each, one in pairs)
        return [Withdrawn(each, criterion) for each, criterion in tested if criterion][:1]

    def distrusted(self, found: Sequence[Found], models: Models, without: Models) -> list[Withdrawn]:
        """Return effects of a room that is not understood, else those that explain too little of the whole record."""
        if is_poor(self.problem.segment, models[0], models[-1]):
            of_room = [each for each in found if each.effect.stage in ROOM_STAGES]
            return [Withdrawn(each, NOT_UNDERSTOOD) for each in of_room]
        floor, pairs = self.floor(models[-1]), zip(found, without, strict=True)
        tested = [
            (each, failed(KEEP, Kept.of(each.effect, each.channel, one, models[-1], floor))) for each, one in pairs
        ]
        return [Withdrawn(each, criterion) for each, criterion in tested if criterion]

    def blurred(self, found: Sequence[Found], models: Models, without: Models) -> list[Withdrawn]:
        """Return effects that, as fitted in the end, may as well be what is believed without them."""
        last, out = models[-1], []
        for each, before in zip(found, without, strict=True):
            departs = distinct_in(self.problem, last, each.effect, self.intervals(last))
            kept = Kept.of(each.effect, each.channel, before, last, distinct=departs)
            if criterion := failed(KEEP, kept):
                out.append(Withdrawn(each, criterion))
        return out

    def models(self, found: Sequence[Found], convention: Convention) -> tuple[Models, Models]:
        """Return the believed model and those with one more effect each, and the last without each one of them.

        All are fitted to both first parts, under one convention.
        """
        whole = [self.estimator.base_on_both(convention)]
        for each in found:
            fitted, earlier = each.candidate.fitted, whole[-1].effects
            effects = [*earlier, (each.effect, (dict(fitted.effects) | dict(earlier))[each.effect])]
            whole.append(self.estimator.refined(effects, fitted.departures, convention, BOTH) or fitted)
        return whole, whole[:-1] if len(found) < 2 else [self.without(each.effect, whole) for each in found]

    def without(self, effect: EffectType, models: Models) -> Hypothesis:
        """Return the last model without one of its effects, the rest fitted again."""
        last = models[-1]
        rest = [(other, values) for other, values in last.effects if other is not effect]
        return self.estimator.refined(rest, last.departures, last.convention, BOTH) or models[0]

    def tried(self, current: Hypothesis) -> list[Candidate]:
        """Return every effect that applies, fitted on top of a model and judged."""
        fitted = []
        for effect in [each for each in self.effects if each.name not in current.names]:
            self.tick(effect.name)
            if one := self.estimator.fit(effect, current):
                fitted.append((effect, one))
        return self.judged(current, fitted)

    def judged(self, current: Hypothesis, fitted: Sequence[tuple[EffectType, Hypothesis]]) -> list[Candidate]:
        """Return candidates beside a model under their own convention; their gain is over the better of both."""
        if not fitted:
            return []
        best = min((one for _, one in fitted), key=lambda one: one.loss(SELECT))
        floor, own = NoiseFloor.of(self.problem, best), NoiseFloor.of(self.problem, current)
        highest = null(current, best, [one for _, one in fitted], floor, self.random)
        beside = {one.convention: self.under_convention(current, one.convention) for _, one in fitted}
        most, form_share = self.loss(current, SELECT), self.estimator.form_share(best)
        found = []
        for effect, one in fitted:
            gain = min(most, self.loss(beside[one.convention], SELECT)) - self.loss(one, SELECT)
            p = float((1 + np.sum(highest >= gain)) / (1 + len(highest)))
            evidence = self.evidence(effect, one, beside[one.convention], gain, (floor, own))
            found.append(Candidate(effect, one, replace(evidence, p=p, form_share=form_share)))
        return found

    def under_convention(self, current: Hypothesis, convention: Convention) -> Hypothesis:
        """Return a model under another convention of the record: what that alone changes is no effect's doing."""
        if convention == current.convention:
            return current
        return self.estimator.refined(current.effects, current.departures, convention) or current

    def evidence(
        self, effect: EffectType, fitted: Hypothesis, current: Hypothesis, gain: float, floors: Sequence[NoiseFloor]
    ) -> Evidence:
        """Return what speaks for an effect by itself, over the floors of the best that was tried and of a model."""
        floor = floors[0]
        channel, share, left = strongest(current, fitted, floor)
        before, after = (each.residual_of(channel).gap(SELECT) for each in (current, fitted))
        believed = self.problem.edited(fitted.effects[:-1], fitted.departures)  # what it was added to
        return Evidence(
            stage=effect.stage,
            channel=channel,
            parameters=len(effect.priors),
            gain=gain,
            loss=self.loss(fitted, FIT) + self.loss(fitted, SELECT),
            strain=self.estimator.strain(fitted),
            over=min(in_floors(before, each.plain[channel]) for each in floors),
            share=share,
            plain_share=explained(before**2, after**2, floor.plain[channel] ** 2),
            left=left,
            missed=left * floor.white[channel],
            departure=departure(effect, dict(fitted.effects)[effect], believed),
            travel=self.travel(effect, current, fitted) if gain > 0.0 else np.inf,
        )

    def travel(self, effect: EffectType, current: Hypothesis, fitted: Hypothesis) -> float:
        if effect.stage != "actuator":
            return np.inf
        return travel(self.problem.record, self.problem.belief_of(current), self.problem.belief_of(fitted))

    def is_enough(self, best: Candidate) -> bool:
        """Whether what an effect leaves would be no finding: of a room its form, of a chain little over the floor."""
        if not self.problem.segment.with_room or self.problem.is_exact_room:
            return best.meets(Question.ENOUGH)
        return all(residual.gap() <= residual.form for residual in best.fitted.residuals)

    def loss(self, fitted: Hypothesis, part: int) -> float:
        """Return a model's loss without what the noise of its drive adds to it."""
        return fitted.loss(part) - self.problem.drive_noise(fitted).get(part, 0.0)

    def pair(self, current: Hypothesis, candidates: Sequence[Candidate]) -> tuple[Candidate, Candidate] | None:
        """Return two effects that explain together what neither does alone, or None; a quick search does not look."""
        if self.estimator.is_quick:
            return None
        seen = sorted((c for c in candidates if c.meets(Question.PAIR)), key=lambda c: -c.evidence.gain)
        best: tuple[Candidate, Candidate] | None = None
        for first in seen[:PAIRED]:
            for second in self.tried(first.fitted):
                whole = self.judged(current, [(second.effect, second.fitted)])[0]
                enough = whole.meets(Question.JOINT) and second.meets(Question.CLAIM)
                if enough and (best is None or whole.evidence.gain > best[1].evidence.gain):
                    best = first, whole
        return best

    def found(
        self, best: Candidate, candidates: Sequence[Candidate], current: Hypothesis, pair: Sequence[str] = ()
    ) -> Found:
        """Return an effect with its group; of a pair, which explains enough together, none stands for the other."""
        group = alike(best, [each for each in candidates if each.effect.name not in pair])
        others = {c.effect.name: c for c in candidates}
        often = inclusion((*group, *pair), candidates, current, self.random)
        return Found(best, group, often, tuple(others[name] for name in group[1:]))


def distinct_in(problem: SegmentProblem, fitted: Hypothesis, effect: EffectType, intervals: Intervals) -> float:
    """Return how far an effect is from what is believed, in noticeable steps of what its interval leaves out."""
    return distinct(effect, intervals[effect], problem.belief_without(fitted, effect))


def is_poor(segment: Segment, before: Hypothesis, after: Hypothesis) -> bool:
    """Whether the air of a room by itself stays missed by more than its form may leave, and by much of what it was."""
    if segment.stages != ROOM_STAGES:
        return False
    pairs = [each for each in zip(before.residuals, after.residuals, strict=True) if each[0].channel in OF_AIR]
    return not all(meets_one(Question.UNDERSTOOD, AirLeft.of(old, new)) for old, new in pairs)
