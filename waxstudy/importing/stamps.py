"""Stamps as they are written: dates and times of any common form, with an offset from UTC or none, and epochs."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from datetime import timedelta, timezone
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from waxstudy.dataset.limits import YEARS
from waxstudy.dataset.stamps import ZONED, hour_left_out
from waxstudy.importing.limits import LOOKED_AT, MOSTLY, TRIED, YEAR_DAYS
from waxstudy.importing.months import in_english
from waxstudy.importing.reading import Unordered, problem, refusal
from waxstudy.study.problems import shown

# least and unit of an epoch by its size: the years 1973 to 5138 in seconds, and so on
EPOCHS = ((1e17, "ns"), (1e14, "us"), (1e11, "ms"), (1e8, "s"))
CLOCKS = ("%H:%M:%S", "%H:%M", "%H:%M:%S.%f", "%H:%M:%S,%f", "%I:%M:%S %p", "%I:%M %p", "")
# by the mark between them; years of two digits may stand first, and "-" is left to those of four
ORDERS = (
    ("%d.%m.%Y", "%m.%d.%Y"),
    ("%d/%m/%Y", "%m/%d/%Y"),
    ("%d-%m-%Y", "%m-%d-%Y"),
    ("%d.%m.%y", "%y.%m.%d"),
    ("%d/%m/%y", "%m/%d/%y", "%y/%m/%d"),
    *((form,) for form in ("%Y-%m-%d", "%Y/%m/%d")),  # with a clock of twelve hours
    *((form,) for form in ("%d-%b-%Y", "%d-%b-%y", "%d %b %Y", "%d %B %Y", "%b %d, %Y", "%B %d, %Y", "%b %d %Y")),
)
TWO_DIGITS = r"\d{1,2}[./]\d{1,2}[./]\d{1,2}"  # a date or an address: a time of day or a name tells
# digits alone, by how many there are; milliseconds since 1970 had twelve until 2001, of which few are dates
CALENDAR = {12: "%Y%m%d%H%M", 14: "%Y%m%d%H%M%S"}
# hours ahead of UTC of names that mean one zone to a logger
ZONES = {
    "UTC": 0, "GMT": 0, "WET": 0, "WEST": 1, "BST": 1, "CET": 1, "MEZ": 1, "CEST": 2, "MESZ": 2, "EET": 2, "EEST": 3,
    "EST": -5, "EDT": -4, "CDT": -5, "MST": -7, "MDT": -6, "PST": -8, "PDT": -7,
}  # fmt: skip
# one of them is a word in lower case
ZONE = rf"(?P<zone>{'|'.join(zone if zone in ('WET', 'WEST', 'EST') else f'(?i:{zone})' for zone in ZONES)})"
ZONE_BEHIND = rf"(?<=[\dMm])\s+((?:{'|'.join(ZONES)})(?:(?<=UTC|GMT)[+\-\u2212]\d[\d:]*)?)$"
# before a date, however the word ends: in English, German and French
WEEKDAY = r"^(?i:mon|tue|wed|thu|fri|sat|sun|mo|di|mi|do|fr|sa|so|lun|mar|mer|jeu|ven|dim)[^\W\d_]*[.,]?\s+(?=\d)"
BETWEEN = r"(?<=\d)\s+(?:at|@|um)\s+(?=\d)"  # a day and a clock
DOTTED = r"(?<=\d)\s*([AaPp])[.]\s?([Mm])[.]$"  # as spreadsheets in Spanish write am and pm
GLUED = r"(?<=\d)(?=[AaPp][Mm]$)"
MIDNIGHT = r"(?<![\d:])24(?=:00(?::00)?(?:\.0+)?$)"  # of the day that ends
DAYS = ("%d", "%j", "%D", "%F", "%x", "%c", "%s")  # of a format, one of which tells the date
MEND_ROWS = "mend these rows, or leave them out"
SAY_FORMAT = "say --time-format '%d/%m/%Y %H:%M' or as it is"
# what tells a zone, as "Time (UTC)", "Zeit (MEZ)", "timestamp_utc" or "Date Time, GMT+01:00"
NAMED_ZONE = re.compile(rf"(?<![A-Za-z]){ZONE}(?![A-Za-z\d])[\s(]*(?P<offset>[+\-\u2212]\s*\d[\d:.]*)?")
NAMED_OFFSET = re.compile(r"([+\-\u2212])\s*(0?\d|1[0-4])(?::?([0-5]\d))?")
OFFSET = r"([+-])(\d\d):?(\d\d)?\s*$"


class Ambiguous(ValueError):
    """Stamps that can be read in two ways, which are different days."""

    forms: tuple[str, ...] = ()


def is_stamps(written: pd.Series, name: str = "") -> bool:
    """Whether a column holds stamps, by its first cells; numbers do if they grow as an epoch does."""
    first = written.dropna().iloc[:LOOKED_AT]
    if first.empty:
        return False
    if pd.api.types.is_datetime64_any_dtype(first):
        return True
    if pd.api.types.is_numeric_dtype(first):
        return bool((first >= EPOCHS[-1][0]).all()) and bool(first.is_unique or name)
    texts = _plain(first)
    if not name and texts.str.fullmatch(TWO_DIGITS).any():
        return False
    try:
        return bool(_texts(texts, None).notna().all())
    except Ambiguous:
        return True
    except ValueError:
        return False


def stamps_of(written: pd.Series, time_format: str | None, where: str) -> pd.DatetimeIndex:
    """Return stamps in UTC with their zone where they tell it, else naive; raise `StudyError` for the first bad one."""
    name = str(written.name)
    if pd.api.types.is_datetime64_any_dtype(written):
        times = written
    elif pd.api.types.is_numeric_dtype(written):
        calendar = _calendar(written)
        times = _epochs(written, where) if calendar is None else calendar
    else:
        try:
            times = _texts(_plain(written), time_format)
        except Ambiguous as error:
            unordered = Unordered([problem(where, str(error), SAY_FORMAT, key=name)])
            unordered.forms = error.forms
            raise unordered from error
        except ValueError as error:
            raise refusal(where, str(error), SAY_FORMAT, key=name) from error
    bad = times.isna().to_numpy()
    if bad.any():
        place = int(np.argmax(bad))
        value = "" if pd.isna(written.iloc[place]) else shown(str(written.iloc[place]))
        others = f" ({bad.sum()} such rows)" if bad.sum() > 1 else ""
        mend = SAY_FORMAT if bad.mean() > MOSTLY else MEND_ROWS
        raise refusal(where, f"no date and time{others}", mend, row=written.index[place], key=name, value=value)
    return _within_years(_in_named_zone(pd.DatetimeIndex(times), name), written, where)


def zone_told(written: pd.Series, time_format: str | None, where: str) -> str:
    """Return a sentence on the zone that a column's name tells; "" where it tells none, or its stamps their own."""
    name = str(written.name)
    if not NAMED_ZONE.search(name) or stamps_of(written.rename(""), time_format, where).tz is not None:
        return ""
    zone = stamps_of(written, time_format, where).tz
    return f"Stamps are in {zone}, as the name '{name}' says." if zone else ""


def _in_named_zone(times: pd.DatetimeIndex, name: str) -> pd.DatetimeIndex:
    """Return stamps that tell no zone in the one that their column's name tells, if any."""
    offset = _ahead(name)
    if times.tz is not None or offset is None:
        return times
    if offset and hour_left_out(times) is not None:
        return times  # a clock on the wall, whatever its zone is called in winter
    return times.tz_localize(timezone(offset) if offset else "UTC")


def _ahead(text: str) -> timedelta | None:
    """Return how far ahead of UTC the zone is that a text names; None without one, or with several.

    >>> _ahead("Time (CET)"), _ahead("CEST (UTC+2)"), _ahead("Zeit MEZ/MESZ"), _ahead("time_utc-2024")
    (datetime.timedelta(seconds=3600), datetime.timedelta(seconds=7200), None, None)
    """
    told = {_offset(found["zone"].upper(), found["offset"]) for found in NAMED_ZONE.finditer(text)}
    return told.pop() if len(told) == 1 else None


def _offset(zone: str, written: str | None) -> timedelta | None:
    """Return how far ahead of UTC a zone is, with an offset behind it; None for a number that is none of hours."""
    if not written:
        return timedelta(hours=ZONES[zone])
    told = NAMED_OFFSET.fullmatch(written)
    if not told or ZONES[zone]:
        return None
    return timedelta(hours=int(told[2]), minutes=int(told[3] or 0)) * (1 if told[1] == "+" else -1)


def _within_years(times: pd.DatetimeIndex, written: pd.Series, where: str) -> pd.DatetimeIndex:
    strange = np.flatnonzero((times.year < YEARS[0]) | (times.year > YEARS[1]))
    if len(strange):
        row = written.index[strange[0]]
        raise refusal(where, f"{times[strange[0]]} is not within the years {YEARS[0]} to {YEARS[1]}", row=row)
    return times.as_unit("ns")


def _calendar(written: pd.Series) -> pd.Series | None:
    """Return numbers, or texts of digits, as dates and times; None where most of them are none."""
    known, is_number = written.dropna(), pd.api.types.is_numeric_dtype(written)
    first = "" if known.empty else f"{known.iloc[0]:.0f}" if is_number else str(known.iloc[0])
    form = CALENDAR.get(len(first))
    if form is None:
        return None
    digits = written.map("{:.0f}".format, na_action="ignore").astype("str") if is_number else written
    if not digits[known.index].str.isdigit().all():
        return None
    ends_day = digits.str.contains(r"^\d{8}24(?:00)+$", na=False)
    times = _read(digits.str.replace(r"(?<=^\d{8})24(?=(?:00)+$)", "00", regex=True), form, False)
    return times + _days(ends_day) if times[known.index].notna().mean() > MOSTLY else None


def _days(ends_day: pd.Series) -> pd.Series:
    """Return the day by which 24 h is later than 0 h."""
    return pd.Series(pd.to_timedelta(ends_day.astype(int), unit="D"))


def _epochs(written: pd.Series, where: str) -> pd.Series:
    size = float(written.abs().median())
    unit: Any = next((unit for least, unit in EPOCHS if size >= least), None)
    if unit is None:
        raise refusal(
            where,
            "numbers that are no seconds, milli-, micro- or nanoseconds since 1970",
            "write date and time",
            row=written.index[0],
            key=str(written.name),
            value=shown(written.iloc[0]),
        )
    if unit == "s":  # with a fraction, of which floats hold microseconds
        written, unit = (written * 1e6).round(), "us"
    times: pd.Series = pd.to_datetime(written, unit=unit, utc=True, errors="coerce")
    return times


def _plain(written: pd.Series) -> pd.Series:
    """Return texts without blanks around them; what a workbook or database gives may be of several types."""
    if isinstance(written.dtype, pd.StringDtype):
        return written.str.strip()
    return written.where(written.isna(), written.astype(str)).astype("str").str.strip()


def _texts(written: pd.Series, time_format: str | None) -> pd.Series:
    """Return texts as stamps; raise `ValueError` where they do not tell which instants they are."""
    first = written.dropna().iloc[:LOOKED_AT]
    if any(re.search(DOTTED, text) for text in first):  # of many rows it would take seconds
        written = written.str.replace(DOTTED, r" \1\2", regex=True)
    times = _as_written(in_english(written) if time_format else written, time_format)
    if time_format or not (times.isna() & written.notna()).any():
        return times
    calendar = _calendar(written)
    return _spelt(written, times) if calendar is None else calendar


def _spelt(written: pd.Series, times: pd.Series) -> pd.Series:
    """Return stamps read again without a zone, a weekday or a word between; 24 h is 0 h of the next day."""
    unread = times.isna() & written.notna()
    zone = written.str.extract(ZONE_BEHIND, expand=False)
    spelt = written.copy()
    spelt[unread] = in_english(spelt[unread])
    for rest, instead in ((ZONE_BEHIND, ""), (WEEKDAY, ""), (BETWEEN, " "), (GLUED, " ")):
        spelt[unread] = spelt[unread].str.replace(rest, instead, regex=True)
    ends_day = spelt.str.contains(MIDNIGHT, na=False)
    spelt[ends_day] = spelt[ends_day].str.replace(MIDNIGHT, "00", regex=True)
    if spelt.equals(written):
        return times
    local = _as_written(spelt, None) + _days(ends_day)
    return _in_zones(local, zone) if zone.notna().any() else local


def _in_zones(local: pd.Series, zone: pd.Series) -> pd.Series:
    """Return wall-clock times in the standard time of the zones named behind them; missing without one."""
    ahead = pd.to_timedelta(zone.map({each: _ahead(each) for each in zone.dropna().unique()}))
    utc = (local - ahead).dt.tz_localize("UTC")
    least = ahead.min()
    return pd.Series(utc.dt.tz_convert(timezone(least.to_pytimedelta()))) if pd.notna(least) and least else utc


def _as_written(written: pd.Series, time_format: str | None) -> pd.Series:
    """Return texts by the one format that they have, missing where they have another; raises as `_texts` does."""
    known = written.dropna()
    if time_format:
        if not any(sign in time_format for sign in DAYS):
            raise ValueError(f"the format '{time_format}' has no date")
        return _read(written, time_format, "%z" in time_format)
    zoned = known.str.contains(ZONED, na=False)
    if zoned.any():
        if zoned.mean() < MOSTLY:
            raise ValueError("some stamps have an offset from UTC and some have none")
        return _with_offset(
            _read(written.where(zoned.reindex(written.index, fill_value=False)), "ISO8601", True), known[zoned]
        )
    iso = _read(known.iloc[:TRIED], "ISO8601", False)
    if iso.notna().all():
        return _read(written, "ISO8601", False)
    found = next(_formats(known.iloc[:TRIED], known), None)
    return _read(written, found or "ISO8601", False)


def _with_offset(times: pd.Series, written: pd.Series) -> pd.Series:
    """Return stamps in the smallest of their offsets from UTC, which is standard time and not summer time."""
    if written.str.endswith("Z").any():
        return times
    found: Any = written.str.extract(OFFSET)
    # an offset of whole hours, +02, has no minutes
    minutes = 60.0 * found[1].astype(float) + found[2].astype(float).fillna(0.0)
    least = float((minutes * np.where(found[0] == "-", -1.0, 1.0)).min())
    return pd.Series(times.dt.tz_convert(timezone(timedelta(minutes=least)))) if least else times


def _read(written: pd.Series, form: str, is_utc: bool) -> pd.Series:
    form_or_iso: Any = form  # pandas' stubs know no format beside coerced errors
    times: pd.Series = pd.to_datetime(written, format=form_or_iso, errors="coerce", utc=is_utc)
    return times


def _formats(first: pd.Series, known: pd.Series) -> Iterator[str]:
    """Yield the format that all of the first stamps have; raise `Ambiguous` where two say different days."""
    for order, between, clock in product(ORDERS, (" ", "T", ", "), CLOCKS):
        forms = [f"{day}{between}{clock}" if clock else day for day in order]
        if _marks(forms[0]) != _marks(str(first.iloc[0])):
            continue
        if not any(_read(first.iloc[:1], form, False).notna().all() for form in forms):
            continue
        fits = [form for form in forms if _read(first, form, False).notna().all()]
        if len(fits) > 1 and not fits[0].startswith("%d.%m.%Y"):  # with points the day comes first
            fits = _year_told(known, [form for form in forms if _read(known, form, False).notna().all()])
            if len(fits) > 1 and not _is_same(known, fits):
                which = "day, month and year" if any(form.startswith("%y") for form in fits) else "day and month"
                error = Ambiguous(f"{which} cannot be told apart")
                error.forms = tuple(fits)
                raise error
        yield from fits[:1]


def _marks(written: str) -> str:
    """Return what stands between the numbers and words of a stamp, or of its format; blanks as one."""
    return re.sub(r"\s+", " ", re.sub(r"%\w|\w", "", written))


def _year_told(known: pd.Series, fits: list[str]) -> list[str]:
    """Return the forms without those that take days for years: days of a record follow each other, and years do not."""
    read = {form: _read(known, form, False) for form in fits}
    days = {form: (times.max() - times.min()).days for form, times in read.items()}
    return [form for form in fits if days[form] < YEAR_DAYS or days[form] == min(days.values())]


def _is_same(known: pd.Series, forms: Sequence[str]) -> bool:
    one, *others = (_read(known, form, False) for form in forms)
    return all(bool((one == other).all()) for other in others)
