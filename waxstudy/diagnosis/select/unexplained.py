"""What remains at a link that nothing of the library explains, and whether that is a finding."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from waxstudy.diagnosis.calibration.calibrate import together
from waxstudy.diagnosis.estimate.hypothesis import Residual
from waxstudy.diagnosis.model.travel import opening_difference_s, tolerated_s
from waxstudy.diagnosis.result import Unexplained, When, in_floors
from waxstudy.diagnosis.select.evidence import LIKELIER
from waxstudy.diagnosis.select.patterns import concentrated
from waxstudy.diagnosis.select.selection import Selection

SURELY = 4.0  # standard deviations of a channel's noise, beyond which a sample is off


def unexplained(selection: Selection) -> Iterator[Unexplained]:
    """Yield the channel of a link that is missed by most, where something unknown is likelier there than not."""
    if selection.segment.is_supply or selection.unknown < LIKELIER:
        return  # the heating curve is only looked at for a shift
    floor = selection.floor.plain
    worst = max(selection.after.residuals, key=lambda each: in_floors(each.gap(), floor[each.channel]))
    course = concentrated(worst, together(worst), selection.problem.record)
    yield Unexplained(
        stage=stage_of(selection, worst.channel),
        gap=worst.gap(),
        noise_floor=floor[worst.channel],
        p=1.0 - selection.unknown,
        is_covered=not selection.is_compared and _is_covered(selection, worst),
        channel=worst.channel,
        probability=selection.unknown,
        when=When(course.words, list(course.spans_h)) if course else None,
    )


def _is_covered(selection: Selection, residual: Residual) -> bool:
    """Whether an actuator is missed per switch by no more than real ones stray from the believed one."""
    problem, channel = selection.problem, residual.channel
    if channel not in ("displacement", "flow_L_h") or "actuator" not in problem.segment.stages:
        return False
    full = 1.0 if channel == "displacement" else float(np.nanmax(problem.record.values["flow_L_h"]))
    beyond_noise = np.abs(residual.error) > SURELY * problem.record.noise[channel]
    missed_s = opening_difference_s(problem.record, residual.error * beyond_noise / full)
    return missed_s <= tolerated_s(problem.record, problem.belief_of(selection.after))


def stage_of(selection: Selection, channel: str) -> str:
    """Return the merged stages that lie behind a channel of a segment."""
    segment = selection.segment
    if channel == "sensor_temperature_C" and len(segment.judged) > 1:
        return "sensor"
    if segment.with_room:
        return "room" if segment.stages[0] == "emitter" else segment.name
    is_judged_twice = segment.stages[:2] == ("sensor", "controller") and len(segment.judged) > 1
    if is_judged_twice and not selection.after.convention.is_before:
        return "+".join(segment.stages[1:])
    return segment.name
