"""Tables whose cells blanks part, as simulations write them; the names may stand behind a `#`."""

from __future__ import annotations

import re
import warnings
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from waxstudy.dataset.limits import LEAST_ROWS, LOOKED_AT, TOLD_BY

SEPARATORS = (",", ";", "\t", "|")  # between cells; blanks part none where one of them is
COMMENT = "#"  # begins the lines above a header that are passed over
MISSING = ("-", "--", "---")  # besides what pandas takes for missing: "", "NA", "NaN", "null", ...
NOTHING = (*MISSING, "na", "n/a", "nan", "null", "none")
NUMBER = re.compile(r"[-+]?[.,]?\d[\d.,:/ TZ+-]*")  # or a stamp


class Blanks(NamedTuple):
    """Names of columns, and how many lines there are up to them."""

    names: list[str]
    above: int


def blanks_of(path: Path, encoding: str) -> Blanks | None:
    """Return the names of a table of numbers and stamps that blanks part; None of any other text.

    They stand above the first row, or in the only comment above it that has as many words.
    """
    with path.open(encoding=encoding, errors="replace") as file:
        lines = [(number, line.strip()) for number, line in enumerate(islice(file, LOOKED_AT), 1) if line.strip()]
    start = next((place for place, (_, text) in enumerate(lines) if not text.startswith(COMMENT)), len(lines))
    rows = [text.split() for _, text in lines[start:]]
    is_other = any(mark in text for _, text in lines for mark in SEPARATORS) or any(row[0] == COMMENT for row in rows)
    if is_other or len(rows) < LEAST_ROWS or len(rows[1]) < 2:
        return None
    if not all(len(row) == len(rows[1]) and _holds_readings(row) for row in rows[1 : TOLD_BY + 1]):
        return None
    first = lines[start][0]
    if not _holds_readings(rows[0]):
        names, above = [cell.strip('"') for cell in rows[0]], first
    else:
        told = [text.lstrip(COMMENT).split() for _, text in lines[:start]]
        wide = [words for words in told if len(words) == len(rows[1]) and not any(map(_is_number, words))]
        names, above = wide[0] if len(wide) == 1 else [], first - 1
    return Blanks(names, above) if len(names) == len(rows[1]) and not any(map(_is_number, names)) else None


def table_in_blanks(path: Path, encoding: str, blanks: Blanks) -> pd.DataFrame:
    """Return the table, a row for each line; raise `ValueError` for rows with more or fewer cells than names."""
    about: dict[str, Any] = {"sep": r"\s+", "encoding": encoding, "header": None, "names": blanks.names}
    about |= {"index_col": False, "skiprows": blanks.above, "skip_blank_lines": False}
    with warnings.catch_warnings():
        warnings.simplefilter("error", pd.errors.ParserWarning)
        try:
            written = pd.DataFrame(pd.read_csv(path, dtype=str, keep_default_na=False, **about))
        except pd.errors.ParserWarning as error:
            raise ValueError("rows have more cells than there are names") from error
    is_empty = written == ""
    lacks = (is_empty.any(axis="columns") & ~is_empty.all(axis="columns")).to_numpy()
    if lacks.any():
        line = blanks.above + int(lacks.argmax()) + 1
        raise ValueError(f"a cell is missing in line {line}, and blanks do not tell which")
    table = pd.DataFrame(pd.read_csv(path, na_values=MISSING, low_memory=False, **about))
    return table[~is_empty.all(axis="columns")]


def _holds_readings(row: list[str]) -> bool:
    """Whether a row has numbers, and else nothing but words for what is missing."""
    return any(map(_is_number, row)) and all(_is_number(cell) or cell.lower() in NOTHING for cell in row)


def _is_number(cell: str) -> bool:
    if NUMBER.fullmatch(cell):
        return True
    try:
        return float(cell) == float(cell)  # 1.5e-03; nan is none
    except ValueError:
        return False
