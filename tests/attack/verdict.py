"""Whether a command ended as it promises: results that are finite, or an error that says what is wrong, and where."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Collection
from pathlib import Path
from typing import NamedTuple

DONE, USAGE, INVALID, FAILED = 0, 2, 3, 6
# what only Python or a library would say
RAW = re.compile(r"Traceback|\w+Warning\b|\w+Error:|site-packages|\berrno\b|\.py:\d+|Segmentation|core dumped")
TOLD = re.compile(r"(error|warning|note): |interrupted")
LONGEST = 300  # characters of what was said that a failure quotes


class Ended(NamedTuple):
    code: int | None  # None: it did not end in time
    stdout: str
    stderr: str


def wrong_with(ended: Ended, names: Collection[str], codes: Collection[int] = (DONE, INVALID, FAILED)) -> str:
    """Return what is wrong with how a command ended, "" if nothing is; an error names one of these files."""
    said = ended.stderr.strip()[-LONGEST:]
    if ended.code is None:
        return "it did not end in time"
    if RAW.search(ended.stderr) or RAW.search(ended.stdout):
        return f"it said what only a library says: {said}"
    if ended.code not in codes:
        return f"exit code {ended.code}: {said}"
    if ended.code == DONE:
        return ""
    lines = ended.stderr.splitlines()
    if not lines:
        return f"exit code {ended.code} without a word"
    if ended.code == INVALID:
        strange = [line for line in lines if not TOLD.match(line) and not any(name in line for name in names)]
        return f"a line names no file: {strange[0][:LONGEST]}" if strange else ""
    return "" if any(TOLD.match(line) for line in lines) else f"no error is told: {said}"


def not_finite(path: Path) -> str:
    """Return the first figure of a CSV file that is none, "" if all are."""
    with path.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            for name, text in row.items():
                if name in ("case", "week"):  # which may be called NaN
                    continue
                try:
                    number = float(text)
                except ValueError:
                    continue
                if not math.isfinite(number):
                    return f"{path.name}: {name} = {text}"
    return ""
