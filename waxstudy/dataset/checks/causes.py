"""Causes and effects: an effect that runs against its cause is turned, one that comes before it has another clock."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd

from waxstudy.dataset.checks.check import Discard, Findings, Record, Refuse, Warn, check
from waxstudy.dataset.limits import (
    AGREEING,
    CLEAR,
    CROSSED,
    ENOUGH,
    FEWEST_EDGES,
    FINEST_OFFSET_S,
    HIGH,
    LONGEST_OFFSET_S,
    LOW,
    SETTLED_S,
    SETTLED_SAMPLES,
    SMOOTH_SAMPLES,
)
from waxstudy.plugin import FloatArray

INVERTED = "take 1 minus what it is: scale = -1.0, offset = 1.0 in [columns], of a column that has neither"
timed = partial(check, mend="one clock for all channels", fewest=0)


@check("direction", "refuses", (), fewest=0, mend=INVERTED)
def turned(record: Record) -> Findings:
    """An opening or flow below {LOW:.0%} of what it reaches where its signal or opening has been high for half an hour,
    and above {HIGH:.0%} where that has been low; as of a motor that is open without current."""
    pairs = [pair for pair in CROSSED if "control_output" not in pair and set(pair) <= set(record.values.columns)]
    against = [pair for pair in pairs if _are_against(*pair, record)]
    if against:
        # what runs against both others is turned; of two alone it is the signal, as of a motor open without current
        names = [name for pair in against for name in pair]
        turned = max(dict.fromkeys(names), key=names.count)
        cause, effect = against[0]
        wrong = f"is turned: {effect} is low where {cause} has long been high, and high where it has been low"
        yield Refuse(turned, wrong, INVERTED)


def _are_against(cause: str, effect: str, record: Record) -> bool:
    values = record.values
    rest = values[cause].rolling(max(SETTLED_SAMPLES, round(SETTLED_S / record.interval_s)))
    after_on, after_off = (values[effect][chosen].dropna() for chosen in (rest.min() > HIGH, rest.max() < LOW))
    full = float(values[effect].quantile(0.99))
    if min(len(after_on), len(after_off)) < ENOUGH or not full > 0.0:
        return False
    return bool(after_on.median() < LOW * full and after_off.median() > HIGH * full)


@check(
    "meter",
    "discards",
    ("displacement", "flow_L_h"),
    mend="water may not flow: look at pump, valve and meter",
    fewest=0,
)
def dead_meter(record: Record, opening: pd.Series, flow: pd.Series) -> Findings:
    """A flow that is 0 throughout, though the opening is above {HIGH:.0%}: the room tells whether water flows."""
    if not (flow > 0.0).any() and ((opening > HIGH) & (flow <= 0.0)).sum() >= ENOUGH:
        yield Discard(flow.name, flow.notna().to_numpy(), "0 though the valve opens, as of a dead meter, pump or valve")


@timed("clocks", "refuses or warns", *CROSSED)
def clock_offset(record: Record, cause: pd.Series, effect: pd.Series) -> Findings:
    """An opening that is 0 or 1 and comes before a signal that takes its time: they are swapped. Any other effect
    before its cause is a warning, and so are an output and a signal that differ in time with no modulator between. A
    late effect is none: motors, sensors and pipes take time."""
    is_of_output = cause.name == "control_output"
    if is_of_output and not (_is_binary(cause) and _is_binary(effect)):
        return  # a continuous output and a signal that switches have no edges in common
    level = CROSSED[str(cause.name), str(effect.name)]
    late = _lateness(_switched(cause, level), _switched(effect, level), record.interval_s)
    if late is None or late == 0 or (late == -1 and effect.name == "flow_L_h"):
        return  # a mean over an interval tells of an edge within it
    if late < 0 and effect.name == "displacement" and _is_binary(effect) and not _is_binary(cause):
        why = "the opening is 0 or 1 and comes first, the signal takes its time"
        yield Refuse(f"{cause.name}, {effect.name}", f"look swapped: {why}")
    elif late < 0 or (is_of_output and not record.has_modulator):
        how = "before" if late < 0 else "after"
        reason = "no effect comes before its cause" if late < 0 else "without a modulator they are the same"
        shown = f"{abs(late)} samples ({abs(late) * record.interval_s:g} s) {how}"
        yield Warn(f"clock offset: {effect.name} changes {shown} {cause.name}, and {reason}")


def _is_binary(x: pd.Series) -> bool:
    return bool(x.dropna().isin([0.0, 1.0]).all())


def _switched(x: pd.Series, level: float) -> FloatArray:
    """Return 1 above a level, 0 below, NaN where missing."""
    values = x.to_numpy(dtype=float)
    full = np.nanmax(values) if x.name == "flow_L_h" else 1.0  # what all other levels reach by definition
    return np.where(np.isnan(values), np.nan, values > level * full)


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
    longest = LONGEST_OFFSET_S / interval_s
    if not len(starts) or not len(ends):
        return np.array([])
    after = np.clip(np.searchsorted(ends, starts), 1, len(ends) - 1) if len(ends) > 1 else np.zeros(len(starts), int)
    before = np.maximum(after - 1, 0)
    nearest = np.where(starts - ends[before] < ends[after] - starts, ends[before], ends[after])
    lags = (nearest - starts).astype(float)
    return np.asarray(lags[np.abs(lags) <= longest])


@timed("sensor's clock", "warns", ("sensor_temperature_C", "air_temperature_C"))
def early_sensor(record: Record, *channels: pd.Series) -> Findings:
    """A sensor that knows the temperature of the air before it is there, by twice {FINEST_OFFSET_S:g} s, or two
    samples."""
    every = max(1, round(FINEST_OFFSET_S / record.interval_s))
    sensor, air = (x.rolling(SMOOTH_SAMPLES, center=True).mean().to_numpy(dtype=float)[::every] for x in channels)
    interval_s = every * record.interval_s
    most = min(round(LONGEST_OFFSET_S / interval_s), len(air) // 4)
    offsets = range(-most, most + 1)
    squares = [_square(sensor, air, offset) for offset in offsets]
    if most < 1 or not np.isfinite(squares).all():
        return
    best = offsets[int(np.argmin(squares))]
    if best <= -2 and min(squares) < CLEAR * squares[most]:
        early = f"{-best} samples ({-best * interval_s:g} s) ahead of air_temperature_C"
        yield Warn(f"clock offset: sensor_temperature_C is {early}; a sensor cannot be early")


def _square(sensor: FloatArray, air: FloatArray, late: int) -> float:
    """Return the variance of the difference of a sensor and the air so many samples before."""
    moved, still = (sensor[late:], air[: len(air) - late]) if late >= 0 else (sensor[:late], air[-late:])
    difference = moved - still
    seen = difference[np.isfinite(difference)]
    return float(seen.var()) if len(seen) > SMOOTH_SAMPLES else float("nan")
