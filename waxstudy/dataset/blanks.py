"""Tables whose cells blanks part, as simulations write them; the names may stand behind a `#`."""

from __future__ import annotations

import re
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from waxstudy.dataset.limits import LOOKED_AT

SEPARATORS = (",", ";", "\t", "|")  # with one of them a text is no such table
COMMENT = "#"  # begins the lines above a header that are passed over
MISSING = ("-", "--", "---")  # besides what pandas takes for missing: "", "NA", "NaN", "null", ...
NUMBER = re.compile(r"[-+]?[.,]?\d[\d.,:/ TZ+-]*")  # or a stamp


TOLD_BY = 10  # rows that tell that blanks part cells: a bad one further down is told with its line


class Blanks(NamedTuple):
    """Names of columns, and how many lines there are up to them."""

    names: list[str]
    above: int


def blanks_of(path: Path, encoding: str) -> Blanks | None:
    """Return the names of a table of numbers and stamps that blanks part; None of any other text."""
    with path.open(encoding=encoding, errors="replace") as file:
        lines = [(number, line.strip()) for number, line in enumerate(islice(file, LOOKED_AT), 1) if line.strip()]
    rows = [(number, text.split()) for number, text in lines if not text.startswith(COMMENT)]
    if len(rows) < 3 or any(mark in text for _, text in lines for mark in SEPARATORS):
        return None
    first, width = rows[0][0], len(rows[1][1])
    readings = [cells for _, cells in rows[1:TOLD_BY]]
    if width < 2 or not all(len(cells) == width and all(map(_is_number, cells)) for cells in readings):
        return None
    comments = [text.lstrip(COMMENT).split() for number, text in lines if number < first]
    names, above = (comments[-1], first - 1) if all(map(_is_number, rows[0][1])) and comments else (rows[0][1], first)
    return Blanks(names, above) if len(names) == width and not any(map(_is_number, names)) else None


def table_in_blanks(path: Path, encoding: str, blanks: Blanks) -> pd.DataFrame:
    """Return the table; raise `ValueError` for rows that have more or fewer cells than there are names."""
    about: dict[str, Any] = {"sep": r"\s+", "encoding": encoding, "header": None, "names": blanks.names}
    about |= {"index_col": False, "skiprows": blanks.above}
    written = pd.DataFrame(pd.read_csv(path, dtype=str, keep_default_na=False, **about))
    lacks = (written == "").any(axis="columns").to_numpy()
    if lacks.any():
        line = blanks.above + int(lacks.argmax()) + 1
        raise ValueError(f"a cell is missing in line {line}, and blanks do not tell which")
    return pd.DataFrame(pd.read_csv(path, na_values=MISSING, low_memory=False, **about))


def _is_number(cell: str) -> bool:
    if NUMBER.fullmatch(cell):
        return True
    try:
        float(cell)  # 1.5e-03, nan
    except ValueError:
        return False
    return True
