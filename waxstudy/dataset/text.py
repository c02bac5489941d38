"""A data file as a table: encoding, separator and decimal mark are found if they are not stated."""

from __future__ import annotations

import codecs
import csv
import re
import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import islice
from pathlib import Path

import pandas as pd

from waxstudy.dataset.blanks import COMMENT, MISSING, NUMBER, SEPARATORS, blanks_of, table_in_blanks
from waxstudy.dataset.limits import LOOKED_AT, TITLES
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.tables import DatasetTable
from waxstudy.plugin.files import check_file

PARQUET = b"PAR1"
# Excel and other archives, Excel of before 2007, gzip, HDF5, SQLite
BINARY = (b"PK\x03\x04", b"\xd0\xcf\x11\xe0", b"\x1f\x8b", b"\x89HDF", b"SQLite")
PIECE = 1_000_000  # characters that are read at a time to find the encoding
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+")
DECIMAL_POINT = re.compile(r"[-+]?\d*\.\d+")


def read_table(
    path: Path, about: DatasetTable, notes: Notes, *, has_names: bool = True, repeated: Sequence[str] = ()
) -> pd.DataFrame | None:
    """Return the file's columns as they are written, an index of stamps as a column; note why it cannot be read.

    Columns of a text that has no names for them are called "column 1" and so on. Names that may be `repeated`, in lower
    case, are numbered.
    """
    try:
        check_file(path)
        with path.open("rb") as file:
            beginning = file.read(8)
        if beginning.startswith(BINARY):
            notes.refuse("", "is no text: export it as CSV, or as parquet")
            return None
        return _parquet(path, notes) if beginning.startswith(PARQUET) else _csv(path, about, notes, has_names, repeated)
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


def _csv(
    path: Path, about: DatasetTable, notes: Notes, has_names: bool, repeated: Sequence[str]
) -> pd.DataFrame | None:
    encoding = encoding_of(path)
    if about.separator is None and (blanks := blanks_of(path, encoding)):
        notes.line_of = lambda row: blanks.above + row - 1  # the names are row 1
        return None if _has_twice(blanks.names, notes) else table_in_blanks(path, encoding, blanks)
    head = list(islice(_kept(path, encoding), LOOKED_AT + 1))
    if not head:
        notes.refuse("", "is empty: a header with the names of the columns is expected in its first line")
        return None
    titles, separator = _titles([text for _, text in head], about.separator)
    above, rows = head[titles][0] - 1, [text for _, text in head[titles:]]
    notes.line_of = partial(_line_of, path, encoding, titles)
    if titles:
        notes.assume(f"The names of the columns are in line {above + 1}: what stands above them is passed over.")
    has_commas = separator != "," and _has_decimal_commas(rows, separator)
    header = [name.strip() for name in next(csv.reader(rows[:1], delimiter=separator))]
    if not has_names:
        header = [f"column {place}" for place in range(1, len(header) + 1)]
    if _has_twice([name for name in header if name.lower() not in repeated], notes):
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
                header=0 if has_names else None,
                names=None if has_names else header,
                skipinitialspace=True,
                index_col=False,
                na_values=MISSING,
                low_memory=False,
            )
        except pd.errors.ParserWarning:
            notes.refuse("", "rows have more cells than the header has names; is the separator or decimal mark right?")
            return None
    return pd.DataFrame(data).rename(columns=str.strip)


def _has_twice(names: Sequence[str], notes: Notes) -> bool:
    """Refuse names that two columns have."""
    twice = sorted({name for name in names if name and names.count(name) > 1})
    if twice:
        notes.refuse(", ".join(twice), "there are two columns of this name", line=1)
    return bool(twice)


def encoding_of(path: Path) -> str:
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


def _titles(head: list[str], stated: str | None) -> tuple[int, str]:
    """Return how many lines above the names of the columns are titles, as instruments write them, and the separator."""
    found = [(*_names(head, mark), mark) for mark in ((stated,) if stated else SEPARATORS)]
    count, place, separator = max(found, key=lambda each: each[0])
    if count > 1 and place > 0:
        return place, separator
    return 0, stated or max(SEPARATORS, key=lambda mark: head[0].count(mark))


def _names(head: list[str], separator: str) -> tuple[int, int]:
    """Return how many names of columns there are with a separator, 0 for none, and in which line.

    They stand in the first line with more than half of the cells that any has: a title has fewer. Numbers are no names.
    A line that is not as wide as the rows below is a title too, if the next one is not either.
    """
    rows = [[cell.strip(' "') for cell in line.split(separator)] for line in head[: 2 * TITLES]]
    filled = [[cell for cell in row if cell] for row in rows]
    most = max(map(len, filled))
    longer = [place for place, cells in enumerate(filled) if 2 * len(cells) > most] or [0]
    usual = Counter(len(row) for row in rows[longer[0] + 1 :]).most_common(1)
    is_title = usual and all(len(row) != usual[0][0] for row in rows[longer[0] : longer[0] + 2])
    wide = [place for place in longer if len(rows[place]) == usual[0][0]] if is_title else longer
    place = (wide or longer)[0]
    are_names = place <= TITLES and not any(NUMBER.fullmatch(cell) for cell in filled[place])
    return len(filled[place]) if are_names else 0, place


def _line_of(path: Path, encoding: str, titles: int, row: int) -> int:
    """Return the line of a row, the header being row 1."""
    place = titles + row - 1
    return next((number for number, _ in islice(_kept(path, encoding), place, place + 1)), row)


def _has_decimal_commas(head: list[str], separator: str) -> bool:
    cells = [cell.strip().strip('"') for line in head[1:] for cell in line.split(separator)]
    commas = any(DECIMAL_COMMA.fullmatch(cell) for cell in cells)
    return commas and not any(DECIMAL_POINT.fullmatch(cell) for cell in cells)
