"""How far an actuator's opening moves, beside what real actuators are known to stray from the believed one."""

from __future__ import annotations

import numpy as np

from waxstudy.diagnosis.model.opening_path import CELL_S
from waxstudy.diagnosis.model.segments import replayed
from waxstudy.diagnosis.observations.noise import ON
from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import Actuator, Belief, FloatArray

SIGNALS = ("heating_signal", "control_output")


def signal_of(record: Record) -> str:
    """Return the channel that tells what an actuator got, "" where none does: an output may go through a modulator."""
    otherwise = "heating_signal" if record.has("heating_signal") else ""
    return next((name for name in SIGNALS if name in record.binary), otherwise)


def is_within_stray(record: Record, believed: Belief, other: Belief) -> bool:
    """Whether another motor moves the opening by no more per switch than real ones stray from the believed one."""
    before, after = opening(record, believed), opening(record, other)
    if before is None or after is None:
        return False
    return opening_difference_s(record, before - after) <= tolerated_s(record, believed)


def tolerated_s(record: Record, belief: Belief) -> float:
    """Return what an opening may be off by per switch [s]: what real actuators stray, or when a sample was taken.

    The believed actuator's `stray_s` is the published |displacement error| integrated over a switch.
    """
    choice = belief.blocks.get("actuator")
    published_s = choice.component.stray_s if choice and issubclass(choice.component, Actuator) else 0.0
    return float(max(published_s, min(record.interval_s, CELL_S)))


def opening_difference_s(record: Record, difference: FloatArray) -> float:
    """Return the |difference| of two openings over time, per switch of the signal; infinite where nothing switches."""
    channel = signal_of(record)
    if not channel:
        return float("inf")
    switches = max(1, int(np.count_nonzero(np.diff(record.filled(channel) > ON))))
    return float(np.nansum(np.abs(difference)) * record.interval_s / switches)


def opening(record: Record, belief: Belief) -> FloatArray | None:
    """Return what the believed actuator makes of the recorded signal, None where no signal was recorded.

    Where none is believed the valve follows its signal.
    """
    channel = signal_of(record)
    if not channel:
        return None
    if "actuator" not in belief.blocks:
        return record.filled(channel)
    motor, signal = {"actuator": belief.blocks["actuator"]}, record.filled(channel)
    jump = np.full(len(record), 0.5) if channel in record.binary else None
    return replayed(motor, "actuator", signal, signal, record.interval_s, record.start_s, jump)[0]["actuator"]
