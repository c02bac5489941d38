"""Columns that say how good a reading is, as building automation writes them: what they call bad is missing."""

from __future__ import annotations

import re
from collections.abc import Collection
from pathlib import Path

import pandas as pd

from waxstudy.importing.reading import Table

NAMES = ("status", "quality", "reliability", "flags", "trend flags", "qualität", "qualitaet", "güte")
# in lower case; a value in alarm, or set by hand, was read all the same
GOOD = ("", "ok", "good", "normal", "reliable", "valid", "no fault", "no error", "alarm", "unackedalarm", "overridden",
        "gut", "gültig", "in ordnung", "kein fehler", "keine störung")  # fmt: skip
BAD = ("bad", "fault", "faulty", "sensor fault", "down", "stale", "error", "invalid", "unreliable", "offline", "null",
       "disabled", "uncertain", "failed", "failure", "comm lost", "no sensor", "out of range", "not ok", "unavailable",
       "missing", "fehler", "gestört", "störung", "ungültig", "schlecht")  # fmt: skip
# of ioBroker: how good, and what is good; whether a reading was told, and by what
CODE, CODE_GOOD, HOW = "q", (0, "0", "0x00"), ("ack", "from", "_from")
LOST = "unavailable"  # a word after which nothing is held


def without_status(frame: pd.DataFrame) -> tuple[pd.DataFrame, pd.Series]:
    """Return a table without columns that say how good its readings are, and whether each row is bad by them.

    A column with any other word, or with numbers, is none of them: it may be what was read.
    """
    bad = pd.Series(False, index=frame.index)
    if CODE in frame and {*HOW} & {*frame.columns}:
        bad |= frame[CODE].notna() & ~frame[CODE].isin(CODE_GOOD)  # without a code nothing is said of a reading
        frame = frame.drop(columns=[CODE, *(name for name in HOW if name in frame)])
    for name in [name for name in frame.columns if str(name).strip().lower() in NAMES]:
        words = {cell: _words(str(cell)) for cell in frame[name].dropna().unique()}
        if words and all(word in GOOD or word in BAD for told in words.values() for word in told):
            bad |= frame[name].isin([cell for cell, told in words.items() if {*told} & {*BAD}])
            frame = frame.drop(columns=name)
    return frame, bad


def _words(cell: str) -> list[str]:
    """Return what a cell says, of several words between commas.

    >>> _words("{fault,stale}"), _words("{ }"), _words("Sensor fault")
    (['fault', 'stale'], [''], ['sensor fault'])
    """
    return [part.strip().lower() for part in re.split(r"[,;|]", cell.strip(" {}[]"))]


def without_bad(table: Table, bad: pd.Series, kept: Collection[str]) -> tuple[pd.DataFrame, str]:
    """Return a table whose bad rows have no readings beside the columns that are kept, and a sentence on how many."""
    frame = table.frame
    if not bad.any():
        return frame, ""
    lost = {str(name): frame[name].astype(object).mask(bad, LOST) for name in frame.columns if name not in kept}
    said = f"{Path(table.where).name}: {int(bad.sum())} rows are bad by their status: what they read is missing."
    return frame.assign(**lost), said
