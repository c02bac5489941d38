"""When a gap shows: the phases of the actuator for the chain, sun and heating for sensor and room."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Residual
from waxstudy.diagnosis.model.travel import SIGNALS, opening, signal_of
from waxstudy.diagnosis.observations.noise import ON
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.result import Regime
from waxstudy.plugin import Belief, FloatArray

MOVING = (0.03, 0.97)  # openings between which an actuator moves
LONG_PAUSE_S = 6 * 3600.0
SUNNY = 0.2  # of the strongest sun in the record
NIGHT_H = (22.0, 6.0)
PHASES = ("dead", "rise", "overheat", "hold", "fall", "undercool")


def regimes(record: Record, belief: Belief, residual: Residual) -> Sequence[Regime]:
    """Return the regimes of a channel's error, those with most of it first."""
    masks = of_chain(record, belief) if residual.channel in CHAIN_CHANNELS else of_room(record)
    total = float(residual.error @ residual.error)
    found = []
    for name, mask in masks.items():
        chosen = residual.judged & mask[residual.sample]
        if chosen.sum() > 2:
            square = float(residual.error[chosen] @ residual.error[chosen])
            share = square / total if total > 0.0 else 0.0
            found.append(Regime(name, float(np.sqrt(square / chosen.sum())), share))
    return sorted(found, key=lambda regime: -regime.share)


CHAIN_CHANNELS = ("displacement", "flow_L_h", "heating_signal", "control_output")


def of_chain(record: Record, belief: Belief) -> Mapping[str, np.ndarray]:
    """Return the phases of the actuator, after the recorded displacement or else the believed one."""
    channel = signal_of(record)
    if not channel:
        return of_room(record)
    on = record.filled(channel) > ON
    travel = record.filled("displacement") if record.has("displacement") else opening(record, belief)
    if travel is None:
        return {"heating": on, "pause": ~on} | _after_long_pause(record, on)
    closed, full = travel < MOVING[0], travel > MOVING[1]
    moving = ~closed & ~full
    phases = (on & closed, on & moving, on & full, ~on & full, ~on & moving, ~on & closed)
    return dict(zip(PHASES, phases, strict=True)) | _after_long_pause(record, on)


def _after_long_pause(record: Record, on: np.ndarray) -> dict[str, np.ndarray]:
    """Return the heating that follows a long pause."""
    at = np.arange(len(on))
    last_on = np.maximum.accumulate(np.where(on, at, -1))
    starts = on & np.concatenate(([False], ~on[:-1]))
    before = np.concatenate(([-1], last_on[:-1]))
    long = starts & (at - before > LONG_PAUSE_S / record.interval_s) & (before >= 0)
    number = np.cumsum(starts)
    return {"after a long pause": on & np.isin(number, number[long])}


def of_room(record: Record) -> Mapping[str, np.ndarray]:
    """Return sun, heating and night."""
    count = len(record)
    hour = (record.start_s + (np.arange(count) + 0.5) * record.interval_s) % 86_400.0 / 3600.0
    masks = {"night": (hour >= NIGHT_H[0]) | (hour < NIGHT_H[1])}
    if record.has("solar_gain_W") and record.filled("solar_gain_W").max() > 0.0:
        sun = record.filled("solar_gain_W")
        masks |= {"sun": sun > SUNNY * sun.max()}
    heating = _heating(record)
    return masks if heating is None else masks | {"heating": heating, "pause": ~heating}


def _heating(record: Record) -> np.ndarray | None:
    for channel in ("flow_L_h", *SIGNALS):
        if record.has(channel):
            values: FloatArray = record.filled(channel)
            return np.asarray(values > 0.5 * max(float(values.max()), 1e-9))
    return None
