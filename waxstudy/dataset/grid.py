"""From rows as they were logged to a regular grid."""

from __future__ import annotations

import numpy as np
import pandas as pd

from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.columns import TIME
from waxstudy.dataset.limits import (
    AROUND,
    COARSER,
    FEWEST_ROWS,
    FINER,
    LEAST_KNOWN,
    MOST_INTERVALS,
    OFTEN,
    REPEATED,
    TOGETHER,
    UNEVEN,
)
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.tables import DatasetTable
from waxstudy.plugin import FloatArray

NS = 1_000_000_000


def on_grid(
    values: pd.DataFrame, times: pd.DatetimeIndex, about: DatasetTable, notes: Notes
) -> tuple[pd.DataFrame, float] | None:
    """Return the channels at the ends of equal intervals, missing where no row is near, and the interval [s]."""
    seconds = times.as_unit("ns").asi8
    steps_s = np.diff(seconds) / NS
    usual_s = float(np.median(steps_s))
    interval_s = about.interval_s or _usual(steps_s, notes)
    if about.stamps == "start":
        seconds = seconds + round(min(usual_s, interval_s) * NS)
        notes.assume("Rows are stamped at the start of their intervals; the stamps are moved to the end.")
    if not _fits(steps_s, interval_s, notes):
        return None
    finer = usual_s < FINER * interval_s
    step = round(interval_s * NS)
    phase = 0 if finer else _phase(seconds, step)
    ceil = -((phase - seconds) // step)
    place = ceil if finer else (seconds - phase + step // 2) // step
    off = np.abs(place * step + phase - seconds) / NS
    count = int(place[-1] - place[0]) + 1
    if count > MOST_INTERVALS:
        notes.refuse(TIME, f"from {times[0]} to {times[-1]} there are {count} intervals of {interval_s:g} s")
        return None
    stamps = pd.DatetimeIndex((np.arange(count) + place[0]) * step + phase, name=TIME)
    rows = values.set_axis(place - place[0], axis="index")
    gridded = _means(rows, interval_s, steps_s, notes) if finer else _nearest(rows, off, notes)
    return gridded.reindex(np.arange(count)).set_axis(stamps, axis="index"), interval_s


def _usual(steps_s: FloatArray, notes: Notes) -> float:
    distances, counts = np.unique(np.round(steps_s, 3), return_counts=True)
    is_usual = counts.max() * 2 > counts.sum()
    interval_s = float(distances[np.argmax(counts)]) if is_usual else float(np.median(steps_s))
    what = "most frequent" if is_usual else "median"
    notes.assume(f"The interval is {interval_s:g} s, the {what} distance of stamps, as interval_s is not given.")
    return interval_s


def _fits(steps_s: FloatArray, interval_s: float, notes: Notes) -> bool:
    if len(steps_s) >= FEWEST_ROWS and steps_s.min() > COARSER * interval_s:
        wrong = f"the stamps are {steps_s.min():g} s and more from each other, but interval_s = {interval_s:g}"
        notes.refuse(TIME, wrong)
        return False
    return True


def _phase(seconds: np.ndarray, step: int) -> int:
    """Return where the grid lies: where most stamps do, around which they jitter, or at whole intervals of the day."""
    phases, counts = np.unique(seconds % step, return_counts=True)
    if counts.max() * 2 > len(seconds):
        return int(phases[np.argmax(counts)])
    middle = complex(np.exp(2j * np.pi * phases / step) @ counts) / len(seconds)
    is_apart = abs(middle) > TOGETHER and abs(np.angle(middle)) > np.pi / 2.0  # near 0 each has one nearest place
    return round((np.angle(middle) / (2.0 * np.pi) % 1.0) * step / NS) * NS if is_apart else 0


def _nearest(rows: pd.DataFrame, off_s: FloatArray, notes: Notes) -> pd.DataFrame:
    """Return the rows at the nearest places of the grid; of two, the nearer."""
    moved = int((off_s > 0.0).sum())
    if moved:
        off = f"off the grid, by up to {off_s.max():.3g} s"
        notes.warn(f"{moved} of {len(off_s)} stamps are {off}: moved to the nearest")
    if rows.index.is_unique:
        return rows
    order = np.argsort(off_s, kind="stable")
    kept = rows.iloc[order].groupby(level=0).first()  # of each channel: several loggers may share a file
    lost = int(rows.count().sum() - kept.count().sum())
    if lost:
        notes.warn(f"{lost} values fall on a place of the grid that a nearer one has taken: left out")
    return kept


def _tell_uneven(interval_s: float, usual_s: float, notes: Notes) -> None:
    """Warn where intervals hold a row more or less in turn, and their last values lie at different times."""
    rows = interval_s / usual_s
    if abs(rows - round(rows)) > UNEVEN * rows:
        nearest = f"{np.floor(rows) * usual_s:g} or {np.ceil(rows) * usual_s:g}"
        said = f"interval_s = {interval_s:g} is no multiple of the {usual_s:g} s between the file's rows"
        holds = f"samples hold {np.floor(rows):g} or {np.ceil(rows):g} rows in turn, which no instrument did"
        notes.warn(f"{said}: {holds}; take interval_s = {nearest}")


def _means(rows: pd.DataFrame, interval_s: float, steps_s: FloatArray, notes: Notes) -> pd.DataFrame:
    """Return means over the interval for channels that are means, and the last value for all others.

    Of a file whose rows come regularly, an interval with less than half as many as those around it is missing, and so
    is a mean of less than half as many values.
    """
    places, usual_s = rows.groupby(level=0, sort=True), float(np.median(steps_s))
    is_regular = (
        float(np.mean(np.abs(np.diff(steps_s)) <= REPEATED * steps_s[1:])) > OFTEN if len(steps_s) > 1 else False
    )
    _tell_uneven(interval_s, usual_s, notes)
    sentence = f"The file's rows are {usual_s:g} s apart: over {interval_s:g} s, flow and gains are averaged"
    notes.assume(f"{sentence}; of all else the last value of the interval is taken.")
    gridded = places.last()
    for name in rows.columns:
        if CHANNELS[name].is_mean:
            gridded[name] = places[name].mean()
            if is_regular:
                gridded[name] = gridded[name].mask(_is_poor(places[name].count()))
    is_poor = _is_poor(places.size()) & is_regular
    if is_poor.any():
        notes.warn(f"{is_poor.sum()} intervals of {interval_s:g} s hold less than half of the usual rows: missing")
    return gridded[~is_poor]


def _is_poor(count: pd.Series) -> np.ndarray:
    """Return which intervals hold less than half as many as both those before and those behind them usually do."""
    before = count.shift(1).rolling(AROUND, min_periods=1).median()
    behind = count[::-1].shift(1).rolling(AROUND, min_periods=1).median()[::-1]
    return np.asarray(count < LEAST_KNOWN * np.fmin(before, behind))
