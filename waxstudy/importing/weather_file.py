"""Weather files in EnergyPlus's format (EPW): measured weather of a record's days is a source, a typical year none."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from datetime import timedelta, timezone
from pathlib import Path

import numpy as np
import pandas as pd

from waxstudy.importing.reading import Place, Readings, refusal
from waxstudy.plugin.files import DATA_BYTES, read_file

BEGINNING = b"LOCATION"
HEADER_LINES = 8
DATE = ("year", "month", "day", "hour")
# names that say what each is, but less clearly than a house's own sensor does -> column, unit, range, whether a mean
COLUMNS = {
    "weather temperature": (6, "degC", (-70.0, 70.0), False),
    "weather global irradiance": (13, "W/m2", (0.0, 1500.0), True),
    "weather diffuse irradiance": (15, "W/m2", (0.0, 1500.0), True),
}
# years pieced together from months of many, by what their makers call them
TYPICAL = re.compile(r"\b((TMY|TRY|IWEC|WYEC|CWEC|CTZ|RMY|SWEC|DSY)\w{0,4}|IGDG|(?i:typical))\b")
NO_TYPICAL = (
    "a typical year is not the weather that the record had: what it would explain of a room, and what not, would be "
    "chance"
)
MEND = "take measured weather of those days (an 'AMY' or 'actual' file), or a weather service's history"


def read_weather(path: Path, where: str) -> Iterator[Readings]:
    """Yield temperature and light of an EPW file in UTC; raise `StudyError` for a typical year or a damaged file."""
    lines = [line.decode("latin-1") for line in read_file(path, DATA_BYTES).splitlines()]
    rows, times, place = _rows(lines, where)
    if says := TYPICAL.search(" ".join(line for line in lines[:HEADER_LINES] if line.startswith(("LOC", "COMM")))):
        raise refusal(where, f"says that it is '{says[0]}': {NO_TYPICAL}", MEND, row=1)
    if len(back := np.flatnonzero(np.diff(times.asi8) <= 0)):
        years = f"after {times[back[0]]:%Y-%m} comes {times[back[0] + 1]:%Y-%m}"
        raise refusal(where, f"{years}: {NO_TYPICAL}", MEND, row=int(rows.index[back[0] + 1]))
    for name, (column, unit, (low, high), is_mean) in COLUMNS.items():
        values = pd.to_numeric(rows[column], errors="coerce")
        values = values.where((values >= low) & (values <= high))  # EPW has 99.9 and 9999 for what is missing
        if values.notna().any() and values.max() > low:
            yield Readings(name, where, times, values, unit, is_mean, place=place)


def _rows(lines: Sequence[str], where: str) -> tuple[pd.DataFrame, pd.DatetimeIndex, Place]:
    """Return the hours by their rows, the ends of them, and the place."""
    try:
        head = lines[0].split(",")
        place = Place(float(head[6]), float(head[7]), float(head[9]))
        zone = timezone(timedelta(hours=float(head[8])))
        rows = pd.read_csv(io.StringIO("\n".join(lines[HEADER_LINES:])), header=None, skip_blank_lines=False)
        rows.index = rows.index + HEADER_LINES + 1
        stamps = rows[[0, 1, 2, 3]].astype(int).set_axis(DATE, axis=1)
        days = pd.to_datetime(stamps[list(DATE[:3])])
        times = pd.DatetimeIndex(days + pd.to_timedelta(stamps["hour"], "h")).tz_localize(zone).tz_convert("UTC")
        if rows[[column for column, *_ in COLUMNS.values()]].iloc[-1].isna().all():
            raise ValueError("the last hour is cut off")
    except (ValueError, KeyError, IndexError, OverflowError) as error:
        raise refusal(where, "is no whole weather file (EPW)", "download it again") from error
    return rows, times, place
