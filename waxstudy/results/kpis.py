"""Key figures of one simulated member-week, from its trace."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import date
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from waxstudy.plugin import FloatArray

BoolArray = NDArray[np.bool_]
# an opening valve counts as a start when its flow rises over the half after having been below a tenth
CYCLE_LOW, CYCLE_HIGH = 0.1, 0.5
FULLY_OPEN = 0.999
ACTIVATION_LIMIT_S = 300.0  # the reserve market's limit (research question 2)
FLOWING = 0.01  # flow fraction below which a return temperature says nothing
DURATION_PERCENT = np.arange(101.0)
SAMPLE_S = 60.0  # between what durations are taken of
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
# of a row of key figures: where it belongs, then what it tells
WEATHER = "weather"  # of a member, counted from 0, where a week has several
FIGURES = {
    "case": "1",
    "week": "1",
    "member": "1",
    WEATHER: "1",
    "setpoint_shift_K": "K",
    "heat_per_K_kWh_m2_week": "kWh/m2 a week",
    "single_run_shift_K": "K",
    "hours_below_per_week": "h",
    "mae_K": "K",
    "heat_kWh_m2_week": "kWh/m2 a week",
    "heat_corrected_kWh_m2_week": "kWh/m2 a week",
    "cycles_per_week": "1",
    "air_mean_C": "C",
    "operative_mean_C": "C",
    "operative_max_C": "C",
    "over_setpoint_1K_share": "1",
    "valve_open_h": "h",
    "flow_mean_L_h": "L/h",
    "full_flow_L_h": "L/h",
    "return_mean_C": "C",
    "starts": "1",
    "starts_over_300_s": "1",
    "counted_days": "1",
}
# EN 16798-1, homes in the heating season: operative temperatures of categories I to III
CATEGORIES_C = {"I": (21.0, 25.0), "II": (20.0, 25.0), "III": (18.0, 25.0)}
IN_CATEGORY = {name: f"in_category_{name}_share" for name in CATEGORIES_C}
FIGURES |= dict.fromkeys(IN_CATEGORY.values(), "1")
HEAT_OF_MONTH = "heat_{month}_kWh_m2"  # of records that reach into several months (YYYY-MM)
_OF_MONTH = re.compile(re.escape(HEAT_OF_MONTH).replace(r"\{month\}", r"(\d{4}-\d\d)"))
MEANS = ("flow_L_h", "opening", "signal", "output", "water_heat_W_m2", "floor_heat_W_m2")


@dataclass(frozen=True)
class MemberWeek:
    """Channels (`TRACE_CHANNELS`) of one member at every step, of a whole record or a part of it."""

    channels: dict[str, FloatArray]
    step_s: float
    setpoint_C: float  # shifted
    full_flow_L_h: float
    unshifted_setpoint_C: float
    operative_limit_C: float
    stored_kWh_m2: float = np.nan  # how much more heat the room holds at its end; NaN where that is not known
    counts: BoolArray | None = None  # whether comfort is counted at a step; None where it always is
    months: Mapping[str, slice] = field(default_factory=dict)  # which steps lie in which month


class Figures:
    """Key figures and durations of one member, from the parts of its record as they follow each other.

    A year at 5 s does not lie in memory at once: of each part sums, samples and what starts are told by are kept.
    """

    def __init__(self) -> None:
        self.steps = 0
        self.sums: dict[str, float] = {}
        self.months: dict[str, float] = {}
        self.highest_C = -np.inf
        self.levels = [np.zeros(0, dtype=np.int8)]  # of the flow, where it is low or high
        self.valve = Valve()
        self.samples: dict[str, list[FloatArray]] = {name: [] for name in DURATION_CHANNELS}

    def add(self, part: MemberWeek) -> None:
        """Take in the next part."""
        self.part, c = part, part.channels
        fraction = c["flow_L_h"] / part.full_flow_L_h
        summed = {
            "below": c["operative_C"] < part.operative_limit_C,
            "error_K": np.abs(c["air_C"] - part.setpoint_C),
            "heat": c["water_heat_W_m2"],
            "air_C": c["air_C"],
            "operative_C": c["operative_C"],
            "warm": c["operative_C"] > part.unshifted_setpoint_C + 1.0,
            "flowing": fraction > FLOWING,
            "flow_L_h": c["flow_L_h"],
            "return": c["return_C"] * c["flow_L_h"],
        }
        counts = np.True_ if part.counts is None else part.counts
        summed |= {"counted": np.broadcast_to(counts, fraction.shape)}
        summed |= {name: summed[name] & counts for name in ("below", "warm")} | {"error_K": summed["error_K"] * counts}
        for category, (low_C, high_C) in CATEGORIES_C.items():
            summed[category] = (c["operative_C"] >= low_C) & (c["operative_C"] <= high_C) & counts
        now = {name: float(np.sum(values)) for name, values in summed.items()}
        for month, steps in part.months.items():
            self.months[month] = self.months.get(month, 0.0) + float(np.sum(c["water_heat_W_m2"][steps]))
        now["stored"] = part.stored_kWh_m2
        self.sums = {name: self.sums[name] + value for name, value in now.items()} if self.steps else now
        self.highest_C = max(self.highest_C, float(np.max(c["operative_C"])))
        level = flow_level(fraction)
        # runs of one level count as one, across parts too
        self.levels.append(level[np.diff(level, prepend=np.int8(0)) != 0])
        self.valve.add(c["signal"], c["opening"])
        self._sample(part)
        self.steps += len(fraction)

    def _sample(self, part: MemberWeek) -> None:
        stride = max(1, round(SAMPLE_S / part.step_s))
        at = slice(-self.steps % stride, None, stride)
        flowing = part.channels["flow_L_h"][at] > FLOWING * part.full_flow_L_h
        for name, samples in self.samples.items():
            values = part.channels[name][at]
            samples.append(values[flowing] if name == "return_C" else values.copy())

    def key_figures(self) -> dict[str, float]:
        """Return the KPIs of one member; per week where the name says so, whatever the record's length.

        Hours below, the mean error, hours over the setpoint and categories are of the time in which comfort counts.
        """
        part, hours, sums = self.part, self.part.step_s / 3600.0, self.sums
        counted = sums["counted"]
        counted_weeks = counted * part.step_s / (7 * 86400.0)
        weeks = self.steps * part.step_s / (7 * 86400.0)
        starts = self.valve.opening_times_s(part.step_s)
        return {
            "hours_below_per_week": sums["below"] * hours / counted_weeks,
            "mae_K": sums["error_K"] / counted,
            "heat_kWh_m2_week": sums["heat"] * hours / 1000.0 / weeks,
            "heat_corrected_kWh_m2_week": (sums["heat"] * hours / 1000.0 - sums["stored"]) / weeks,
            "cycles_per_week": rises(np.concatenate(self.levels)) / weeks,
            "air_mean_C": sums["air_C"] / self.steps,
            "operative_mean_C": sums["operative_C"] / self.steps,
            "operative_max_C": self.highest_C,
            "over_setpoint_1K_share": sums["warm"] / counted,
            "valve_open_h": sums["flowing"] * hours / weeks,
            "flow_mean_L_h": sums["flow_L_h"] / self.steps,
            "full_flow_L_h": part.full_flow_L_h,
            "return_mean_C": sums["return"] / sums["flow_L_h"] if sums["flow_L_h"] > 0 else np.nan,
            "starts": float(len(starts)),
            "starts_over_300_s": float(np.sum(starts > ACTIVATION_LIMIT_S)),
            **self._of_season(),
        }

    def _of_season(self) -> dict[str, float]:
        """Return comfort of a heating season, where there is one, and heat of each month, where there are several."""
        figures = {}
        if self.part.counts is not None:
            figures["counted_days"] = self.sums["counted"] * self.part.step_s / 86400.0
            figures |= {IN_CATEGORY[name]: self.sums[name] / self.sums["counted"] for name in CATEGORIES_C}
        if len(self.months) > 1:
            kWh = self.part.step_s / 3.6e6
            figures |= {HEAT_OF_MONTH.format(month=month): heat * kWh for month, heat in self.months.items()}
        return figures

    def durations(self) -> pd.DataFrame:
        """Return each channel's value that is not exceeded for a share of the time: percentiles 0 to 100.

        They are taken of samples every minute. The return temperature counts only while water flows.
        """
        frame: dict[str, Any] = {"percent": DURATION_PERCENT}
        for name, samples in self.samples.items():
            values = np.concatenate(samples)
            frame[name] = np.percentile(values, DURATION_PERCENT) if len(values) else np.full(101, np.nan)
        return pd.DataFrame(frame)


def months_of(columns: Iterable[str]) -> dict[str, str]:
    """Return the columns that are heat of a month -> its month, in order."""
    return {column: found[1] for column in sorted(columns) if (found := _OF_MONTH.fullmatch(column))}


def units_of(columns: Iterable[str]) -> dict[str, str]:
    """Return the unit of every key figure, the months among these columns too."""
    return {**FIGURES, **dict.fromkeys(months_of(columns), "kWh/m2")}


def key_figures(week: MemberWeek) -> dict[str, float]:
    """Return the KPIs of a record that lies in memory as a whole."""
    figures = Figures()
    figures.add(week)
    return figures.key_figures()


def flow_level(fraction: FloatArray) -> np.ndarray:
    """Return 1 where a flow fraction is over the half, -1 where it is below a tenth, without what is between (m,)."""
    level = np.where(fraction > CYCLE_HIGH, 1, np.where(fraction < CYCLE_LOW, -1, 0)).astype(np.int8)
    return np.asarray(level[level != 0])


def rises(level: np.ndarray) -> int:
    """Count the rises from a low level to a high one."""
    return int(np.sum((level[1:] == 1) & (level[:-1] == -1)))


def count_cycles(fraction: FloatArray) -> int:
    """Count the rises of the flow fraction from below a tenth to over the half."""
    return rises(flow_level(fraction))


class Valve:
    """What the starts of a valve are told by: the steps at which its signal comes and goes, and it is fully open."""

    def __init__(self) -> None:
        self.steps = 0
        self.is_binary = True
        self.begins: list[np.ndarray] = []  # from a closed valve
        self.ends: list[np.ndarray] = []
        self.opened: list[np.ndarray] = []
        self.last = np.zeros((3, 1), dtype=bool)  # on, closed and fully open, at the last step

    def add(self, signal: FloatArray, opening: FloatArray) -> None:
        """Take in the next part."""
        now = np.array([signal > 0.5, opening <= 0.0, opening >= FULLY_OPEN])
        on, closed, full = np.concatenate([self.last if self.steps else now[:, :1], now], axis=1)
        begins = np.flatnonzero(on[1:] & ~on[:-1])
        self.begins.append(begins[closed[begins]] + self.steps)
        self.ends.append(np.flatnonzero(on[:-1] & ~on[1:]) + self.steps)
        self.opened.append(np.flatnonzero(full[1:] & ~full[:-1]) + self.steps)
        self.is_binary &= bool(np.all((signal == 0.0) | (signal == 1.0)))
        self.last, self.steps = now[:, -1:], self.steps + len(signal)

    def opening_times_s(self, step_s: float) -> FloatArray:
        """Return the time from each start of the signal (from a closed valve) to full opening [s].

        Starts whose signal ends before the valve is fully open are left out. Only binary signals have starts.
        """
        if not self.is_binary:
            return np.zeros(0)
        begins = np.concatenate(self.begins)
        ends = np.append(np.concatenate(self.ends), self.steps)
        opened = np.append(np.concatenate(self.opened), self.steps + 1)
        reached = opened[np.searchsorted(opened, begins)]
        done = reached < ends[np.searchsorted(ends, begins, side="right")]
        return np.asarray((reached[done] - begins[done] + 1) * step_s, dtype=np.float64)


def thinned(week: MemberWeek, interval_s: float, first_day: str, before: int = 0) -> pd.DataFrame:
    """Return the trace at a longer interval, stamped at its end; flow, levels and heat are its means.

    `time` is local standard time, exact to the microsecond; `time_s` counts from 00:00 of `first_day` (ISO date).
    `before` is the number of rows of the parts before this one.
    """
    n = round(interval_s / week.step_s)
    rows = len(week.channels["air_C"]) // n
    frame: dict[str, Any] = stamps(first_day, interval_s, rows, before)
    for name in TRACE_CHANNELS:
        blocks = week.channels[name][: rows * n].reshape(rows, n)
        frame[name] = blocks.mean(axis=1) if name in MEANS else blocks[:, -1]
    return pd.DataFrame(frame)


def stamps(first_day: str, interval_s: float, rows: int, before: int = 0) -> dict[str, np.ndarray]:
    """Return `time` (datetime64[us]) and `time_s` (float64 [s]) at the ends of intervals (rows,)."""
    time_s = np.arange(before + 1, before + rows + 1) * interval_s
    since = np.rint(time_s * 1e6).astype("timedelta64[us]")
    return {"time": np.datetime64(date.fromisoformat(first_day), "us") + since, "time_s": time_s}
