"""Annotated CSV of InfluxDB: tables below each other, each below lines of annotations and names of its own."""

from __future__ import annotations

import re
from collections.abc import Iterator
from io import StringIO
from pathlib import Path

import pandas as pd

from waxstudy.dataset.blanks import MISSING
from waxstudy.dataset.text import encoding_of
from waxstudy.importing.reading import Table, refusal

BEGINNING = re.compile(rb"#(?:group|datatype|default),")
FORMAT = "annotated CSV of InfluxDB"


def read_annotated(path: Path, where: str) -> Table:
    """Return all tables of a file as one, its rows counted as the file's lines."""
    lines = path.read_text(encoding=encoding_of(path)).split("\n")
    frames = [_frame([lines[place] for place in places], places, where) for places in _blocks(lines)]
    if not frames:
        raise refusal(where, f"is {FORMAT} without a table", "export it again")
    return Table(where, pd.concat(frames))


def _blocks(lines: list[str]) -> Iterator[list[int]]:
    """Yield the places of each table's lines: its names, and its rows."""
    block: list[int] = []
    for place, line in enumerate(lines):
        if line.startswith("#"):
            if block:
                yield block
            block = []
        elif line.strip():
            block.append(place)
    if block:
        yield block


def _frame(block: list[str], places: list[int], where: str) -> pd.DataFrame:
    try:
        frame = pd.read_csv(StringIO("\n".join(block)), na_values=MISSING, low_memory=False, index_col=False)
    except ValueError as error:
        raise refusal(
            where, f"is {FORMAT}, and one of its tables cannot be read: {error}", row=places[0] + 1
        ) from error
    return frame.rename(columns=str.strip).set_axis([place + 1 for place in places[1:]], axis="index")
