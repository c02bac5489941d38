"""A data file as a table: encoding, separator and decimal mark are found if they are not stated."""

from __future__ import annotations

import csv
import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from waxstudy.dataset.notes import Notes
from waxstudy.dataset.tables import DatasetTable

if TYPE_CHECKING:
    import pandas as pd

SEPARATORS = (",", ";", "\t", "|")
MISSING = ("-", "--", "---")  # besides what pandas takes for missing: "", "NA", "NaN", "null", ...
LOOKED_AT = 200  # lines in which the decimal mark is looked for
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+")
DECIMAL_POINT = re.compile(r"[-+]?\d*\.\d+")


@dataclass(frozen=True)
class Layout:
    """How a text file is written."""

    encoding: str
    separator: str
    decimal: str


def read_table(path: Path, about: DatasetTable, notes: Notes) -> pd.DataFrame | None:
    """Return the file's columns as they are written, an index of stamps as a column; note why it cannot be read."""
    try:
        return _parquet(path) if path.suffix == ".parquet" else _csv(path, about, notes)
    except OSError as error:
        notes.refuse("", f"cannot be read: {error.strerror or error}")
    except ValueError as error:  # pandas' and pyarrow's own errors are ValueErrors
        notes.refuse("", f"is no table that can be read: {error}", line=_line_in(str(error)))
    return None


def _line_in(message: str) -> int:
    found = re.search(r"line (\d+)", message)
    return int(found[1]) if found else 0


def _parquet(path: Path) -> pd.DataFrame:
    import pandas as pd

    data = pd.read_parquet(path)
    if isinstance(data.index, pd.DatetimeIndex):
        data = data.reset_index(names=data.index.name or "time")
    data.columns = data.columns.map(str)
    return data


def _csv(path: Path, about: DatasetTable, notes: Notes) -> pd.DataFrame | None:
    import pandas as pd

    head, encoding = _head(path)
    if not head or not head[0].strip():
        notes.refuse("", "is empty: a header with the names of the columns is expected in line 1")
        return None
    layout = _layout(head, encoding, about)
    header = [name.strip() for name in next(csv.reader(head[:1], delimiter=layout.separator))]
    if twice := sorted({name for name in header if name and header.count(name) > 1}):
        notes.refuse(", ".join(twice), "there are two columns of this name", line=1)
        return None
    options: dict[str, Any] = {"sep": layout.separator, "decimal": layout.decimal, "encoding": layout.encoding}
    with warnings.catch_warnings():
        warnings.simplefilter("error", pd.errors.ParserWarning)
        try:
            data = pd.read_csv(
                path,
                **options,
                skipinitialspace=True,
                index_col=False,
                na_values=MISSING,
                low_memory=False,
            )
        except pd.errors.ParserWarning:
            notes.refuse("", "rows have more cells than the header has names; is the separator or decimal mark right?")
            return None
    return pd.DataFrame(data).rename(columns=str.strip)


def _head(path: Path) -> tuple[list[str], str]:
    """Return the first lines and the encoding; a file that is not UTF-8 is taken for Windows' western one."""
    data = path.read_bytes()
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        encoding = "utf-16"
    else:
        try:
            data.decode("utf-8")
            encoding = "utf-8-sig"
        except UnicodeDecodeError:
            encoding = "cp1252"
    text = data.decode(encoding, errors="replace")
    return text.splitlines()[: LOOKED_AT + 1], encoding


def _layout(head: list[str], encoding: str, about: DatasetTable) -> Layout:
    separator: str = about.separator or max(SEPARATORS, key=lambda mark: head[0].count(mark))
    decimal = about.decimal or ("," if separator != "," and _has_decimal_commas(head, separator) else ".")
    return Layout(encoding, separator, decimal)


def _has_decimal_commas(head: list[str], separator: str) -> bool:
    cells = [cell.strip().strip('"') for line in head[1:] for cell in line.split(separator)]
    commas = any(DECIMAL_COMMA.fullmatch(cell) for cell in cells)
    return commas and not any(DECIMAL_POINT.fullmatch(cell) for cell in cells)
