"""The column of stamps of a table: by its name or what it holds, a day and a clock, or times without a date."""

from __future__ import annotations

import re
from collections.abc import Hashable, Mapping

import pandas as pd

from waxstudy.dataset.columns import named
from waxstudy.importing.begin import counted, counts_from_begin, has_no_year, with_year
from waxstudy.importing.day_numbers import counting_of, times_of
from waxstudy.importing.headers import parted
from waxstudy.importing.limits import LOOKED_AT, SPREADSHEET_DAYS
from waxstudy.importing.reading import NoStamps, Table, problem, refusal
from waxstudy.importing.stamps import is_stamps

# names of columns, in lower case; what is not named so is told by what it holds
TIME = ("time", "timestamp", "datetime", "date/time", "last_changed", "last_updated", "date_time", "zeit", "_time",
        "zeitstempel", "date", "datum", "ts", "epoch", "when", "last_changed_ts", "last_updated_ts",
        "datenum")  # fmt: skip
DAY = ("date", "datum", "day", "tag")
HOUR = ("hour", "hours", "hour of day", "hr", "stunde", "std", "heure", "tund", "tunti", "ora", "hora", "time")
# of an interval: what is read in it is stamped at its end
BEGIN = ("von", "from", "start", "begin", "beginn", "anfang", "start time", "startzeit", "period_start", "start_time")
END = ("bis", "to", "end", "ende", "until", "end time", "endzeit", "period_end", "end_time")
CLOCK = re.compile(r"\s*\d{1,2}:\d{2}(:\d{2}([.,]\d+)?)?\s*([AaPp][Mm])?\s*")
NO_CLOCK = r"[ T]00:00(:00(\.0+)?)?$"  # as a workbook's days have
EXPECTED = (
    "expected is a column of stamps, and either a column for each sensor, or one of names, one of values; "
    "units may stand in the row below the names"
)


def dated(
    table: Table, units: Mapping[str, str], time_format: str | None, begin: pd.Timestamp | None
) -> tuple[pd.DataFrame, str]:
    """Return a table with dates where its times are day numbers, or have no date or no year, and what is assumed.

    Where nothing is assumed the sentence is "". A format without `%` is the unit of times that count from the begin. A
    table of which another column has stamps stays as it is.
    """
    frame = table.frame
    named_so = [str(name) for name in frame.columns if parted(str(name))[0].lower() in TIME]
    stated = time_format if time_format and "%" not in time_format else ""
    counts_in = {name: units.get(name) or parted(name)[1] or stated for name in named_so}
    countings = {name: counting_of(frame[name]) for name in named_so if begin is None and not counts_in[name]}
    name = next((name for name in named_so if countings.get(name) or _is_undated(frame[name])), None)
    if name is None or any(is_stamps(frame[each]) for each in frame.columns if may_be_stamps(frame[each])):
        return frame, ""
    if counting := countings.get(name):
        times = times_of(frame[name], counting)
        said = f"{name} counts days as {counting.program} does: {frame[name].iloc[0]:.10g} is {times.iloc[0]}."
        return frame.assign(**{name: times}), said
    if has_no_year(frame[name]):
        return frame.assign(**{name: with_year(frame[name], begin, table.where)}), ""
    unit = counts_in[name]
    said = f"{name} counts {unit or 'seconds'} from {begin}" + ("." if unit else ", as no unit is told.")
    return frame.assign(**{name: counted(frame[name], unit, begin, table.where)}), said


def _is_undated(written: pd.Series) -> bool:
    return has_no_year(written) or counts_from_begin(written)


def may_be_stamps(written: pd.Series) -> bool:
    """Whether a column may hold stamps by its name, where it has numbers: those of joules are as large as epochs."""
    return not pd.api.types.is_numeric_dtype(written) or str(written.name).strip().lower() in TIME


def time_column(table: Table) -> tuple[str, pd.DataFrame]:
    """Return the name of the column of stamps, and the table with a day and a time of day put together."""
    frame = table.frame
    lower = {str(name).strip().lower(): str(name) for name in frame.columns}
    by_name = [lower[name] for name in TIME if name in lower]
    for name in [*by_name, *(str(name) for name in frame.columns if name not in by_name)]:
        if not is_stamps(frame[name], name if name in by_name else ""):
            continue
        clock = next((each for each in frame.columns if each != name and _is_clock(frame[each])), None)
        clock = next((each for each in frame.columns if _is_hour(frame[each])), None) if clock is None else clock
        if clock is None or not _is_day(frame[name]):
            return _ending(frame, name)
        return name, _day_and_clock(frame, name, clock)
    clock = next((str(name) for name in frame.columns if _is_clock(frame[name])), None)
    day = next((lower[name] for name in DAY if name in lower and lower[name] != clock), None)
    if clock and day:  # nobody can tell days from months, or the format must be said
        return day, _day_and_clock(frame, day, clock)
    if by_name and not pd.api.types.is_numeric_dtype(frame[by_name[0]]):
        return by_name[0], frame  # whose first bad cell is told where stamps are read
    if by_name and (days := frame[by_name[0]].dropna()).between(*SPREADSHEET_DAYS).all() and len(days):
        wrong = f"no column holds stamps: '{by_name[0]}' has numbers, such as {days.iloc[0]}"
        raise refusal(table.where, wrong, "if they count days, as a spreadsheet does, write them as 2024-01-31 12:00")
    raise NoStamps([problem(table.where, f"no column holds stamps (columns: {named(frame)})", EXPECTED)])


def _ending(frame: pd.DataFrame, begin: str) -> tuple[str, pd.DataFrame]:
    """Return the column of stamps at which intervals end, where they begin at those that were found, and the table."""
    is_begin = begin.strip().lower() in BEGIN
    ends = [str(name) for name in frame.columns if is_begin and str(name).strip().lower() in END]
    end = next((name for name in ends if is_stamps(frame[name]) and frame[name].notna().all()), None)
    return (end, frame.drop(columns=begin)) if end else (begin, frame)


def _day_and_clock(frame: pd.DataFrame, day: str, clock: Hashable) -> pd.DataFrame:
    """Return a table whose column of days has the time of day behind them."""
    days = frame[day].astype(str).str.strip().str.replace(NO_CLOCK, "", regex=True)
    hours = frame[clock]
    is_hour = pd.api.types.is_numeric_dtype(hours)
    both = days + " " + (hours.map("{:02.0f}:00".format) if is_hour else hours.astype(str).str.strip())
    return frame.assign(**{day: both}).drop(columns=[clock])


def _is_clock(written: pd.Series) -> bool:
    first = written.dropna().iloc[:LOOKED_AT].astype(str)
    return len(first) > 0 and bool(first.str.fullmatch(CLOCK).all())


def _is_hour(written: pd.Series) -> bool:
    """Whether a column has hours of the day, 0 to 23 or 1 to 24."""
    if str(written.name).strip().lower() not in HOUR or not pd.api.types.is_integer_dtype(written):
        return False
    return bool(written.between(0, 24).all() and written.nunique() > 1)


def _is_day(written: pd.Series) -> bool:
    first = written.dropna().iloc[:LOOKED_AT].astype(str)
    return not first.str.contains(":").any() or bool(first.str.contains(" 00:00:00").all())
