"""From a file's columns to our channels: names, factors, means and sums of [columns], and numbers."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.limits import CODES, LARGEST, UNREADABLE_SHARE
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.tables import Column
from waxstudy.plugin.registry import hint, nearest
from waxstudy.study.problems import listed, shown

TIME = "time"
WORDS = {"on": 1.0, "true": 1.0, "open": 1.0, "off": 0.0, "false": 0.0, "closed": 0.0}
CODE = "a code for a missing sample"
NEVER_NEGATIVE = ("level", "flow", "gain", "light")  # a temperature in tenths may be -127
THOUSANDS = re.compile(r"\d,\d{3}\b.*\.|\d\.\d{3}\b.*,")
NAMED = 20  # columns that a message lists
TOLD = 5  # columns that get a warning each


def channels_of(
    table: pd.DataFrame, columns: Mapping[str, Column], time: str, notes: Notes, others: Sequence[str] = ()
) -> pd.DataFrame | None:
    """Return the channels that the file has, in our units; a channel is found by its own name or by [columns].

    `others` are columns that something else reads.
    """
    wanted = {name: columns.get(name, Column(column=name)) for name in CHANNELS}
    found = {
        name: column for name, column in wanted.items() if name in columns or (name in table.columns and name != time)
    }
    _tell_others(table, found, {time, *others}, bool(columns), notes)
    _tell_shared(table, {name: [part.column for part in each.parts] for name, each in found.items()}, time, notes)
    if not found:
        allowed = f"columns: {named(table)}; channels: {listed(CHANNELS)}"
        notes.refuse("", "has no channel: name its columns as the channels, or map them in [columns]", allowed=allowed)
        return None
    values = {name: _value(name, column, table, notes) for name, column in found.items()}
    if any(value is None for value in values.values()):
        return None
    return pd.DataFrame(values, index=table.index, copy=False)


def without_empty(channels: pd.DataFrame, notes: Notes) -> pd.DataFrame:
    """Return the channels that hold a value; note it if none does."""
    empty = [name for name in channels.columns if channels[name].isna().all()]
    if len(empty) == len(channels.columns):
        notes.refuse(", ".join(empty), "holds no value at all")
    for name in empty:
        notes.warn(f"{name} holds no value: taken as not measured")
    return channels.drop(columns=empty)


def _value(channel: str, column: Column, table: pd.DataFrame, notes: Notes) -> pd.Series | None:
    """Return one channel; missing wherever one of its columns is."""
    parts = []
    for part in column.parts:
        if part.column not in table.columns:
            near, allowed = nearest(part.column, table.columns), f"columns: {named(table)}"
            notes.refuse(channel, f"there is no column '{part.column}'", near=near, allowed=allowed)
            continue
        numbers = numbers_of(channel, table[part.column], notes)
        if numbers is not None:
            parts.append(part.scale * _without_codes(channel, numbers, column, part.scale, notes))
    if len(parts) < len(column.parts):
        return None
    total = sum(parts[1:], parts[0])
    if column.mean is not None:
        total = total / len(parts)
    return total if (column.scale, column.offset) == (1.0, 0.0) else column.scale * total + column.offset


def _without_codes(channel: str, numbers: pd.Series, column: Column, scale: float, notes: Notes) -> pd.Series:
    """Return a column that is scaled without its codes, which nobody could tell afterwards."""
    is_scaled = (scale, column.scale, column.offset) != (1.0, 1.0, 0.0) or len(column.parts) > 1
    if not is_scaled or CHANNELS[channel].quantity not in NEVER_NEGATIVE:
        return numbers
    codes = numbers.isin(CODES)
    notes.lost(channel, numbers[codes].to_numpy(), CODE)
    return numbers.mask(codes)


def numbers_of(channel: str, written: pd.Series, notes: Notes) -> pd.Series | None:
    """Return a column's numbers; a cell that is none, or beyond `LARGEST`, is missing, and the user is told."""
    if pd.api.types.is_datetime64_any_dtype(written):
        notes.refuse(channel, "holds times, not numbers; are columns swapped?")
        return None
    if CHANNELS[channel].quantity == "level" and pd.api.types.is_string_dtype(written):
        written = _in_words(channel, written, notes)
    numbers = pd.to_numeric(written, errors="coerce").astype(float)
    numbers = numbers.where(numbers.abs() <= LARGEST)
    bad = written.notna() & numbers.isna()
    if not bad.any():
        return numbers
    row = int(np.argmax(bad.to_numpy()))
    example = shown(str(written.iloc[row]))
    is_large = pd.notna(pd.to_numeric(written.iloc[row], errors="coerce"))
    within = f" of at most {LARGEST:g}" if is_large else ""
    if bad.sum() > UNREADABLE_SHARE * written.notna().sum():
        wrong = f"{bad.sum()} of {len(written)} cells are no numbers{within}"
        hint = '[dataset] decimal = "," if it is a decimal comma' if "," in example else ""
        if THOUSANDS.search(example):
            hint = "write numbers without a mark of thousands"
        notes.refuse(channel, wrong, line=row + 2, value=example, allowed=hint)
        return None
    one = bad.sum() == 1
    cells = f"1 cell is no number{within} (it" if one else f"{bad.sum()} cells are no numbers{within} (the first"
    notes.warn(f"{channel}: {cells} is {example} in line {notes.line_of(row + 2)}): missing")
    return numbers


def _in_words(channel: str, written: pd.Series, notes: Notes) -> pd.Series:
    """Return a signal that is told in words as numbers; other cells as they are."""
    words = written.str.strip().str.lower().map(WORDS)
    if words.notna().any():
        notes.assume(f"{channel} is told in words: on, true and open are 1, off, false and closed are 0.")
    return words.astype(object).where(words.notna(), written)


def _tell_others(
    table: pd.DataFrame, found: Mapping[str, Column], read: set[str], is_mapped: bool, notes: Notes
) -> None:
    """Say which columns are not read: in a file of our own each may be a misspelled channel."""
    used = {part.column for column in found.values() for part in column.parts} | read
    others = [name for name in table.columns if name not in used]
    if is_mapped and others:
        columns = "1 column" if len(others) == 1 else f"{len(others)} columns"
        notes.assume(f"Not read: {columns} of the data file that the dataset does not name.")
    strange = [] if is_mapped else others
    for name in strange[:TOLD]:
        notes.warn(f"column '{name}' is no channel and is not read{hint(name, CHANNELS)}")
    if rest := strange[TOLD:]:
        near = [f"'{name}'{hint(name, CHANNELS)}" for name in rest if hint(name, CHANNELS)][:TOLD]
        like = f": among them {'; '.join(near)}" if near else ""
        columns = (
            "1 other column is no channel and is"
            if len(rest) == 1
            else f"{len(rest)} other columns are no channels and are"
        )
        notes.warn(f"{columns} not read{like}")


def _tell_shared(table: pd.DataFrame, read: Mapping[str, Sequence[str]], time: str, notes: Notes) -> None:
    """Say where two columns are there for one channel, and where two channels are one column."""
    for name, columns in {TIME: [time], **read}.items():
        if name in table.columns and name not in columns:
            taken = " and ".join(f"'{column}'" for column in columns)
            notes.warn(f"column '{name}' of the data file is not read, as [columns] takes {name} from {taken}")
    for name, columns in read.items():
        if twins := [other for other in read if other > name and read[other] == columns and len(columns) == 1]:
            who = ", ".join([name, *twins])
            notes.warn(
                f"{who}: all are column '{columns[0]}', so that one says nothing of the other: name the one it is"
            )


def named(table: pd.DataFrame) -> str:
    """Return the names of a file's columns as a message lists them."""
    return listed((str(name) for name in table.columns), NAMED)
