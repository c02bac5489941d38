"""Key figures of one simulated member-week, from its trace."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date
from typing import Any

import numpy as np
import pandas as pd

from waxstudy.plugin import FloatArray

# an opening valve counts as a start when its flow rises over the half after having been below a tenth
CYCLE_LOW, CYCLE_HIGH = 0.1, 0.5
FULLY_OPEN = 0.999
ACTIVATION_LIMIT_S = 300.0  # the reserve market's limit (research question 2)
FLOWING = 0.01  # flow fraction below which a return temperature says nothing
DURATION_PERCENT = np.arange(101.0)
DURATION_CHANNELS = ("operative_C", "air_C", "flow_L_h", "return_C", "floor_heat_W_m2")
# name -> unit
TRACE_CHANNELS = {
    "air_C": "C",
    "operative_C": "C",
    "floor_surface_C": "C",
    "supply_C": "C",
    "return_C": "C",
    "flow_L_h": "L/h",
    "opening": "1",
    "signal": "1",
    "output": "1",
    "water_heat_W_m2": "W/m2",
    "floor_heat_W_m2": "W/m2",
}
MEANS = ("flow_L_h", "opening", "signal", "output", "water_heat_W_m2", "floor_heat_W_m2")


@dataclass(frozen=True)
class MemberWeek:
    """Channels (`TRACE_CHANNELS`) of one member at every step, with what is needed to judge them."""

    channels: dict[str, FloatArray]
    step_s: float
    setpoint_C: float  # shifted
    full_flow_L_h: float
    unshifted_setpoint_C: float
    operative_limit_C: float

    @property
    def weeks(self) -> float:
        return len(self.channels["air_C"]) * self.step_s / (7 * 86400.0)


def key_figures(week: MemberWeek) -> dict[str, float]:
    """Return the KPIs of one member; per week where the name says so, whatever the record's length."""
    c, hours = week.channels, week.step_s / 3600.0
    fraction = c["flow_L_h"] / week.full_flow_L_h
    flowing = fraction > FLOWING
    flow_sum = float(np.sum(c["flow_L_h"]))
    starts = opening_times_s(c["signal"], c["opening"], week.step_s)
    return {
        "hours_below_per_week": float(np.sum(c["operative_C"] < week.operative_limit_C)) * hours / week.weeks,
        "mae_K": float(np.mean(np.abs(c["air_C"] - week.setpoint_C))),
        "heat_kWh_m2_week": float(np.sum(c["water_heat_W_m2"])) * hours / 1000.0 / week.weeks,
        "cycles_per_week": count_cycles(fraction) / week.weeks,
        "air_mean_C": float(np.mean(c["air_C"])),
        "operative_mean_C": float(np.mean(c["operative_C"])),
        "operative_max_C": float(np.max(c["operative_C"])),
        "over_setpoint_1K_share": float(np.mean(c["operative_C"] > week.unshifted_setpoint_C + 1.0)),
        "valve_open_h": float(np.sum(flowing)) * hours / week.weeks,
        "flow_mean_L_h": float(np.mean(c["flow_L_h"])),
        "full_flow_L_h": week.full_flow_L_h,
        "return_mean_C": float(np.sum(c["return_C"] * c["flow_L_h"])) / flow_sum if flow_sum > 0 else np.nan,
        "starts": float(len(starts)),
        "starts_over_300_s": float(np.sum(starts > ACTIVATION_LIMIT_S)),
    }


def count_cycles(fraction: FloatArray) -> int:
    """Count the rises of the flow fraction from below a tenth to over the half."""
    level = np.where(fraction > CYCLE_HIGH, 1, np.where(fraction < CYCLE_LOW, -1, 0))
    level = level[level != 0]
    return int(np.sum((level[1:] == 1) & (level[:-1] == -1)))


def opening_times_s(signal: FloatArray, opening: FloatArray, step_s: float) -> FloatArray:
    """Return the time from each start of the signal (from a closed valve) to full opening [s].

    Starts whose signal ends before the valve is fully open are left out. Only binary signals have starts.
    """
    on = signal > 0.5
    begins = np.flatnonzero(on[1:] & ~on[:-1]) + 1
    ends = np.append(np.flatnonzero(on[:-1] & ~on[1:]) + 1, len(on))
    begins = begins[opening[begins - 1] <= 0.0]
    if not np.all((signal == 0.0) | (signal == 1.0)):
        return np.zeros(0)
    open_at = np.append(np.flatnonzero(opening >= FULLY_OPEN), len(on) + 1)
    reached = open_at[np.searchsorted(open_at, begins)]
    done = reached < ends[np.searchsorted(ends, begins, side="right")]
    return np.asarray((reached[done] - begins[done] + 1) * step_s, dtype=np.float64)


def durations(week: MemberWeek, sample_s: float = 60.0) -> pd.DataFrame:
    """Return each channel's value that is not exceeded for a share of the time: percentiles 0 to 100.

    The return temperature counts only while water flows.
    """
    stride = max(1, round(sample_s / week.step_s))
    frame: dict[str, Any] = {"percent": DURATION_PERCENT}
    flowing = week.channels["flow_L_h"][::stride] > FLOWING * week.full_flow_L_h
    for name in DURATION_CHANNELS:
        values = week.channels[name][::stride]
        values = values[flowing] if name == "return_C" else values
        frame[name] = np.percentile(values, DURATION_PERCENT) if len(values) else np.full(101, np.nan)
    return pd.DataFrame(frame)


def thinned(week: MemberWeek, interval_s: float, first_day: str) -> pd.DataFrame:
    """Return the trace at a longer interval, stamped at its end; flow, levels and heat are its means.

    `time` is local standard time, exact to the microsecond; `time_s` counts from 00:00 of `first_day` (ISO date).
    """
    n = round(interval_s / week.step_s)
    rows = len(week.channels["air_C"]) // n
    frame: dict[str, Any] = stamps(first_day, interval_s, rows)
    for name in TRACE_CHANNELS:
        blocks = week.channels[name][: rows * n].reshape(rows, n)
        frame[name] = blocks.mean(axis=1) if name in MEANS else blocks[:, -1]
    return pd.DataFrame(frame)


def stamps(first_day: str, interval_s: float, rows: int) -> dict[str, np.ndarray]:
    """Return `time` (datetime64[us]) and `time_s` (float64 [s]) at the ends of intervals (rows,)."""
    time_s = np.arange(1, rows + 1) * interval_s
    since = np.rint(time_s * 1e6).astype("timedelta64[us]")
    return {"time": np.datetime64(date.fromisoformat(first_day), "us") + since, "time_s": time_s}
