"""A meter that has come to tell a flow in coarser steps since the healthy record: in pulses, or rounded."""

from __future__ import annotations

from collections.abc import Iterator
from math import log

import numpy as np

from waxstudy.dataset.limits import ODD_PULSES, WHOLE_PULSE
from waxstudy.diagnosis.calibration.healthy import Healthy
from waxstudy.diagnosis.model.segments import Segment
from waxstudy.diagnosis.observations.record import FLOW, Record
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import FloatArray


def coarser_steps(segment: Segment, record: Record, healthy: Healthy) -> float:
    """Return by how much larger the steps are in which a flow is told now, in standard deviations; else 0.

    How far a flow strays tells nothing of it: it is judged by means between pulses, and rounding counts as noise.
    """
    if FLOW not in segment.judged or healthy.is_noise:
        return 0.0
    before = healthy.problem.record
    # what a pulse would be written as in samples of the healthy record
    now_L_h = record.pulse_L * 3600.0 / before.interval_s if record.pulses else record.flow_step_L_h
    usual_L_h = max(before.noise[FLOW], before.flow_step_L_h) if before.has(FLOW) else 0.0
    if not 0.0 < usual_L_h < now_L_h or (record.pulses and _is_whole(before.values[FLOW], now_L_h)):
        return 0.0
    return log(now_L_h / usual_L_h) / WEIGHTS.coarse_scatter


def _is_whole(flow: FloatArray, step_L_h: float) -> bool:
    """Whether a flow (n,) may have been counted in such steps too: nearly all of it is whole ones of them."""
    steps = flow[flow > 0.0] / step_L_h
    return float(np.mean(np.abs(steps - np.round(steps)) <= WHOLE_PULSE)) >= 1.0 - ODD_PULSES if len(steps) else False


def change_of_meter(segment: Segment, record: Record, healthy: Healthy) -> Iterator[str]:
    """Yield what is to be said of a flow that is told in much coarser steps than before."""
    if coarser_steps(segment, record, healthy) > 1.0:
        steps = f"{_steps(record)}, in the baseline {_steps(healthy.problem.record)}"
        yield f"{FLOW} comes in {steps}: its meter or logger is another one"


def _steps(record: Record) -> str:
    if record.pulses:
        return f"pulses of {record.pulse_L:.3g} L"
    return f"steps of {record.flow_step_L_h:.3g} L/h" if record.flow_step_L_h else "no steps"
