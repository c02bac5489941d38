"""The time column: stamps that can be read, in order, once each, at the end of their intervals."""

from __future__ import annotations

import re
from datetime import timedelta
from typing import NamedTuple

import numpy as np
import pandas as pd

from waxstudy.dataset.columns import TIME, named
from waxstudy.dataset.limits import LATE_S, YEARS
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.tables import DatasetTable
from waxstudy.dataset.zones import fixed_name, standard_ahead, zone_of
from waxstudy.plugin.registry import nearest
from waxstudy.study.problems import shown

ISO = "expected ISO 8601, as 2020-01-31T12:00:00"
# so written, pandas looks for it in compiled code
ZONED = r"(?:Z|[+-](?:0[0-9]|1[0-4]):?[0-5][0-9]|(?:T|:)[0-9.,]+ *[+-][0-9]{2}) *\Z"
STATED_ZONE = r"(?:(?<!%)Z|[+-](?:0[0-9]|1[0-4]):?[0-5][0-9]) *\Z"  # of all stamps, at the end of their format
HOUR_S = 3600.0  # of a clock change
DAY_FIRST = r"\s*\d{1,2}([./-])\d{1,2}\1\d{4}"


class Stamps(NamedTuple):
    """Stamps as naive local standard time, and its zone, None where nothing tells it."""

    times: pd.DatetimeIndex
    zone: str | None


def stamps_of(
    table: pd.DataFrame, column: str, about: DatasetTable, notes: Notes, zone: str | None = None
) -> Stamps | None:
    """Return the stamps, in standard time of a zone if they have offsets from UTC; note why they cannot be used."""
    if column not in table.columns:
        allowed = f'if the time has another name, say [columns] {TIME} = "..."; columns: {named(table)}'
        notes.refuse(column, "there is no such column", near=nearest(column, table.columns), allowed=allowed)
        return None
    if len(table) < 2:
        notes.refuse(column, "a record needs at least two rows")
        return None
    times = _parsed(table[column], about.time_format, notes)
    if times is None:
        return None
    strange = np.flatnonzero((times.year < YEARS[0]) | (times.year > YEARS[1]))
    if len(strange):
        row = int(strange[0])
        notes.refuse(TIME, f"{times[row]} is not within the years {YEARS[0]} to {YEARS[1]}", line=row + 2)
        return None
    found = _local(times, table[column], zone, notes)
    if not _in_order(found.times, notes):
        return None
    _tell_clock_changes(found.times, notes)
    return found


def _parsed(written: pd.Series, time_format: str | None, notes: Notes) -> pd.DatetimeIndex | None:
    """Return the stamps with their offsets from UTC, if they have any; note the first that cannot be read."""
    if pd.api.types.is_datetime64_any_dtype(written):
        return _all_read(written, written, time_format, notes)
    if pd.api.types.is_numeric_dtype(written):
        notes.refuse(TIME, "is a number, not a date and time", line=2, value=shown(written.iloc[0]), allowed=ISO)
        return None
    written = written.where(written.isna(), written.astype(str))
    time_format = time_format and re.sub(STATED_ZONE, "%z", time_format)
    zoned = written.str.contains(ZONED, na=False) & (time_format is None or "%z" in time_format)
    if 0 < zoned.sum() < written.notna().sum():
        row = int(np.argmin(zoned.to_numpy()))
        notes.refuse(TIME, "some stamps have an offset from UTC and some have none", line=row + 2)
        return None
    return _read(written, time_format, notes, utc=bool(zoned.any()))


def _read(written: pd.Series, time_format: str | None, notes: Notes, utc: bool) -> pd.DatetimeIndex | None:
    """Return the stamps; note the first that cannot be read, or a format that is none."""
    try:
        times = pd.to_datetime(written, format=time_format or "ISO8601", errors="coerce", utc=utc)
    except (ValueError, re.error) as error:
        _no_format(time_format, error, notes)
        return None
    return _all_read(written, times, time_format, notes)


def _no_format(time_format: str | None, error: Exception, notes: Notes) -> None:
    if time_format is None:
        notes.refuse(TIME, "cannot be read as date and time", allowed=ISO)
        return
    directive = re.search(r"'(.)' is a bad directive", str(error))
    wrong = f"%{directive[1]} means nothing in a format of dates" if directive else "is no format of dates"
    notes.refuse("time_format", wrong, value=shown(time_format), allowed="such as %d.%m.%Y %H:%M:%S")


def _all_read(written: pd.Series, times: pd.Series, time_format: str | None, notes: Notes) -> pd.DatetimeIndex | None:
    bad = times.isna().to_numpy()
    if not bad.any():
        return pd.DatetimeIndex(times)
    row = int(np.argmax(bad))
    text = str(written.iloc[row])
    if time_format is None and bad.all() and written.astype(str).str.match(DAY_FIRST).iloc[row]:
        between = next(mark for mark in text if not mark.isdigit() and not mark.isspace())
        day, month = ("%d", "%m") if _days_first(written, between) else ("%m", "%d")
        hint = f'say [dataset] time_format = "{day}{between}{month}{between}%Y %H:%M" or as it is'
    else:
        hint = f"expected {time_format}" if time_format else ISO
    is_missing = bool(written.isna().iloc[row])
    wrong = "missing" if is_missing else "cannot be read as date and time"
    others = f" ({bad.sum()} such rows)" if bad.sum() > 1 else ""
    notes.refuse(TIME, wrong + others, line=row + 2, value="" if is_missing else shown(text), allowed=hint)
    return None


def _days_first(written: pd.Series, between: str) -> bool:
    """Whether the first of the numbers may be the day: the second is never more than twelve."""
    second = written.astype(str).str.extract(rf"^\s*\d{{1,2}}{re.escape(between)}(\d{{1,2}})")[0].dropna()
    return bool((second.astype(float) <= 12.0).all())


def _local(times: pd.DatetimeIndex, written: pd.Series, zone: str | None, notes: Notes) -> Stamps:
    """Return stamps in standard time: of the zone that is stated, of their own, or of their smallest offset."""
    if times.tz is None:
        return Stamps(times.as_unit("ns"), zone)
    if zone or pd.api.types.is_datetime64_any_dtype(written):
        ahead = standard_ahead(zone_of(zone) if zone else times.tz, times[0].to_pydatetime())
        said = f"standard time of {zone or times.tz}, UTC{ahead / timedelta(hours=1):+g} h"
        zone = zone or str(times.tz)
    else:
        ahead = _least_offset(written.astype(str))
        said = f"local standard time at UTC{ahead / timedelta(hours=1):+g} h, the smallest offset in the file"
        zone = fixed_name(ahead)
    notes.assume(f"Stamps are taken as {said}.")
    return Stamps((times.tz_convert("UTC").tz_convert(None) + ahead).as_unit("ns"), zone)


def _least_offset(written: pd.Series) -> timedelta:
    """Return the smallest offset from UTC of texts: that of standard time, where some are of summer time."""
    offsets = written.str.extract(r"([+-])(\d\d)(?::?(\d\d))?\s*$")
    hours, minutes = (offsets[place].astype(float).fillna(0.0).to_numpy() for place in (1, 2))
    return timedelta(minutes=float(((60.0 * hours + minutes) * np.where(offsets[0] == "-", -1.0, 1.0)).min()))


def _in_order(times: pd.DatetimeIndex, notes: Notes) -> bool:
    steps = np.diff(times.to_numpy())
    back, same = np.flatnonzero(steps < np.timedelta64(0)), np.flatnonzero(steps == np.timedelta64(0))
    if len(back):
        row = int(back[0]) + 1
        wrong = f"time goes back, from {times[row - 1]} to {times[row]}"
        wrong += f", and at {len(back) - 1} more places" if len(back) > 1 else ""
        wrong += ", as where summer time ends" if _is_changing_night(times[[row - 1]])[0] else ""
        notes.refuse(TIME, wrong, line=row + 2, allowed="rows in order of time, in standard time all year")
    if len(same):
        row = int(same[0]) + 1
        wrong = f"the stamp {times[row]} is there twice" + (f" ({len(same)} such stamps)" if len(same) > 1 else "")
        notes.refuse(TIME, wrong, line=row + 2, allowed="one row per stamp, in standard time all year")
    return not (len(back) or len(same))


def _is_changing_night(times: pd.DatetimeIndex) -> np.ndarray:
    """Whether clocks are changed at such a time somewhere: in a small hour of a Sunday in spring or autumn."""
    return np.asarray((times.day_of_week == 6) & (times.hour <= 3) & times.month.isin((3, 4, 9, 10, 11)))


def _tell_clock_changes(times: pd.DatetimeIndex, notes: Notes) -> None:
    """Say it where stamps jump by an hour in such a night: nothing else shows that a clock was put forward."""
    if (before := hour_left_out(times)) is not None:
        notes.warn(
            f"time: an hour is missing after {before}, a Sunday, as where summer time begins: if a clock was put "
            "forward, all stamps after it are an hour late; write them in standard time, or with their offset from UTC"
        )


def hour_left_out(times: pd.DatetimeIndex) -> pd.Timestamp | None:
    """Return the stamp before an hour that is missing in a night in which clocks are put forward; None without one."""
    steps_s = np.diff(times.as_unit("ns").asi8) / 1e9
    usual_s = float(np.median(steps_s)) if len(steps_s) else 0.0
    is_hour = np.abs(steps_s - usual_s - HOUR_S) <= min(0.5 * usual_s, LATE_S)
    found = np.flatnonzero(is_hour & _is_changing_night(times[:-1]))
    return times[found[0]] if len(found) else None
