"""What the segments show, put together: verdict, effects, what stays, and what it does in the closed loop."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from math import nan

import numpy as np
import pandas as pd

from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.calibration.calibrate import Calibration
from waxstudy.diagnosis.calibration.healthy import Healthy
from waxstudy.diagnosis.calibration.told import calibrated, doubts, fits
from waxstudy.diagnosis.consequence.closed_loop import closed_loop
from waxstudy.diagnosis.consequence.impact import impact
from waxstudy.diagnosis.consequence.missing_heat import missing_heat
from waxstudy.diagnosis.consequence.regimes import regimes
from waxstudy.diagnosis.consequence.times import when
from waxstudy.diagnosis.estimate.parameter_space import Space
from waxstudy.diagnosis.model.as_built import AsBuilt
from waxstudy.diagnosis.model.edits import EffectType, Values, with_effects
from waxstudy.diagnosis.model.room_response import built
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.observations.partition import FIT, SELECT, SHRINK, parts_of
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.result import (
    Alternative,
    BeforeAfter,
    Diagnosis,
    FoundEffect,
    Interval,
    Lack,
    MissingHeat,
    StageGap,
    Step,
    Tried,
    Unexplained,
    Untestable,
    Verdict,
    When,
)
from waxstudy.diagnosis.select.candidate import Candidate
from waxstudy.diagnosis.select.changed import joint
from waxstudy.diagnosis.select.intervals import shrink
from waxstudy.diagnosis.select.meter import change_of_meter
from waxstudy.diagnosis.select.posterior import UNKNOWN
from waxstudy.diagnosis.select.search import Found, Selection
from waxstudy.diagnosis.select.stated import stated
from waxstudy.diagnosis.select.testability import doubts_of_sampling, next_measurements, separating, uncovered, unshown
from waxstudy.diagnosis.select.unexplained import slight, stage_of, unexplained
from waxstudy.diagnosis.sentences import Stages, filled_in, logged, needless, summary, warned, why_not
from waxstudy.diagnosis.traces import traces
from waxstudy.plugin import STAGES, Belief


@dataclass(frozen=True)
class Work:
    """What a diagnosis works on."""

    dataset: Dataset
    record: Record
    documented: Belief  # what the documents say
    effects: Sequence[EffectType]
    seed: int
    thorough: float
    calibration: Calibration | None = None
    baseline: Dataset | None = None  # that it was calibrated on

    @property
    def as_built(self) -> AsBuilt | None:
        return self.calibration.as_built if self.calibration else None

    @property
    def healthy(self) -> Mapping[str, Healthy]:
        """The links of a healthy record, by name."""
        return self.calibration.healthy if self.calibration else {}

    @cached_property
    def belief(self) -> Belief:
        """The loop as it was built, as far as a healthy record tells."""
        return self.as_built.believed(self.documented) if self.as_built else self.documented


def of_segment(segment: Segment, effects: Sequence[EffectType]) -> list[EffectType]:
    return [effect for effect in effects if effect.stage in segment.stages]


def assembled(
    work: Work, cut: Sequence[Segment], short: Mapping[Segment, str], selections: Sequence[Selection], quick: bool
) -> Diagnosis:
    open_ = [list(unexplained(selection, work.seed)) for selection in selections]
    pairs = list(zip(selections, open_, strict=True))
    beliefs = [selection.posterior or stated(selection, remains) for selection, remains in pairs]
    linked = list(zip(selections, beliefs, strict=True))
    several = {each.name: each for selection in reversed(selections) for each in _found(selection, work.seed)}
    found = sorted(several.values(), key=lambda effect: STAGES.index(effect.stage))
    remains = [replace(each, probability=_amiss(selection, each)) for selection, rest in pairs for each in rest]
    untestable = list(_untestable(work, cut, short, selections))
    verdict = _verdict(found, remains, selections, untestable)
    stages = {effect.name: effect.stage for effect in work.effects}
    since = "the baseline" if work.calibration else ""
    judged, heat = _judged(selections, untestable, stages), _missing_heat(work, selections)
    return Diagnosis(
        dataset=work.dataset.name,
        verdict=verdict,
        summary=summary(verdict, found, remains, untestable, since, judged, heat.is_resolved, quick),
        stages=[stage for link in linked for stage in _stages(work, *link, selections)],
        effects=found,
        unexplained=remains,
        untestable=untestable,
        tried=[each for selection in selections for each in _tried(selection, found)],
        closed_loop=_closed_loop(work, selections),
        waterfall=[step for selection in selections for step in _waterfall(selection)],
        next_measurements=list(next_measurements(cut, found, untestable, stages, work.record)),
        warnings=[
            *work.dataset.warnings,
            *doubts_of_sampling(work.record, cut),
            *warned(selections),
            *_of_baseline(work, [each for each in cut if each not in short]),
        ],
        assumptions=[
            *work.dataset.assumptions,
            *filled_in(work.dataset, work.record, built(work.dataset.room) if work.dataset.room else None),
            *logged(selections),
            *needless(selections),
        ],
        departures=_departures(selections),
        parts=_parts(work, selections) if selections else {},
        seed=work.seed,
        is_quick=quick,
        begins=(work.dataset.time[0] - pd.Timedelta(seconds=work.dataset.interval_s)).isoformat(),
        compared_with=_days(work.baseline) if work.baseline else "",
        as_built=list(calibrated(work.calibration, work.documented)) if work.calibration else [],
        baseline=list(fits(work.calibration)) if work.calibration else [],
        missing_heat=heat,
        posterior=joint(beliefs),
        not_judged=judged.not_judged,
        traces=traces(work.record, work.dataset.time, selections),
    )


def _days(baseline: Dataset) -> str:
    first, last = baseline.days[[0, -1]].strftime("%Y-%m-%d")
    return f"{baseline.name}, {first} to {last}"


def _amiss(selection: Selection, left: Unexplained) -> float:
    """Return how probable it is that something unknown, or where it has no name anything, is amiss at a link."""
    return 1.0 - left.p if left.is_nameless else _held(selection, UNKNOWN)


def _held(selection: Selection, name: str) -> float:
    """Return how probable an effect, or something unknown, is at a link; no number where rules judged it."""
    if not selection.posterior:
        return nan
    return sum(probability for names, probability in selection.posterior.items() if name in names.split("+"))


def _missing_heat(work: Work, selections: Sequence[Selection]) -> MissingHeat:
    of_room = next((each for each in selections if each.segment.with_room), None)
    return missing_heat(of_room, work.calibration, work.dataset.time) if of_room else MissingHeat()


def _of_baseline(work: Work, cut: Sequence[Segment]) -> Iterator[str]:
    """Yield what is to be said of the healthy record."""
    if work.calibration is None:
        return
    yield from doubts(work.calibration, work.documented)
    for segment in (each for each in cut if not each.is_supply):
        if (healthy := work.calibration.healthy.get(segment.name)) is None:
            yield f"too little happened at {segment.name} in the baseline: it is compared with what is stated"
            continue
        yield from change_of_meter(segment, work.record, healthy)
        judged = {each.channel for each in healthy.fitted.residuals}
        for channel in (each for each in segment.judged if each not in judged):
            yield f"the baseline cannot judge {channel} at {segment.name}: what is off there may have been so before"


def _found(selection: Selection, seed: int) -> Iterator[FoundEffect]:
    random = np.random.default_rng([seed, 2])
    for found, without in zip(selection.found, selection.without, strict=True):
        channel = found.channel
        before, after = (model.residual_of(channel) for model in (without, selection.after))
        floor = selection.floor.plain[channel]
        values = {name: each.value for name, each in selection.intervals[found.effect].items()}
        yield FoundEffect(
            name=found.effect.name,
            stage=found.effect.stage,
            sentence=_sentence(selection, found.effect, values),
            slight=slight(selection, found),
            group=list(found.group),
            parameters=selection.intervals[found.effect],
            inclusion=found.inclusion,
            p=found.candidate.evidence.p,
            channel=channel,
            gap_before=before.gap(),
            gap_after=after.gap(),
            noise_floor=floor,
            shrink=shrink(before, after, floor, random),
            is_held_out=not selection.posterior and bool((before.part == SHRINK).any()),
            alternatives=[_alternative(each) for each in found.others],
            probability=found.inclusion if selection.posterior else nan,
            when=_when(found, values, selection.problem.record),
            at_end=Space(found.effect).at_end(values),
        )


def _sentence(selection: Selection, effect: EffectType, values: Values) -> str:
    """Return what an effect says; of the supply's own link, how far the recorded one is from its heating curve."""
    parameters, belief = effect.Parameters(**values), selection.problem.belief
    if not selection.segment.is_supply:
        return effect.sentence(parameters)
    there = effect.apply(belief, parameters).inputs
    assert there
    assert belief.inputs
    offset_K = float(np.mean(there.supply_C - belief.inputs.supply_C))
    return f"The recorded supply is {abs(offset_K):.1f} K {'above' if offset_K > 0.0 else 'below'} the heating curve."


def _when(found: Found, values: Values, record: Record) -> When:
    if found.pattern is None:
        return when(found.effect, values, record)
    return When(found.pattern.words, list(found.pattern.spans_h))


def _alternative(candidate: Candidate) -> Alternative:
    effect, values = candidate.effect, dict(candidate.fitted.effects)[candidate.effect]
    parameters = {name: Interval(value, np.nan, np.nan) for name, value in values.items()}
    return Alternative(effect.name, effect.stage, effect.sentence(effect.Parameters(**values)), parameters)


def _stages(
    work: Work, selection: Selection, beliefs: Mapping[str, float], selections: Sequence[Selection]
) -> Iterator[StageGap]:
    segment = selection.segment
    believed = _believed(work, selections, is_after=False)
    for before, after in zip(selection.before.residuals, selection.after.residuals, strict=True):
        yield StageGap(
            stage=stage_of(selection, before.channel),
            channel=before.channel,
            unit=before.unit,
            gap=before.gap(),
            gap_after=after.gap(),
            noise_floor=selection.floor.plain[before.channel],
            impact=_impact(work, selection, believed, before.channel),
            regimes=regimes(work.record, work.belief, before),
            autocorrelation=_autocorrelation(before.error[before.judged]),
            separate_by=", ".join(separating(segment)),
            posterior=beliefs,
        )


def _impact(work: Work, selection: Selection, believed: Belief, channel: str) -> Mapping[str, float]:
    segment, before = selection.segment, selection.before
    if segment.with_room:
        air = [each.gap() for each in before.residuals if each.channel == "air_temperature_C"]
        return {"air_K": air[0]} if air else {}
    if channel != segment.judged[-1]:
        return {}
    belief = selection.problem.edited(before.effects, before.departures)
    modelled = selection.problem.predicted(belief, before.convention)[channel]
    return impact(work.record, believed, segment, modelled)


def _autocorrelation(error: np.ndarray) -> float:
    centred = error - error.mean() if len(error) > 2 else np.zeros(1)
    power = float(centred @ centred)
    return float(centred[1:] @ centred[:-1]) / power if power else 0.0


def _tried(selection: Selection, effects: Sequence[FoundEffect]) -> Iterator[Tried]:
    named = {name for effect in effects for name in effect.group}
    # one that was weighed at certain hours, too, is told once, as it gains most
    once = {each.effect.name: each for each in sorted(selection.tried, key=lambda c: c.evidence.gain)}
    for each in sorted(once.values(), key=lambda c: -c.evidence.gain):
        evidence = each.evidence
        figures = evidence.gain, evidence.p, evidence.share
        why = "" if each.effect.name in named else why_not(selection, each)
        held = _held(selection, each.effect.name)
        yield Tried(each.effect.name, each.effect.stage, *figures, evidence.channel, why, held)


def _untestable(
    work: Work, cut: Sequence[Segment], short: Mapping[Segment, str], selections: Sequence[Selection]
) -> Iterator[Untestable]:
    yield from uncovered(work.effects, cut, work.record, work.belief)
    looked_at = [each for each in selections if not each.segment.is_supply]
    tried = [effect for selection in looked_at for effect in of_segment(selection.segment, work.effects)]
    for segment, reason in short.items():
        for effect in of_segment(segment, work.effects):
            if effect not in tried and not effect.hindrance(work.belief):
                yield Untestable(effect.name, reason, Lack.TOO_LITTLE)
    for selection in looked_at:
        yield from unshown(selection, of_segment(selection.segment, work.effects))


def _verdict(
    found: Sequence[FoundEffect],
    remains: Sequence[Unexplained],
    selections: Sequence[Selection],
    untestable: Sequence[Untestable],
) -> Verdict:
    if any(len(effect.group) == 1 for effect in found):
        return "effect"
    if found:
        return "group"
    if any(each.is_finding for each in remains):
        return "unknown"
    return "none" if _tested(selections, untestable) else "untestable"


def _tested(selections: Sequence[Selection], untestable: Sequence[Untestable]) -> set[str]:
    """Return the effects that the record could show."""
    looked_at = [each for each in selections if not each.segment.is_supply]
    tried = {each.effect.name for selection in looked_at for each in selection.tried}
    return tried - {each.name for each in untestable}


def _judged(selections: Sequence[Selection], untestable: Sequence[Untestable], stages: Mapping[str, str]) -> Stages:
    judged = {stages[name] for name in _tested(selections, untestable)}
    others = {stages[each.name] for each in untestable} - judged
    return Stages(*([stage for stage in STAGES if stage in some] for some in (judged, others)))


def _believed(work: Work, selections: Sequence[Selection], is_after: bool) -> Belief:
    """Return what is believed, its room as fitted and its sun as read, with or without the effects found."""
    belief = work.belief
    # what lies between the heating curve and the recorded supply is in the record already
    of_loop = [each for each in selections if not each.segment.is_supply]
    for selection in sorted(of_loop, key=lambda s: not s.segment.with_room):
        model = selection.after if is_after else selection.before
        if selection.segment.with_room:
            belief = selection.problem.edited((), model.departures)
            assert belief.inputs
            factor = model.convention.solar_factor
            belief = replace(belief, inputs=replace(belief.inputs, solar_W=factor * belief.inputs.solar_W))
        belief = with_effects(belief, model.effects)
    return belief


def _closed_loop(work: Work, selections: Sequence[Selection]) -> Mapping[str, BeforeAfter]:
    has_room = any(selection.segment.with_room for selection in selections)
    if not has_room or "controller" not in work.belief.blocks or not work.record.has("setpoint_C"):
        return {}
    before, after = (_believed(work, selections, is_after) for is_after in (False, True))
    return closed_loop(work.record, before, after)


def _waterfall(selection: Selection) -> Iterator[Step]:
    names = ["", *(found.effect.name for found in selection.found)]
    for name, model in zip(names, selection.models, strict=True):
        for residual in model.residuals:
            yield Step(residual.channel, residual.unit, name, residual.gap())


def _departures(selections: Sequence[Selection]) -> Mapping[str, float]:
    ends = [(selection.problem, selection.after.departures) for selection in selections]
    pairs = chain.from_iterable(zip(problem.nuisances, there / problem.sd, strict=True) for problem, there in ends)
    return {unknown.name: float(value) for unknown, value in pairs}


def _parts(work: Work, selections: Sequence[Selection]) -> Mapping[str, Sequence[str]]:
    """Return first and last day of each part, as the chain has them; a room alone has days in turn."""
    has_chain = any(not each.segment.with_room and not each.segment.is_supply for each in selections)
    holds_out = all(each.problem.holds_out for each in selections)
    part = parts_of(work.record, days_in_turn=not has_chain, holds_out=holds_out)
    days = (work.dataset.time - pd.Timedelta(1, "s")).strftime("%Y-%m-%d")  # midnight ends a day
    found = {}
    for name, number in (("fit", FIT), ("select", SELECT), ("shrinkage", SHRINK)):
        chosen = np.flatnonzero(part == number)
        if len(chosen):
            found[name] = [str(days[chosen[0]]), str(days[chosen[-1]])]
    return found
