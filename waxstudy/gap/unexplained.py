"""What remains at a link that nothing of the library explains, and whether that is a finding."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from waxstudy.gap.claim import LEAST_SMOOTHED_GAP, runs_on
from waxstudy.gap.judge import Errors
from waxstudy.gap.resampling import by_block
from waxstudy.gap.result import Unexplained
from waxstudy.gap.room import room_error
from waxstudy.gap.select import Selection
from waxstudy.gap.stray import allowed_s, moved_s
from waxstudy.gap.testable import LEAST_BLOCKS

LEAST_EXCESS = 1.5  # of what is left over the noise floor
LEVEL = 0.01
DRAWS = 1000
LEAST_TYPICAL = 2.5  # standard deviations by which what makes up a gap is off


def unexplained(selection: Selection, seed: int) -> Iterator[Unexplained]:
    """Yield the channels of a link whose gap stays over its floor in 99 % of the ways to draw its cycles or days."""
    if selection.fitter.link.is_supply:
        return  # the curve is only looked at for a shift
    random = np.random.default_rng([seed, 3])
    for errors in selection.after.errors:
        floor, white = selection.floor.plain[errors.channel], selection.floor.white[errors.channel]
        # by what each switch and sample can be known to: one that hangs on noise says little
        weighed = errors if selection.fitter.link.with_room else replace(errors, error=errors.whitened)
        least = LEAST_SMOOTHED_GAP if runs_on(errors.channel, errors.unit) else LEAST_EXCESS
        p = _p(weighed, least * (floor if weighed is errors else white), random)
        is_large = errors.gap() > least * floor and errors.channel not in selection.slight
        if p <= LEVEL and is_large and (weighed is errors or carried_by(weighed) >= LEAST_TYPICAL):
            yield _described(selection, errors, floor, p)


def _described(selection: Selection, errors: Errors, floor: float, p: float) -> Unexplained:
    stage = stage_of(selection, errors.channel)
    is_room = selection.fitter.link.with_room
    form = is_room and errors.gap() <= room_error(selection.fitter.belief, errors.channel).most_K
    covered = not is_room and is_covered(selection, errors)
    if is_room and not form:
        stage = selection.fitter.link.name  # what a model's form does not leave may as well lie in the emitter
    return Unexplained(stage, errors.gap(), floor, p, form, covered, errors.channel)


def carried_by(whitened: Errors) -> float:
    """Return the standard deviations by which those samples are off that make up the gap; of mere noise root 3."""
    squares = whitened.error[whitened.judged] ** 2
    return float(np.sqrt(np.sum(squares**2) / max(float(np.sum(squares)), 1e-12)))


def _p(errors: Errors, threshold: float, random: np.random.Generator) -> float:
    """Return how often the mean square over redrawn blocks does not exceed the threshold's."""
    chosen = errors.judged
    numbers, member = np.unique(errors.block[chosen], return_inverse=True)
    if len(numbers) < LEAST_BLOCKS:
        return 1.0
    squares = by_block(np.array([errors.error[chosen] ** 2]), member, len(numbers))[0]
    count = np.bincount(member, minlength=len(numbers))
    weights = random.multinomial(len(numbers), np.full(len(numbers), 1.0 / len(numbers)), DRAWS)
    means = (weights @ squares) / np.maximum(weights @ count, 1)
    return float((1 + np.sum(means <= threshold**2)) / (1 + DRAWS))


def is_covered(selection: Selection, errors: Errors) -> bool:
    """Whether an actuator is missed by no more, per switch, than real ones stray from it, or than sampling tells."""
    fitter = selection.fitter
    allowed = allowed_s(fitter.record, fitter.edited(selection.after.effects, selection.after.departures))
    if errors.channel not in ("displacement", "flow_L_h") or "actuator" not in fitter.link.stages:
        return False
    full = 1.0 if errors.channel == "displacement" else float(np.nanmax(fitter.record.values["flow_L_h"]))
    beyond_noise = np.abs(errors.error) > 4.0 * fitter.record.noise[errors.channel]
    return moved_s(fitter.record, errors.error * beyond_noise / full) <= allowed


def stage_of(selection: Selection, channel: str) -> str:
    """Return the merged stages that lie behind a channel of a link."""
    link = selection.fitter.link
    if channel == "sensor_temperature_C" and len(link.judged) > 1:
        return "sensor"
    if link.with_room:
        return "room" if link.stages[0] == "emitter" else link.name
    if link.stages[:2] == ("sensor", "controller") and not selection.after.reading.is_before and len(link.judged) > 1:
        return "+".join(link.stages[1:])
    return link.name
