"""Which column of a file is what, in which unit, and its numbers."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from waxstudy.dataset.columns import numbers_of
from waxstudy.dataset.limits import CODES, CODES_ABOVE
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.stamps import stamps_of
from waxstudy.dataset.tables import DatasetTable
from waxstudy.plugin import FloatArray
from waxstudy.plugin.registry import nearest
from waxstudy.study.problems import listed, shown

if TYPE_CHECKING:
    import pandas as pd

# what a header calls it, without its unit -> the channel whose checks of numbers apply
NAMES: Mapping[str, tuple[str, ...]] = {
    "time": ("time", "t", "timestamp", "elapsed", "elapsed time"),
    "signal": ("signal", "heating_signal", "heating signal", "voltage", "supply"),
    "displacement": ("displacement", "position", "opening", "travel"),
    "flow": ("flow", "volume_flow", "volume flow"),
}
CHANNEL = {"signal": "heating_signal", "displacement": "displacement", "flow": "flow_L_h"}
UNITS = ("mm", "um", "µm", "m", "inch", "V", "s", "min", "h", "L/h", "l/h", "l/min", "m3/h", "1", "%", "-")
SUFFIXES = {"L_h": "L/h", "l_h": "L/h", "mm": "mm", "um": "um", "V": "V", "s": "s", "min": "min", "h": "h"}
FIRST = 20  # cells that tell stamps from numbers
THOUSANDS = r"\d{1,3}([,.' \u00a0\u202f]\d{3})+([.,]\d+)?"
SECONDS = {"": 1.0, "s": 1.0, "min": 60.0, "h": 3600.0}


class Named(NamedTuple):
    """A column: its name in the file, and the unit that the name tells."""

    column: str
    unit: str


def split(header: str) -> tuple[str, str]:
    """Return what a header names and its unit.

    >>> split("Displacement [mm]"), split("signal_V"), split("time")
    (('displacement', 'mm'), ('signal', 'V'), ('time', ''))
    """
    if found := re.fullmatch(r"(.*?)\s*[\[(](.*?)[\])]\s*", header):
        return found[1].strip().lower(), found[2].strip()
    for suffix, unit in SUFFIXES.items():
        if header.endswith(f"_{suffix}"):
            return header.removesuffix(f"_{suffix}").lower(), unit
    return header.strip().lower(), ""


def find(table: pd.DataFrame, wanted: str, given: Mapping[str, str], notes: Notes) -> Named | None:
    """Return the column of what is wanted; note it if there is none or more than one."""
    names = [str(name) for name in table.columns]
    if wanted in given:
        if given[wanted] in names:
            return Named(given[wanted], split(given[wanted])[1])
        near = nearest(given[wanted], names)
        notes.refuse(
            wanted, f"there is no column '{given[wanted]}'", line=1, near=near, allowed=f"columns: {listed(names)}"
        )
        return None
    found = [name for name in names if split(name)[0] in NAMES[wanted]]
    if len(found) == 1:
        return Named(found[0], split(found[0])[1])
    wrong = "no column has this name" if not found else f"more than one column could be it: {listed(found)}"
    hint = f'--column {wanted}="NAME" says which it is; columns: {listed(names)}'
    notes.refuse(wanted, wrong, line=1, allowed=hint)
    return None


def without_units(table: pd.DataFrame, notes: Notes) -> pd.DataFrame:
    """Return the table without a second line that holds units, which made texts of all numbers."""
    import pandas as pd

    first = [str(cell).strip().strip("[]()") for cell in table.iloc[0]] if len(table) else []
    said = [cell for cell in first if cell not in ("", "nan", "None", "<NA>")]
    if not said or not all(cell in UNITS for cell in said) or all(cell in ("1", "-") for cell in said):
        return table
    notes.warn(f"line {notes.line_of(2)} holds units ({', '.join(said)}): it is passed over")
    line_of = notes.line_of
    notes.line_of = lambda row: line_of(row + 1 if row > 1 else row)
    rest = table.iloc[1:].reset_index(drop=True)
    texts = [name for name in rest.columns if pd.api.types.is_string_dtype(rest[name])]
    for name in texts:
        numbers = pd.to_numeric(rest[name].str.replace(",", ".", regex=False), errors="coerce")
        if numbers.notna().any():
            rest[name] = numbers
    return rest


def values_of(table: pd.DataFrame, wanted: str, named: Named, notes: Notes) -> FloatArray | None:
    """Return a column's numbers, NaN where missing; a logger's code for missing is one."""
    numbers = numbers_of(CHANNEL[wanted], table[named.column], notes)
    if numbers is None:
        return None
    values = numbers.to_numpy(dtype=float, copy=True)
    codes = np.isin(values, (*CODES, *CODES_ABOVE))
    if codes.any():
        samples = "1 sample is" if codes.sum() == 1 else f"{codes.sum()} samples are"
        notes.warn(f"{named.column}: {samples} a code for a missing sample: taken as missing")
        values[codes] = np.nan
    if np.isnan(values).all():
        notes.refuse(named.column, "holds no value at all")
        return None
    return values


def seconds_of(table: pd.DataFrame, named: Named, about: DatasetTable, notes: Notes) -> FloatArray | None:
    """Return the time from the first row [s]: of stamps, or of numbers in the unit that the header tells."""
    import pandas as pd

    written = table[named.column]
    if pd.api.types.is_datetime64_any_dtype(written) or not pd.api.types.is_numeric_dtype(written):
        first = pd.to_numeric(written.dropna().head(FIRST), errors="coerce")
        if pd.api.types.is_datetime64_any_dtype(written) or first.isna().any():
            stamps = stamps_of(table, named.column, about, notes)
            return None if stamps is None else np.asarray((stamps.times - stamps.times[0]).total_seconds(), dtype=float)
        numbers = pd.to_numeric(written, errors="coerce")
        return _elapsed(numbers.to_numpy(dtype=float), named, notes, [str(cell) for cell in written[numbers.isna()]])
    return _elapsed(written.to_numpy(dtype=float), named, notes)


def _elapsed(values: FloatArray, named: Named, notes: Notes, unread: Sequence[str] = ()) -> FloatArray | None:
    """Return numbers as seconds; note the first that is missing, goes back or is there twice.

    `unread` are the cells that are no numbers.
    """
    if named.unit not in SECONDS:
        notes.refuse(named.column, f"the unit '{named.unit}' of the time is not known", line=1, allowed="s, min or h")
        return None
    missing = np.flatnonzero(~np.isfinite(values))
    if len(missing):
        cell = unread[0] if unread and unread[0] not in ("nan", "<NA>", "None") else ""
        hint = "numbers are written without a mark between thousands" if re.fullmatch(THOUSANDS, cell) else ""
        wrong = f"is no number ({len(missing)} such rows)"
        notes.refuse(named.column, wrong, line=int(missing[0]) + 2, value=shown(cell) if cell else "", allowed=hint)
        return None
    if len(values) < 2:
        notes.refuse(named.column, "a record needs at least two rows")
        return None
    steps = np.diff(values)
    for bad, wrong in ((steps < 0.0, "time goes back"), (steps == 0.0, "the same time as in the row before")):
        if bad.any():
            row = int(np.argmax(bad)) + 1
            more = f" ({int(bad.sum())} such places)" if bad.sum() > 1 else ""
            notes.refuse(named.column, wrong + more, line=row + 2, value=shown(float(values[row])))
    return None if (steps <= 0.0).any() else SECONDS[named.unit] * (values - values[0])
