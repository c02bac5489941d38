"""What remains at a segment that nothing of the library explains, and whether that is a finding."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from waxstudy.diagnosis.model.room_response import ROOM_FORM_K
from waxstudy.diagnosis.model.travel import opening_difference_s, tolerated_s
from waxstudy.diagnosis.residuals.judge import Residual
from waxstudy.diagnosis.result import Unexplained
from waxstudy.diagnosis.select.criteria import LEAST_SMOOTHED_GAP, runs_on
from waxstudy.diagnosis.select.null import by_block
from waxstudy.diagnosis.select.search import Selection
from waxstudy.diagnosis.select.testability import LEAST_BLOCKS

LEAST_EXCESS = 1.5  # of what is left over the noise floor
LEVEL = 0.01
DRAWS = 1000
COURSE_SHARE = 0.5  # chosen: of what a drive does, that a course of another shape may leave
LEAST_TYPICAL = 2.5  # standard deviations by which what makes up a gap is off


def unexplained(selection: Selection, seed: int) -> Iterator[Unexplained]:
    """Yield the channels of a segment whose gap stays over its floor in 99 % of the ways to draw its cycles or days."""
    if selection.fitter.segment.is_supply:
        return  # the curve is only looked at for a shift
    random = np.random.default_rng([seed, 3])
    for residual in selection.after.residuals:
        floor, white = selection.floor.plain[residual.channel], selection.floor.white[residual.channel]
        # by what each switch and sample can be known to: one that hangs on noise says little
        weighed = residual if selection.fitter.segment.with_room else replace(residual, error=residual.whitened)
        least = LEAST_SMOOTHED_GAP if runs_on(residual.channel, residual.unit) else LEAST_EXCESS
        p = _p(weighed, least * (floor if weighed is residual else white), random)
        is_large = residual.gap() > least * floor and residual.channel not in selection.slight
        if p <= LEVEL and is_large and (weighed is residual or carried_by(weighed) >= LEAST_TYPICAL):
            yield _described(selection, residual, floor, p)


def _described(selection: Selection, residual: Residual, floor: float, p: float) -> Unexplained:
    stage = stage_of(selection, residual.channel)
    is_room = selection.fitter.segment.with_room
    form = is_room and residual.gap() <= ROOM_FORM_K.get(residual.channel, 0.0)
    covered = not is_room and is_covered(selection, residual)
    if is_room and not form:
        stage = selection.fitter.segment.name  # what a model's form does not leave may as well lie in the emitter
    drives = is_room and residual.gap() <= reach_of_drives(selection, residual)
    return Unexplained(stage, residual.gap(), floor, p, form, covered, drives, residual.channel)


def reach_of_drives(selection: Selection, residual: Residual) -> float:
    """Return what the course of drives that nobody recorded may leave of a channel, in its unit.

    Their size was fitted; of what they do, by the hour, a part may still be missed (root mean square).
    """
    fitter, after = selection.fitter, selection.after
    if not fitter.record.stand_ins or not residual.judged.any():
        return 0.0
    belief = fitter.edited(after.effects, after.departures)
    assert belief.inputs
    none: dict[str, Any] = dict.fromkeys(belief.inputs.stand_ins, np.zeros(len(belief.inputs.solar_W)))
    still = fitter.predicted(replace(belief, inputs=replace(belief.inputs, **none)), after.convention)
    without = next(each for each in fitter.judge.residuals(still) if each.channel == residual.channel)
    return COURSE_SHARE * float(np.sqrt(np.mean((without.error - residual.error)[residual.judged] ** 2)))


def carried_by(whitened: Residual) -> float:
    """Return the standard deviations by which those samples are off that make up the gap; of mere noise root 3."""
    squares = whitened.error[whitened.judged] ** 2
    return float(np.sqrt(np.sum(squares**2) / max(float(np.sum(squares)), 1e-12)))


def _p(residual: Residual, threshold: float, random: np.random.Generator) -> float:
    """Return how often the mean square over redrawn blocks does not exceed the threshold's."""
    chosen = residual.judged
    numbers, member = np.unique(residual.block[chosen], return_inverse=True)
    if len(numbers) < LEAST_BLOCKS:
        return 1.0
    squares = by_block(np.array([residual.error[chosen] ** 2]), member, len(numbers))[0]
    count = np.bincount(member, minlength=len(numbers))
    weights = random.multinomial(len(numbers), np.full(len(numbers), 1.0 / len(numbers)), DRAWS)
    means = (weights @ squares) / np.maximum(weights @ count, 1)
    return float((1 + np.sum(means <= threshold**2)) / (1 + DRAWS))


def is_covered(selection: Selection, residual: Residual) -> bool:
    """Whether an actuator is missed by no more, per switch, than real ones stray from it, or than sampling tells."""
    fitter = selection.fitter
    allowed = tolerated_s(fitter.record, fitter.edited(selection.after.effects, selection.after.departures))
    if residual.channel not in ("displacement", "flow_L_h") or "actuator" not in fitter.segment.stages:
        return False
    full = 1.0 if residual.channel == "displacement" else float(np.nanmax(fitter.record.values["flow_L_h"]))
    beyond_noise = np.abs(residual.error) > 4.0 * fitter.record.noise[residual.channel]
    return opening_difference_s(fitter.record, residual.error * beyond_noise / full) <= allowed


def stage_of(selection: Selection, channel: str) -> str:
    """Return the merged stages that lie behind a channel of a segment."""
    segment = selection.fitter.segment
    if channel == "sensor_temperature_C" and len(segment.judged) > 1:
        return "sensor"
    if segment.with_room:
        return "room" if segment.stages[0] == "emitter" else segment.name
    if (
        segment.stages[:2] == ("sensor", "controller")
        and not selection.after.convention.is_before
        and len(segment.judged) > 1
    ):
        return "+".join(segment.stages[1:])
    return segment.name
