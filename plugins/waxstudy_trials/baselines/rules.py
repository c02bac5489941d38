"""Rules: what an experienced engineer looks at first, one figure and one threshold each."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.diagnose import installed_effects
from waxstudy.diagnosis.model.room_response import full_flow_L_h
from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import Belief
from waxstudy_trials.baselines import Json, answer, taken

LATE = ("delay_s", "time_constant_s")  # of a believed sensor, by which it comes late
Hits = Iterator[tuple[str, Mapping[str, float]]]


def diagnose(dataset: Dataset) -> Json:
    """Return what every rule that hits says."""
    record, belief = taken(dataset)
    effects = {effect.name: effect for effect in installed_effects()}
    found = [(name, values) for rule in RULES for name, values in rule(record, belief)]
    fitting = [(effects[n], v) for n, v in found if n in effects and not effects[n].hindrance(belief)]
    return answer(dataset, fitting)


def sensor(record: Record, belief: Belief) -> Hits:
    """A convention that is off by 0.05 K on average is biased; one that comes a minute late is delayed."""
    if not (record.has("sensor_temperature_C") and record.has("air_temperature_C")):
        return
    convention, air = record.drive("sensor_temperature_C"), record.drive("air_temperature_C")
    if abs(bias_K := float(np.mean(convention - air))) > 0.05:
        yield "sensor-bias", {"bias_K": bias_K}
    late_s = _late_s(convention, air, record.interval_s)
    known_s = sum(belief.value("sensor", each) for each in LATE if belief.has("sensor", each))
    if late_s > known_s + max(60.0, record.interval_s):
        yield "sensor-delay", {"delay_s": late_s}


def _late_s(convention: np.ndarray, air: np.ndarray, interval_s: float) -> float:
    """Return the delay at which two courses are most alike, up to half an hour."""
    most = max(1, round(1800.0 / interval_s))
    spread = [float(np.std(convention[n:] - air[: len(air) - n])) for n in range(most)]
    return float(np.argmin(spread)) * interval_s


def dead_band(record: Record, belief: Belief) -> Hits:
    """Readings at switching on and off lie further apart than the dead band."""
    is_there = record.has("sensor_temperature_C") and "control_output" in record.binary
    if not (is_there and belief.has("controller", "dead_band_K")):
        return
    convention, step = record.drive("sensor_temperature_C"), np.diff(record.filled("control_output"))
    on, off = convention[:-1][step > 0.0], convention[:-1][step < 0.0]
    if len(on) > 3 and len(off) > 3:
        width_K = float(np.median(off) - np.median(on))
        if abs(width_K - belief.value("controller", "dead_band_K")) > 0.15 and 0.05 < width_K < 3.0:
            yield "dead-band", {"dead_band_K": width_K}


def pulses(record: Record, belief: Belief) -> Hits:
    """Pulses come at another distance than the period, or are never as short as they may be."""
    if "heating_signal" not in record.binary or not belief.has("modulator", "period_s"):
        return
    signal = record.filled("heating_signal")
    starts = np.flatnonzero(np.diff(signal) > 0.0)
    if len(starts) > 5:
        period_s = float(np.median(np.diff(starts))) * record.interval_s
        if abs(period_s / belief.value("modulator", "period_s") - 1.0) > 0.1:
            yield "pwm-period", {"period_s": period_s}


def travel(record: Record, belief: Belief) -> Hits:
    """The opening never gets far, or takes long."""
    if not (record.has("displacement") and "heating_signal" in record.binary):
        return
    opening, signal = record.drive("displacement"), record.filled("heating_signal")
    most = float(np.quantile(opening, 0.999))
    if 0.1 < most < 0.95:
        yield "limited-travel", {"opening": most}
    moving_s = float(np.mean((opening > 0.1 * most) & (opening < 0.9 * most))) * len(opening) * record.interval_s
    switches = np.count_nonzero(np.diff(signal))
    if switches and "actuator" not in belief.blocks and moving_s / switches > 60.0:
        yield "wax-motor", {}
    elif switches and moving_s / switches > 220.0:
        yield "slow-actuator", {"factor": moving_s / switches / 110.0}


def flow(record: Record, belief: Belief) -> Hits:
    """Water flows though the valve is closed, or another flow than agreed though it is open."""
    if not (record.has("flow_L_h") and record.has("displacement")):
        return
    opening, seen = record.drive("displacement"), record.filled("flow_L_h")
    full = full_flow_L_h(record, belief)
    closed, is_open = opening <= 0.0, opening >= 1.0
    if closed.sum() > 30 and float(np.median(seen[closed])) > 0.01 * full:
        yield "let-by", {}
    if is_open.sum() > 30 and abs(factor := float(np.median(seen[is_open])) / full - 1.0) > 0.05:
        yield "max-flow", {"factor": 1.0 + factor}


RULES: tuple[Callable[[Record, Belief], Hits], ...] = (sensor, dead_band, pulses, travel, flow)
