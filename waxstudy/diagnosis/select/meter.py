"""A meter that has come to tell a flow in coarser steps since the healthy record: in pulses, or rounded."""

from __future__ import annotations

from collections.abc import Iterator
from math import log

from waxstudy.diagnosis.calibration.healthy import Healthy
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.observations.record import FLOW, Record
from waxstudy.diagnosis.weights import WEIGHTS


def coarser_steps(segment: Segment, record: Record, healthy: Healthy) -> float:
    """Return by how much larger the steps are in which a flow is told now, in standard deviations; else 0.

    How far a flow strays tells nothing of it: it is judged by means between pulses, and rounding counts as noise.
    """
    if FLOW not in segment.judged:
        return 0.0
    now_L_h, usual_L_h = record.flow_step_L_h, healthy.step_L_h(record.interval_s)
    return log(now_L_h / usual_L_h) / WEIGHTS.coarse_scatter if 0.0 < usual_L_h < now_L_h else 0.0


def change_of_meter(segment: Segment, record: Record, healthy: Healthy) -> Iterator[str]:
    """Yield what is to be said of a flow that is told in much coarser steps than before."""
    if coarser_steps(segment, record, healthy) > 1.0:
        steps = f"{_steps(record)}, in the baseline {_steps(healthy.problem.record)}"
        yield f"{FLOW} comes in {steps}: its meter or logger is another one"


def _steps(record: Record) -> str:
    if record.pulses:
        return f"pulses of {record.pulse_L:.3g} L"
    return f"steps of {record.flow_step_L_h:.3g} L/h" if record.flow_step_L_h else "no steps"
