"""A data file as a table: encoding, separator and decimal mark are found if they are not stated."""

from __future__ import annotations

import codecs
import csv
import re
import warnings
from collections.abc import Iterator
from functools import partial
from itertools import islice
from pathlib import Path

import pandas as pd

from waxstudy.dataset.notes import Notes
from waxstudy.dataset.tables import DatasetTable
from waxstudy.plugin.files import check_file

SEPARATORS = (",", ";", "\t", "|")
MISSING = ("-", "--", "---")  # besides what pandas takes for missing: "", "NA", "NaN", "null", ...
COMMENT = "#"  # begins the lines above a header that are passed over
PARQUET = b"PAR1"
# Excel and other archives, Excel of before 2007, gzip, HDF5, SQLite
BINARY = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0", b"\x1f\x8b", b"\x89HDF", b"SQLite")
PIECE = 1_000_000  # characters that are read at a time to find the encoding
LOOKED_AT = 200  # lines in which the decimal mark is looked for
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+")
DECIMAL_POINT = re.compile(r"[-+]?\d*\.\d+")


def read_table(path: Path, about: DatasetTable, notes: Notes) -> pd.DataFrame | None:
    """Return the file's columns as they are written, an index of stamps as a column; note why it cannot be read."""
    try:
        check_file(path)
        with path.open("rb") as file:
            beginning = file.read(8)
        if beginning.startswith(BINARY):
            notes.refuse("", "is no text: export it as CSV, or as parquet")
            return None
        return _parquet(path, notes) if beginning.startswith(PARQUET) else _csv(path, about, notes)
    except OSError as error:
        notes.refuse("", f"cannot be read: {error.strerror or error}")
    except UnicodeDecodeError:
        notes.refuse("", "is neither text in UTF-8 nor in Windows' western encoding: export it as CSV in UTF-8")
    except ValueError as error:  # pandas' and pyarrow's own errors are ValueErrors
        notes.line_of = int  # the parser counts the file's lines
        found = re.search(r"line (\d+)", str(error))
        notes.refuse("", f"is no table that can be read: {error}", line=int(found[1]) if found else 0)
    return None


def _parquet(path: Path, notes: Notes) -> pd.DataFrame | None:
    try:
        data = pd.read_parquet(path)
    except ValueError:
        notes.refuse("", "is no whole parquet file: cut off, or damaged")
        return None
    if isinstance(data.index, pd.DatetimeIndex):
        data = data.reset_index(names=data.index.name or "time")
    data.columns = data.columns.map(str)
    return data


def _csv(path: Path, about: DatasetTable, notes: Notes) -> pd.DataFrame | None:
    encoding = _encoding(path)
    head, above = _head(path, encoding)
    if not head:
        notes.refuse("", "is empty: a header with the names of the columns is expected in its first line")
        return None
    notes.line_of = partial(_line_of, path, encoding)
    separator: str = about.separator or max(SEPARATORS, key=lambda mark: head[0].count(mark))
    has_commas = separator != "," and _has_decimal_commas(head, separator)
    header = [name.strip() for name in next(csv.reader(head[:1], delimiter=separator))]
    if twice := sorted({name for name in header if name and header.count(name) > 1}):
        notes.refuse(", ".join(twice), "there are two columns of this name", line=1)
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("error", pd.errors.ParserWarning)
        try:
            data = pd.read_csv(
                path,
                sep=separator,
                decimal=about.decimal or ("," if has_commas else "."),
                encoding=encoding,
                skiprows=above,
                skipinitialspace=True,
                index_col=False,
                na_values=MISSING,
                low_memory=False,
            )
        except pd.errors.ParserWarning:
            notes.refuse("", "rows have more cells than the header has names; is the separator or decimal mark right?")
            return None
    return pd.DataFrame(data).rename(columns=str.strip)


def _encoding(path: Path) -> str:
    """Return the encoding; a file that is not UTF-8 is taken for Windows' western one."""
    with path.open("rb") as file:
        if file.read(2) in (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE):
            return "utf-16"
    try:
        with path.open(encoding="utf-8", newline="") as text:
            while text.read(PIECE):  # not all at once: a file may be large
                pass
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8-sig"


def _kept(path: Path, encoding: str) -> Iterator[tuple[int, str]]:
    """Yield the lines that hold something with their numbers: no blank ones, no comments before the header."""
    has_begun = False
    with path.open(encoding=encoding, errors="replace") as file:
        for number, line in enumerate(file, 1):
            text = line.rstrip("\r\n")
            if text.strip() and (has_begun or not text.startswith(COMMENT)):
                has_begun = True
                yield number, text


def _head(path: Path, encoding: str) -> tuple[list[str], int]:
    """Return the first lines that hold something, and how many lines are above them."""
    first = list(islice(_kept(path, encoding), LOOKED_AT + 1))
    return [text for _, text in first], first[0][0] - 1 if first else 0


def _line_of(path: Path, encoding: str, row: int) -> int:
    """Return the line of a row, the header being row 1."""
    return next((number for number, _ in islice(_kept(path, encoding), row - 1, row)), row)


def _has_decimal_commas(head: list[str], separator: str) -> bool:
    cells = [cell.strip().strip('"') for line in head[1:] for cell in line.split(separator)]
    commas = any(DECIMAL_COMMA.fullmatch(cell) for cell in cells)
    return commas and not any(DECIMAL_POINT.fullmatch(cell) for cell in cells)
