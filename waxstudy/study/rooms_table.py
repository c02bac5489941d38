"""A table of rooms: CSV with a row for each kind of room, how many loops have it, and what it is like."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from waxstudy.study.activation import MOST_ROOMS, RoomRow
from waxstudy.study.problems import Problem, StudyError
from waxstudy.study.source import read_text

NAME, LOOPS = "name", "loops"  # columns beside those of its keys


def read_rooms(file: Path) -> list[RoomRow]:
    """Return the rows of a table of rooms; raise `StudyError` with the line that is wrong."""
    reader = csv.reader(io.StringIO(read_text(file)))
    lines = [(reader.line_num, [cell.strip() for cell in row]) for row in reader if any(map(str.strip, row))]
    if len(lines) < 2:
        raise _wrong(file, 1, "a row of column names and at least one room are expected")
    (_, head), *rest = lines
    _check_head(file, head)
    if len(rest) > MOST_ROOMS:
        told = f"{len(rest)} rooms; {MOST_ROOMS} at most: put those that are alike into one row, with {LOOPS}"
        raise _wrong(file, 1, told)
    rows = list(_rows(file, head, rest))
    if len({row.name for row in rows}) < len(rows):
        raise _wrong(file, 1, "two rooms have the same name", NAME)
    return rows


def _check_head(file: Path, head: Sequence[str]) -> None:
    for column in (NAME, LOOPS):
        if column not in head:
            raise _wrong(file, 1, "this column is missing", column, f"columns: {', '.join(head)}")
    if len(set(head)) < len(head) or "" in head:
        raise _wrong(file, 1, "every column needs a name of its own")


def _rows(file: Path, head: Sequence[str], lines: Sequence[tuple[int, list[str]]]) -> Iterator[RoomRow]:
    for line, row in lines:
        if len(row) != len(head) or "" in row:
            raise _wrong(file, line, f"{len(head)} values are expected: {', '.join(head)}")
        cells = dict(zip(head, row, strict=True))
        name, loops = cells.pop(NAME), _number(cells.pop(LOOPS))
        if not isinstance(loops, int | float) or not 0.0 < loops < math.inf:
            raise _wrong(file, line, "must be a number above 0", LOOPS)
        yield RoomRow(name, float(loops), {key: _number(cell) for key, cell in cells.items()}, line)


def _number(text: str) -> Any:
    """Return a number where a cell is one, else its text."""
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            pass
    return text


def _wrong(file: Path, line: int, told: str, key: str = "", allowed: str = "") -> StudyError:
    return StudyError([Problem(str(file), line, "", key, "", told, "", allowed)])
