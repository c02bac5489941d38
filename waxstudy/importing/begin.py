"""Times that tell no date, as simulations write them: counted from a begin, or days without a year."""

from __future__ import annotations

import re
from collections.abc import Hashable

import pandas as pd

from waxstudy.importing.limits import FAR_DAYS, FIRST_STEPS, LEAST_STEP_S, LOOKED_AT
from waxstudy.importing.reading import refusal
from waxstudy.study.problems import shown

UNITS = {
    **dict.fromkeys(("s", "sec", "second", "seconds"), 1.0),
    **dict.fromkeys(("min", "minute", "minutes"), 60.0),
    **dict.fromkeys(("h", "hr", "hour", "hours"), 3600.0),
    **dict.fromkeys(("d", "day", "days"), 86_400.0),
}
# of EnergyPlus: month, day and a clock up to 24:00:00
NO_YEAR = re.compile(r"\s*(?P<month>\d\d)/(?P<day>\d\d)\s+(?P<hour>\d\d):(?P<minute>\d\d)(?::(?P<second>\d\d))?\s*")
NO_BEGIN = "say when it begins: --begin 2026-01-31"


def counts_from_begin(written: pd.Series) -> bool:
    """Whether numbers grow from 0, or near it, as the time of a simulation does."""
    first = written.dropna().iloc[:LOOKED_AT]
    if not pd.api.types.is_numeric_dtype(first) or len(first) < 2:
        return False
    steps = first.diff().dropna()
    return bool((steps >= 0.0).all() and (steps > 0.0).any() and 0.0 <= first.iloc[0] <= FIRST_STEPS * steps.max())


def has_no_year(written: pd.Series) -> bool:
    first = written.dropna().iloc[:LOOKED_AT].astype(str)
    return len(first) > 0 and bool(first.str.fullmatch(NO_YEAR).all())


def counted(written: pd.Series, unit: str, begin: pd.Timestamp | None, where: str) -> pd.Series:
    """Return the times of numbers that count from a begin, in seconds if no unit is told."""
    name = str(written.name)
    seconds = UNITS.get(unit.lower()) if unit else 1.0
    if seconds is None:
        raise refusal(where, f"counts time in '{unit}'", f"units of time: {', '.join(UNITS)}", key=name)
    step_s = float(written.diff().where(lambda x: x > 0.0).median()) * seconds
    if not unit and step_s <= LEAST_STEP_S:
        wrong = f"counts time in steps of {step_s:.3g}, which are hardly seconds"
        raise refusal(where, wrong, "say what it counts in: --time-format h, or min, d; s if it is seconds", key=name)
    if begin is None:
        first = f"{written.iloc[0]:g}, {written.iloc[1]:g}"
        raise refusal(where, f"no column holds stamps: '{name}' counts from a begin ({first}, ...)", NO_BEGIN, key=name)
    digits = 3 if seconds == 1.0 else 0  # of hours and days there are too few to tell milliseconds
    return begin + pd.to_timedelta((written * seconds).round(digits), unit="s")


def with_year(written: pd.Series, begin: pd.Timestamp | None, where: str) -> pd.Series:
    """Return the times of days without a year, the first of which is near the begin; after December comes the next."""
    name = str(written.name)
    if begin is None:
        raise refusal(where, f"stamps tell no year ({shown(str(written.iloc[0]))})", NO_BEGIN, key=name)
    parts = written.astype(str).str.extract(NO_YEAR).astype(float)
    bad = _first_bad(parts)
    if bad is not None:
        value = shown(str(dict(written)[bad]))
        raise refusal(where, "no day and time", "mend these rows, or leave them out", row=bad, key=name, value=value)
    is_back = parts["month"].diff() < 0.0
    if (is_back & ((parts["month"] != 1.0) | (parts["month"].shift() != 12.0))).any():
        raise refusal(where, "days go back, as in a file of several runs", "leave one run in it", key=name)
    parts["year"] = begin.year + is_back.cumsum()
    # a clock may be written without seconds, and is whole minutes then
    clock = 3600.0 * parts["hour"] + 60.0 * parts["minute"] + parts["second"].fillna(0.0)
    days = pd.to_datetime(parts[["year", "month", "day"]].astype(int), errors="coerce")
    if days.isna().any():
        row = days.index[days.isna()][0]
        wrong = f"is no day of {int(parts['year'][row])}"
        raise refusal(where, wrong, "say another year: --begin", row=row, key=name, value=shown(str(written[row])))
    times = days + pd.to_timedelta(clock, unit="s")
    if abs(times.iloc[0] - begin) > pd.Timedelta(days=FAR_DAYS):
        wrong = f"begins at {shown(str(written.iloc[0]))}, far from --begin {begin:%Y-%m-%d}"
        raise refusal(where, wrong, f"say --begin {begin.year}-{times.iloc[0]:%m-%d}, or another year", key=name)
    return times


def _first_bad(parts: pd.DataFrame) -> Hashable | None:
    bad = parts[["month", "day", "hour", "minute"]].isna().any(axis=1)
    return parts.index[bad][0] if bad.any() else None
