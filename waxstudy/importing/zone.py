"""Zones: from what the clock on the wall showed to UTC, and from there to local standard time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, timedelta
from pathlib import Path

import numpy as np
import pandas as pd

from waxstudy.dataset.stamps import hour_left_out
from waxstudy.dataset.zones import fixed_zone, standard_ahead, zone_of
from waxstudy.importing.limits import OUT_OF_ORDER, UNSET
from waxstudy.importing.reading import Readings, refusal

HOUR, YEAR = timedelta(hours=1), timedelta(days=365)
HINT = "say --timezone, such as Europe/Tallinn"


def zone_told(readings: Sequence[Readings]) -> str | None:
    """Return the zone that stamps tell: its name or an offset, "" where clocks on the wall are all that there is.

    None where stamps are in UTC alone, which says nothing of where the room is.
    """
    zones = {each.times.tz for each in readings}
    if zones == {None}:
        return ""
    names = {str(zone) for zone in zones if zone is not None and str(zone) != "UTC"}
    if None in zones:
        where = next(each.where for each in readings if each.times.tz is None)
        raise refusal(where, "stamps without an offset from UTC, while those of other files have one", HINT)
    if len(names) > 1:
        raise refusal(readings[0].where, f"stamps of several zones ({', '.join(sorted(names))})", HINT)
    return names.pop() if names else None


def in_standard_time(readings: Sequence[Readings], zone: str) -> tuple[list[Readings], list[str]]:
    """Return readings in naive local standard time, ascending, and what was assumed of their clock."""
    found, said = [], []
    for each in readings:
        utc, sentence = _in_utc(_forward(each), zone)
        found.append(utc)
        said += [f"{each.entity}: {sentence}"] if sentence else []
        said += [back for back in _goes_back(utc) if back not in said]
    known = [each for each in found if len(each.times)]
    if zone and known:
        shift = _standard(zone, min(each.times.min() for each in known))
        found = [replace(each, times=each.times.tz_convert(None) + shift) for each in found]
        said.insert(0, f"Stamps are kept in standard time of {zone}, UTC{shift / HOUR:+g} h, all year.")
    else:
        said.insert(0, "Stamps have no zone: they are taken as local standard time all year.")
    return [_ascending(each) for each in found], said


def standard_time(times: pd.DatetimeIndex, zone: str | None) -> pd.DatetimeIndex:
    """Return stamps, of a zone or of the clock on the wall, in naive local standard time; raise `StudyError`.

    Stamps in UTC alone do not say where the room is. Without any zone they are taken as local standard time.
    """
    if times.tz is None and not zone:
        return times
    if not zone and str(times.tz) == "UTC":
        raise refusal("frame", "its times are in UTC, which does not tell where the room is", "say its timezone")
    there = zone or str(times.tz)
    utc = times if times.tz is not None else wall_to_utc(times, there, pd.RangeIndex(len(times)), "frame")[0]
    return utc.tz_convert("UTC").tz_convert(None) + _standard(there, utc.min())


def _in_utc(readings: Readings, zone: str) -> tuple[Readings, str]:
    if not zone:
        _refuse_back(readings)
        _refuse_forward(readings)
        return readings, ""
    if readings.times.tz is not None:
        return replace(readings, times=readings.times.tz_convert("UTC")), ""
    times, sentence = wall_to_utc(readings.times, zone, readings.written.index, readings.where)
    return replace(readings, times=times), sentence


def _refuse_back(readings: Readings) -> None:
    """Refuse a clock that is put back by an hour in a night of autumn: only its zone tells the two hours apart."""
    back = np.flatnonzero(np.diff(readings.times.asi8) < 0)
    if len(back) and len(back) <= 2 * max(1, len(np.unique(readings.times.year))):
        before, after = readings.times[back[0]], readings.times[back[0] + 1]
        if before - after <= HOUR and before.month in (3, 4, 9, 10, 11) and before.hour <= 3:
            wrong = f"{readings.entity}: time goes back from {before} to {after}, as where summer time ends"
            raise refusal(readings.where, wrong, HINT, row=readings.written.index[back[0] + 1])


def _goes_back(readings: Readings) -> list[str]:
    """Return what is said of a clock that was set back while it logged: which of two hours a row is of is lost.

    Nothing of rows in any order, nor of those that come late by less than their usual distance.
    """
    steps = np.diff(readings.times.asi8)
    usual = float(np.median(np.abs(steps))) if len(steps) else 0.0
    back = np.flatnonzero((steps < 0) & (-steps >= usual))
    if not len(back) or np.sum(steps < 0) > OUT_OF_ORDER * len(steps):
        return []
    place, row = back[0], readings.written.index[back[0] + 1]
    times = "" if len(back) == 1 else f" ({len(back)} times)"
    before, after = (f"{at:%Y-%m-%d %H:%M:%S}" for at in readings.times[[place, place + 1]])
    zone = " UTC" if readings.times.tz is not None else ""
    at = f"row {row}: time goes back from {before} to {after}{zone}{times}"
    return [f"{Path(readings.where).name}, {at}: rows are put in the order of their stamps, and of equal ones the last "
            "counts. If the clock was set back there, cut the file in two."]  # fmt: skip


def _refuse_forward(readings: Readings) -> None:
    """Refuse a clock that is put forward by an hour in a night of spring: all later readings would be late by it."""
    if (before := hour_left_out(readings.times)) is not None:
        wrong = f"{readings.entity}: an hour is missing after {before}, as where summer time begins"
        row = readings.written.index[int(np.flatnonzero(readings.times == before)[0])]
        raise refusal(readings.where, wrong, f"{HINT}; or Etc/UTC if nothing was logged then", row=row)


def without_unset(readings: Readings) -> Readings:
    """Return readings without those of a clock that was not yet set, where all others come years later."""
    days = readings.times.tz_localize(None).normalize()
    is_unset = np.asarray(days.isin(pd.DatetimeIndex(UNSET)))
    if not is_unset.any() or is_unset.all() or readings.times[~is_unset].min() < readings.times[is_unset].max() + YEAR:
        return readings
    name, day = Path(readings.where).name, f"{days[is_unset][0]:%Y-%m-%d}"
    said = f"{name}: what was read on {day} is left out: the clock was not set yet."
    rest = readings.times[~is_unset], readings.written[~is_unset]
    return replace(readings, times=rest[0], written=rest[1], notes=(*readings.notes, said))


def _forward(readings: Readings) -> Readings:
    """Return readings from the first to the last; some files begin with the last."""
    if len(readings.times) > 1 and readings.times[0] > readings.times[-1]:
        return replace(readings, times=readings.times[::-1], written=readings.written.iloc[::-1])
    return readings


def _ascending(readings: Readings) -> Readings:
    """Return readings in order of time, once each: of two at one instant the later row stays."""
    if readings.times.is_monotonic_increasing and readings.times.is_unique:
        return readings
    order = np.argsort(readings.times.asi8, kind="stable")
    order = order[~readings.times[order].duplicated(keep="last")]
    return replace(readings, times=readings.times[order], written=readings.written.iloc[order])


def wall_to_utc(times: pd.DatetimeIndex, zone: str, rows: pd.Index, where: str) -> tuple[pd.DatetimeIndex, str]:
    """Return stamps of the wall in UTC, in the order of the file, and what was assumed of the hour that is there twice.

    Raises `StudyError` for stamps within the hour that is left out: that clock is not put forward.
    """
    flags = np.ones(len(times), dtype=bool)
    summer = times.tz_localize(zone_of(zone), ambiguous=flags, nonexistent="NaT")
    winter = times.tz_localize(zone_of(zone), ambiguous=~flags, nonexistent="NaT")
    lost = np.asarray(summer.isna())
    if lost.any():
        place = int(np.argmax(lost))
        wrong = f"{times[place]} is not there in {zone}, as clocks are put forward then: the logger's clock was not"
        fixed = _winter_zone(zone, times[place])
        raise refusal(where, wrong, f"say --timezone {fixed}" if fixed else "", row=rows[place])
    twice = np.asarray(summer != winter)
    if not twice.any():
        return summer.tz_convert("UTC"), ""
    is_second, is_told = _second_pass(times, twice)
    whole = summer.where(~is_second, winter).tz_convert("UTC")
    day = times[int(np.argmax(twice))]
    what = "their order tells which is which" if is_told else "nothing tells which it is: taken as summer time"
    if not is_told and (fixed := _winter_zone(zone, day)):
        what += f" (of a logger whose clock is not put back, say --timezone {fixed})"
    said = f"{int(twice.sum())} stamps lie in the hour that is there twice on {day:%Y-%m-%d}: {what}"
    return pd.DatetimeIndex(whole), said


def _winter_zone(zone: str, at: pd.Timestamp) -> str:
    """Return the zone that keeps the standard time of another one all year, "" where that is no whole hour."""
    offset = _standard(zone, at)
    return "" if offset % HOUR else fixed_zone(offset // HOUR)


def _second_pass(times: pd.DatetimeIndex, twice: np.ndarray) -> tuple[np.ndarray, bool]:
    """Return which stamps lie in the second of two equal hours, and whether the order tells it."""
    ns = times.asi8
    is_second = np.zeros(len(times), dtype=bool)
    is_told = True
    places = np.flatnonzero(twice)
    for run in np.split(places, np.flatnonzero(np.diff(times[places].normalize().asi8) != 0) + 1):
        back = np.flatnonzero(np.diff(ns[run]) < 0)
        if len(back) == 1:  # the clock was put back once
            is_second[run[back[0] + 1 :]] = True
        elif (again := np.asarray(times[run].duplicated())).any():
            is_second[run[again]] = True
        else:
            is_told = False
    return is_second, is_told


def _standard(zone: str, at: pd.Timestamp) -> timedelta:
    """Return how far local standard time is ahead of UTC at an instant, or what the wall shows."""
    return standard_ahead(zone_of(zone), (at if at.tz is not None else at.tz_localize(UTC)).to_pydatetime())
