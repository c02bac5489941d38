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
QUALITY = ("quality", "qualität", "qualitaet", "güte")  # may be in OPC's codes: bad, uncertain, good
UNCERTAIN_FROM, GOOD_FROM, GOOD_UP_TO = 64, 192, 255  # by their two highest bits of eight
LOST = "unavailable"  # a word after which nothing is held


def without_status(table: Table, time: str) -> tuple[pd.DataFrame, pd.Series, list[str]]:
    """Return a table without columns that say how good readings are, whether each row is bad by them, and what is said.

    A column with any other word, or with other numbers, is none of them: it may be what was read. Several of one name,
    also of one that is numbered, judge the columns of readings before them, or whole rows where the first has none.
    """
    frame, file = table.frame, Path(table.where).name
    bad = pd.Series(False, index=frame.index)
    if CODE in frame and {*HOW} & {*frame.columns}:
        bad |= frame[CODE].notna() & ~frame[CODE].isin(CODE_GOOD)  # without a code nothing is said of a reading
        frame = frame.drop(columns=[CODE, *(name for name in HOW if name in frame)])
    named = {name: found for name in map(str, frame.columns) if (found := plain_name(name)) in NAMES}
    before, last, said = dict[str, str](), "", list[str]()
    for name in map(str, frame.columns):
        before[name], last = last, last if name in named or name == time else name
    has_own = bool(named) and before[next(iter(named))] != ""
    for name, found in named.items():
        if (judged := _judged(frame[name], found)) is None:
            unknown = f"'{name}' says how good readings are in a way that is not known: it judges none."
            said += [f"{file}: {unknown}"] if found in QUALITY and frame[name].notna().any() else []
            continue
        said += [f"{file}: {sentence}" for sentence in _uncertain(frame[name], found)]
        if list(named.values()).count(found) > 1 and has_own:
            frame, told = _judging(frame, before[name], judged)
            said += [f"{file}: {told}"] if told else []
        else:
            bad |= judged
        frame = frame.drop(columns=name)
    return frame, bad, said


def _judging(frame: pd.DataFrame, name: str, bad: pd.Series) -> tuple[pd.DataFrame, str]:
    if not bad.any():
        return frame, ""
    said = f"{int(bad.sum())} readings of '{name}' are bad by the status behind it: missing."
    return frame.assign(**{name: frame[name].astype(object).mask(bad, LOST)}), said


def plain_name(name: str) -> str:
    """Return the name of a column in lower case without a number behind it, as tables have that repeat one.

    >>> plain_name("Quality 2"), plain_name("Quality.1"), plain_name("Status")
    ('quality', 'quality', 'status')
    """
    return re.sub(r"[ ._]*\d+$", "", name.strip().lower())


def _judged(column: pd.Series, name: str) -> pd.Series | None:
    """Return which readings a column calls bad, None where it says something else."""
    if name in QUALITY and (codes := _codes(column)) is not None:
        return codes < UNCERTAIN_FROM
    words = {cell: _words(str(cell)) for cell in column.dropna().unique()}
    if not words or any(word not in GOOD and word not in BAD for told in words.values() for word in told):
        return None
    return column.isin([cell for cell, told in words.items() if {*told} & {*BAD}])


def _codes(column: pd.Series) -> pd.Series | None:
    """Return codes of OPC, in a byte whose two highest bits tell how good a reading is; None for other numbers."""
    codes = pd.to_numeric(column, errors="coerce")
    is_byte = codes.between(0, GOOD_UP_TO) & (codes == codes.round())
    is_coded = bool(is_byte[column.notna()].all()) and bool((codes >= GOOD_FROM).any())
    return codes if is_coded else None


def _uncertain(column: pd.Series, name: str) -> list[str]:
    codes = _codes(column) if name in QUALITY else None
    count = 0 if codes is None else int(codes.between(UNCERTAIN_FROM, GOOD_FROM, inclusive="left").sum())
    return [f"{count} rows are uncertain by '{column.name}', and kept."] if count else []


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
