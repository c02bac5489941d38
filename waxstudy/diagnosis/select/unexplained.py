"""What remains at a segment that nothing of the library explains, and whether that is a finding."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from waxstudy.diagnosis.calibration.healthy import together
from waxstudy.diagnosis.criteria import Question, held, limit, limits, meets
from waxstudy.diagnosis.estimate.hypothesis import Residual
from waxstudy.diagnosis.observations.record import OUTPUT
from waxstudy.diagnosis.result import Unexplained, When, in_floors
from waxstudy.diagnosis.select.evidence import Left, departure, travel_left
from waxstudy.diagnosis.select.null import by_block, redrawn
from waxstudy.diagnosis.select.patterns import concentrated
from waxstudy.diagnosis.select.posterior import NONE, UNKNOWN
from waxstudy.diagnosis.select.search import Found, Selection
from waxstudy.diagnosis.select.thermostat import when_past_switch
from waxstudy.diagnosis.weights import WEIGHTS

DRAWS = 1000


def unexplained(selection: Selection, seed: int) -> Iterator[Unexplained]:
    """Yield the channels of a segment whose gap stays over its floor in 99 % of the ways to draw its cycles or days."""
    if selection.segment.is_supply:
        return  # the curve is only looked at for a shift
    if selection.posterior:
        yield from _unknown(selection)
        return
    random = np.random.default_rng([seed, 3])
    for residual in selection.after.residuals:
        floor = selection.floor.plain[residual.channel]
        left = _left(residual, floor, random)
        if meets(Question.UNKNOWN, left) and residual.channel not in selection.slight:
            yield _described(selection, residual, floor, left)


def _unknown(selection: Selection) -> Iterator[Unexplained]:
    """Yield the channel of a link that is missed by most, where something unknown is likelier there than not.

    Or where something is surely amiss and has no name. Else those that a motor is missed by, as far as real ones stray.
    """
    floor = selection.floor.plain
    unknown = sum(p for names, p in selection.posterior.items() if UNKNOWN in names.split("+"))
    nothing = selection.posterior.get(NONE, 0.0)
    is_nameless = not selection.found and nothing < 1.0 - WEIGHTS.named
    if unknown < WEIGHTS.likelier and not is_nameless:
        yield from _strayed(selection, unknown)
    else:
        off_by = selection.off_by if selection.off_by and selection.off_by.told > 0.0 else None
        worst = max(selection.after.residuals, key=lambda each: in_floors(each.gap(), floor[each.channel]))
        worst = next((each for each in selection.after.residuals if off_by and each.channel == off_by.channel), worst)
        stage = stage_of(selection, worst.channel)
        once = when_past_switch(selection.problem, selection.after) if worst.channel == OUTPUT else None
        course = None if once or off_by else concentrated(worst, together(worst), selection.problem.record)
        when = When(course.words, list(course.spans_h)) if course else once
        gap = worst.gap(), floor[worst.channel]
        is_nameless &= unknown < WEIGHTS.likelier
        p = nothing if is_nameless else 1.0 - unknown
        like = off_by.words if off_by else ""
        yield Unexplained(stage, *gap, p, channel=worst.channel, when=when, like=like, is_nameless=is_nameless)


def _strayed(selection: Selection, unknown: float) -> Iterator[Unexplained]:
    """Yield the channels that no healthy record shows, and that are missed by as far as real motors stray."""
    problem, after = selection.problem, selection.after
    known = problem.as_built.left_of(problem.segment.name) if problem.as_built else {}
    for residual in (each for each in after.residuals if each.channel not in known):
        gap, floor = residual.gap(), selection.floor.plain[residual.channel]
        is_gap = in_floors(gap, floor) > limit(Question.UNKNOWN, "over")
        if is_gap and travel_left(problem, after, residual) <= limits()["tolerated"].value:
            stage = stage_of(selection, residual.channel)
            yield Unexplained(stage, gap, floor, 1.0 - unknown, is_covered=True, channel=residual.channel)


def _left(residual: Residual, floor: float, random: np.random.Generator) -> Left:
    p = _p(residual, limit(Question.UNKNOWN, "over") * floor, random)
    return Left(over=in_floors(residual.gap(), floor), p=p)


def _described(selection: Selection, residual: Residual, floor: float, left: Left) -> Unexplained:
    gap = residual.gap()
    of_drives = in_floors(gap, done_by_drives(selection, residual))
    excused = held(Question.EXCUSED, replace(left, over_form=in_floors(gap, residual.form), of_drives=of_drives))
    form, drives = excused["over_form"], excused["of_drives"]
    # what a model's form does not leave may as well lie in the emitter
    stage = stage_of(selection, residual.channel) if form else selection.segment.name
    return Unexplained(stage, gap, floor, left.p, form, is_of_drives=drives, channel=residual.channel)


def slight(selection: Selection, found: Found) -> str:
    """Return why an effect that is there hardly matters, or an empty text."""
    problem, last, effect = selection.problem, selection.after, found.effect
    without = problem.belief_without(last, effect)
    values = {name: each.value for name, each in selection.intervals[effect].items()}
    is_slight = departure(effect, values, without) <= limits()["step"].value
    return "less than is noticeable" if is_slight else ""


def done_by_drives(selection: Selection, residual: Residual) -> float:
    """Return what drives that nobody recorded do to a channel as they were fitted (root mean square, in its unit).

    Another course of them could leave a part of that.
    """
    problem, after = selection.problem, selection.after
    if not problem.record.stand_ins or not residual.judged.any():
        return 0.0
    without = problem.without_stand_ins(after).residual_of(residual.channel)
    return float(np.sqrt(np.mean((without.error - residual.error)[residual.judged] ** 2)))


def _p(residual: Residual, threshold: float, random: np.random.Generator) -> float:
    """Return how often the mean square over redrawn blocks does not exceed the threshold's."""
    chosen = residual.judged
    squares, count = by_block(np.array([residual.error[chosen] ** 2, np.ones(chosen.sum())]), residual.block[chosen])
    if len(count) < limit(Question.JUDGE, "blocks"):
        return 1.0
    weights = redrawn(len(count), DRAWS, random)
    means = (weights @ squares) / np.maximum(weights @ count, 1)
    return float((1 + np.sum(means <= threshold**2)) / (1 + DRAWS))


def stage_of(selection: Selection, channel: str) -> str:
    """Return the merged stages that lie behind a channel of a segment."""
    segment = selection.segment
    if channel == "sensor_temperature_C":
        return "sensor"
    if segment.with_room:
        return "room" if segment.stages[0] == "emitter" else segment.name
    is_judged_twice = segment.stages[:2] == ("sensor", "controller") and len(segment.judged) > 1
    if is_judged_twice and not selection.after.convention.is_before:
        return "+".join(segment.stages[1:])
    return segment.name
