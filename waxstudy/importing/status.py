"""Columns that say how good a reading is, as building automation writes them: what they call bad is missing."""

from __future__ import annotations

import re
from collections.abc import Collection
from pathlib import Path

import pandas as pd

from waxstudy.importing.limits import LOOKED_AT
from waxstudy.importing.reading import Table
from waxstudy.importing.words import numbers_of

NAMES = ("status", "quality", "reliability", "flags", "trend flags", "qualität", "qualitaet", "güte")
BAD = re.compile(
    r"(?<!no )\b(?:bad|fault|down|stale|error|invalid|unreliable|offline|disabled|failed|failure|no sensor|"
    r"out of range|fehler|gestört|störung|ungültig|schlecht)\b",
    re.IGNORECASE,
)
CODE, HOW = "q", ("ack", "from", "_from")  # of ioBroker: 0 is good; whether it was told, and by what
LOST = "unavailable"  # a word after which nothing is held


def without_status(frame: pd.DataFrame) -> tuple[pd.DataFrame, pd.Series]:
    """Return a table without columns that say how good its readings are, and whether each row is bad by them.

    A column of numbers, or of words for on and off, is none of them: it may be what was read.
    """
    bad = pd.Series(False, index=frame.index)
    if CODE in frame and {*HOW} & {*frame.columns}:
        bad |= frame[CODE] != 0
        frame = frame.drop(columns=[CODE, *(name for name in HOW if name in frame)])
    for name in [name for name in frame.columns if str(name).strip().lower() in NAMES]:
        written = frame[name]
        if len(written.dropna()) and not numbers_of(written.dropna().iloc[:LOOKED_AT]).is_readable:
            bad |= written.astype(str).str.contains(BAD)
            frame = frame.drop(columns=name)
    return frame, bad


def without_bad(table: Table, bad: pd.Series, kept: Collection[str]) -> tuple[pd.DataFrame, str]:
    """Return a table whose bad rows have no readings beside the columns that are kept, and a sentence on how many."""
    frame = table.frame
    if not bad.any():
        return frame, ""
    lost = {str(name): frame[name].astype(object).mask(bad, LOST) for name in frame.columns if name not in kept}
    said = f"{Path(table.where).name}: {int(bad.sum())} rows are bad by their status: what they read is missing."
    return frame.assign(**lost), said
