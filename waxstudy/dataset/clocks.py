"""Clock offsets between channels: an effect that comes before its cause was stamped by another clock."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from waxstudy.dataset.notes import Notes
from waxstudy.plugin import FloatArray

if TYPE_CHECKING:
    import pandas as pd

FEWEST_EDGES = 3
AGREEING = 0.7  # share of the edges that must tell of the same offset
LONGEST_S = 7200.0  # offsets that are looked for
CLEAR = 0.8  # the squared difference of two temperatures at their best offset, over that at none
FINEST_S = 30.0  # between two offsets
SMOOTH = 5  # samples over which temperatures are averaged
# cause, effect, and the levels that they cross together; a flow is taken relative to its largest.
# Just above closed: an opening and a flow that is not proportional to it begin together, and there only.
PAIRS = (
    ("control_output", "heating_signal", 0.5, 0.5),
    ("heating_signal", "displacement", 0.5, 0.5),
    ("heating_signal", "flow_L_h", 0.5, 0.5),
    ("displacement", "flow_L_h", 0.05, 0.05),
)


def look_at_clocks(values: pd.DataFrame, interval_s: float, has_modulator: bool, notes: Notes) -> None:
    """Warn of effects that come before their causes; refuse a signal and an opening that are swapped.

    A late effect is no offset: actuators, sensors and pipes take time. Only a controller without a modulator must
    agree with its signal.
    """
    for cause, effect, cause_level, effect_level in PAIRS:
        if not {cause, effect} <= set(values.columns):
            continue
        if cause == "control_output" and not (_is_binary(values[cause]) and _is_binary(values[effect])):
            continue  # a continuous output and a signal that switches have no edges in common
        late = _lateness(_switched(values[cause], cause_level), _switched(values[effect], effect_level), interval_s)
        if late is None or late == 0 or (late == -1 and effect == "flow_L_h"):
            continue  # a mean over an interval tells of an edge within it
        must_agree = cause == "control_output" and not has_modulator
        if late < 0 and effect == "displacement" and _is_binary(values[effect]) and not _is_binary(values[cause]):
            why = "the opening is 0 or 1 and comes first, the signal takes its time"
            notes.refuse(f"{cause}, {effect}", f"look swapped: {why}")
        elif late < 0 or must_agree:
            how = "before" if late < 0 else "after"
            reason = "no effect comes before its cause" if late < 0 else "without a modulator they are the same"
            shown = f"{abs(late)} samples ({abs(late) * interval_s:g} s) {how}"
            notes.warn(f"clock offset: {effect} changes {shown} {cause}, and {reason}")
    _tell_early_sensor(values, interval_s, notes)


def _is_binary(x: pd.Series) -> bool:
    return bool(x.dropna().isin([0.0, 1.0]).all())


def _switched(x: pd.Series, level: float) -> FloatArray:
    """Return 1 above a level, 0 below, NaN where missing."""
    values = x.to_numpy(dtype=float)
    largest = float(np.nanmax(values)) if x.name == "flow_L_h" and np.isfinite(values).any() else 1.0
    return np.where(np.isnan(values), np.nan, values > level * largest).astype(float)


def _lateness(cause: FloatArray, effect: FloatArray, interval_s: float) -> int | None:
    """Return by how many samples the effect's edges follow the cause's, None if they do not tell.

    Each rise of the cause is paired with the nearest rise of the effect, and falls with falls; the offset is that on
    which rises and falls agree. An actuator that takes long to open and to close is late in both.
    """
    lags = [_lags(cause, effect, direction, interval_s) for direction in (1.0, -1.0)]
    medians = []
    for found in lags:
        if len(found) < FEWEST_EDGES:
            return None
        median = round(float(np.median(found)))
        if np.mean(np.abs(found - median) <= 1) < AGREEING:
            return None
        medians.append(median)
    # early in both directions is early; a threshold that is crossed early one way is crossed late the other
    return max(medians) if max(medians) < 0 else max(0, min(medians))


def _lags(cause: FloatArray, effect: FloatArray, direction: float, interval_s: float) -> FloatArray:
    starts, ends = (np.flatnonzero(np.diff(x) == direction) for x in (cause, effect))
    longest = LONGEST_S / interval_s
    if not len(starts) or not len(ends):
        return np.array([])
    after = np.clip(np.searchsorted(ends, starts), 1, len(ends) - 1) if len(ends) > 1 else np.zeros(len(starts), int)
    before = np.maximum(after - 1, 0)
    nearest = np.where(starts - ends[before] < ends[after] - starts, ends[before], ends[after])
    lags = (nearest - starts).astype(float)
    return np.asarray(lags[np.abs(lags) <= longest])


def _tell_early_sensor(values: pd.DataFrame, interval_s: float, notes: Notes) -> None:
    """Warn of a sensor that knows the air temperature before it is there."""
    if not {"sensor_temperature_C", "air_temperature_C"} <= set(values.columns):
        return
    smooth = [values[n].rolling(SMOOTH, center=True).mean() for n in ("sensor_temperature_C", "air_temperature_C")]
    sensor, air = (x.to_numpy(dtype=float) for x in smooth)
    # offsets of half a minute are all that two thermometers tell
    every = max(1, round(FINEST_S / interval_s))
    sensor, air, interval_s = sensor[::every], air[::every], every * interval_s
    most = min(round(LONGEST_S / interval_s), len(air) // 4)
    offsets = range(-most, most + 1)
    squares = [_square(sensor, air, offset) for offset in offsets]
    if most < 1 or not np.isfinite(squares).all():
        return
    best = offsets[int(np.argmin(squares))]
    if best <= -2 and min(squares) < CLEAR * squares[most]:
        shown = f"{-best} samples ({-best * interval_s:g} s)"
        notes.warn(
            f"clock offset: sensor_temperature_C is {shown} ahead of air_temperature_C; a sensor cannot be early"
        )


def _square(sensor: FloatArray, air: FloatArray, late: int) -> float:
    """Return the variance of the difference of a sensor and the air so many samples before."""
    moved, still = (sensor[late:], air[: len(air) - late]) if late >= 0 else (sensor[:late], air[-late:])
    difference = moved - still
    seen = difference[np.isfinite(difference)]
    return float(seen.var()) if len(seen) > SMOOTH else float("nan")
