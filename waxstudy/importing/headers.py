"""What stands above a table's readings: names of columns, units behind them or in a row of their own."""

from __future__ import annotations

import re
from collections.abc import Hashable

import pandas as pd

from waxstudy.importing.stamps import is_stamps
from waxstudy.importing.units import BASE, WRITTEN, fitting, is_unit
from waxstudy.importing.words import SIGN, is_told_in_words

BRACKETED = re.compile(r"^(?P<name>.*?)\s*[\[(](?P<unit>[^\])]*)[\])]\s*$")
SLASHED = re.compile(r"^(?P<name>.+?)\s+/\s+(?P<unit>\S+)$")
COMMA = re.compile(r"^(?P<name>[^,]+),\s*(?P<unit>[^\s,(\d][^\s,(]*)\s*(?:\((?P<about>.*)\))?$")
LABEL = re.compile(r"LBL:\s*(?P<label>[^,]+)")  # as loggers by Onset write it
EVERY = re.compile(r"\((?:TimeStep|Each Call|Hourly|Daily|Monthly|RunPeriod|Annual)\)\s*$")  # as EnergyPlus writes it


def parted(column: str) -> tuple[str, str]:
    """Return a column's name without the unit that stands behind it, and the unit.

    >>> parted("T_room [degF]"), parted("Flow / L/min"), parted("Temp, °C (S/N: 12, LBL: bath)"), parted("T (outside)")
    (('T_room', 'degF'), ('Flow', 'L/min'), ('bath Temp', '°C'), ('T (outside)', ''))
    """
    column = EVERY.sub("", column)
    comma = COMMA.match(column)
    if comma and _is_unit(comma["unit"]):
        label = LABEL.search(about := comma["about"] or "")
        words = [label["label"].strip(), comma["name"]] if label else [comma["name"], about]
        return " ".join(words).strip(), comma["unit"]
    found = BRACKETED.match(column) or SLASHED.match(column)
    is_told = found and (not found["unit"].strip() or is_unit(found["unit"].strip()))
    return (found["name"].strip(), found["unit"].strip()) if found and is_told else (column.strip(), "")


def _is_unit(written: str) -> bool:
    """Whether what stands behind a comma is a unit: not a letter, which may as well name the third room."""
    is_plain = len(written) > 1 and written.lower() in WRITTEN
    return is_plain or (any(sign in written for sign in "°/%") and bool(fitting(written, list(BASE))))


def units_row(frame: pd.DataFrame) -> tuple[dict[str, str], pd.DataFrame]:
    """Return the units of a row below the names, if there is one, and the table without it."""
    first = frame.iloc[0]
    told = {name: str(cell).strip() for name, cell in first.items() if isinstance(cell, str) and str(cell).strip()}
    others = [name for name in frame.columns if name not in told and pd.notna(first[name])]
    is_row = told and not others and not any(is_value(cell) for cell in told.values())
    is_row = is_row and not is_stamps(first.astype(object).dropna().astype(str)) and _is_unlike(frame, told)
    if not is_row:
        return {}, frame
    rest = frame.iloc[1:]
    return {str(name): unit.strip("[]()") for name, unit in told.items()}, rest.infer_objects()


def is_value(cell: str) -> bool:
    if is_told_in_words(cell):
        return True
    begins_as_number = re.fullmatch(SIGN + r"[.,]?\d[\d.,:eE \-/TZ+]*", cell)  # T1 and E2 are names
    return begins_as_number is not None and (cell.lower() not in WRITTEN or cell.isdigit())


def _is_unlike(frame: pd.DataFrame, told: dict[Hashable, str]) -> bool:
    """Whether the cells are of another kind than those below them."""
    second = dict(frame.iloc[1])
    return any(not isinstance(second[name], str) or is_value(str(second[name])) for name in told)
