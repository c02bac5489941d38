"""A meter that has come to count a flow in pulses, or in larger ones, since the healthy record."""

from __future__ import annotations

from collections.abc import Iterator
from math import log

from waxstudy.diagnosis.calibration.healthy import Healthy
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.observations.record import FLOW, Record
from waxstudy.diagnosis.weights import WEIGHTS


def coarser_steps(segment: Segment, record: Record, healthy: Healthy) -> float:
    """Return by how much larger the steps are in which a flow is counted now, in standard deviations; else 0.

    How far a flow strays tells nothing of it: counted in pulses, it is judged by its means between them.
    """
    now_L_h, usual_L_h = record.pulse_L_h, healthy.step_L_h(record.interval_s)
    if FLOW not in segment.judged or not 0.0 < usual_L_h < now_L_h:
        return 0.0
    return log(now_L_h / usual_L_h) / WEIGHTS.coarse_scatter


def change_of_meter(segment: Segment, record: Record, healthy: Healthy) -> Iterator[str]:
    """Yield what is to be said of a flow that comes in pulses, and did not, or in much smaller ones, before."""
    if coarser_steps(segment, record, healthy) > 1.0:
        before = healthy.problem.record.pulse_L
        then = f"in the baseline of {before:.3g} L" if before else "in the baseline it did not"
        yield f"{FLOW} comes in pulses of {record.pulse_L:.3g} L, {then}: its meter or logger is another one"
