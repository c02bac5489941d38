"""Logs of FHEM: a line for each reading, `2026-01-31_16:05:00 Device reading: value`."""

from __future__ import annotations

import re
from pathlib import Path

import pandas as pd

from waxstudy.dataset.text import encoding_of
from waxstudy.importing.reading import Table

DAY_AND_CLOCK = r"\d{4}-\d\d-\d\d_\d\d:\d\d:\d\d(?:\.\d+)?"
BEGINNING = re.compile(rb"\d{4}-\d\d-\d\d_\d\d:\d\d:\d\d(?:\.\d+)? \S+ \S")
LINE = rf"^(?P<time>{DAY_AND_CLOCK}) (?P<device>\S+) (?:(?P<reading>[^\s:]+): )?(?P<value>.*)$"  # a state has no name


def read_file_log(path: Path, where: str) -> Table:
    """Return a table with a row for each line; one that is no reading has its text where a stamp should be."""
    lines = pd.Series(path.read_text(encoding=encoding_of(path)).splitlines(), dtype="str")
    lines.index += 1
    lines = lines[lines.str.strip() != ""]
    parts = lines.str.extract(LINE)
    name = parts["device"].str.cat(parts["reading"].fillna("state"), sep=" ")
    time = parts["time"].str.replace("_", " ").fillna("? " + lines)  # a stamp that was cut off may be a day
    return Table(where, pd.DataFrame({"time": time, "name": name, "value": parts["value"]}))
