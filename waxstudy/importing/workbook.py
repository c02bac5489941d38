"""Workbooks: each sheet that holds a table. The reader is calamine's."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile, is_zipfile

import pandas as pd

from waxstudy.importing.limits import LEAST_COLUMNS, LEAST_ROWS, TITLED
from waxstudy.importing.reading import Table, refusal
from waxstudy.plugin.files import DATA_BYTES

WORKBOOK = ("[Content_Types].xml", "mimetype")  # one of which an archive holds that is a workbook
ENCRYPTED = "EncryptedPackage".encode("utf-16-le")  # the stream that a workbook with a password has


def read_workbook(path: Path, where: str) -> Iterator[Table]:
    """Yield the tables of a workbook; raise `StudyError` for one that is locked, damaged or without any."""
    from python_calamine import CalamineError, CalamineWorkbook

    try:
        _refuse(path, where)
        with CalamineWorkbook.from_path(path) as book:
            sheets = [
                (name, book.get_sheet_by_name(name).to_python(skip_empty_area=False)) for name in book.sheet_names
            ]
    except (CalamineError, BadZipFile) as error:
        if "assword" in f"{type(error).__name__} {error}":
            raise _locked(where) from error
        raise refusal(where, f"is no whole workbook: {error}", "save it again, or export the sheet as CSV") from error
    found = [table for name, rows in sheets if (table := _table(f"{where}, sheet '{name}'", rows)) is not None]
    if not found:
        raise refusal(where, "no sheet holds a table: a row of names, and rows of readings below it")
    yield from found


def _refuse(path: Path, where: str) -> None:
    """Refuse a workbook that is locked, or larger than any file that is read when unpacked."""
    if not is_zipfile(path):
        if ENCRYPTED in path.read_bytes():
            raise _locked(where)
        return
    with ZipFile(path) as packed:
        names = packed.namelist()
        if not any(name in WORKBOOK for name in names):
            more = f" and {len(names) - 1} more" if len(names) > 1 else ""
            wrong = f"is an archive, and no workbook: it holds {names[0] if names else 'nothing'}{more}"
            raise refusal(where, wrong, "unpack it, and name the files in it or their folder")
        if sum(part.file_size for part in packed.infolist()) > DATA_BYTES:
            raise refusal(where, f"is larger than {DATA_BYTES / 1e6:g} MB when unpacked")


def _locked(where: str) -> Exception:
    return refusal(where, "this workbook has a password", "save it without, or export the sheet as CSV")


def _names_at(rows: list[list[Any]]) -> int | None:
    """Return where the names of columns stand: the first texts in over half of the cells that any row has.

    Names of groups above them, and titles, are fewer. Where no such row is there, as of columns without names, the
    first one of more than one cell is taken.
    """
    filled = [[cell for cell in row if cell != ""] for row in rows]
    most = max(map(len, filled), default=0)
    several = [place for place, cells in enumerate(filled) if len(cells) >= LEAST_COLUMNS]
    wide = [place for place in several if 2 * len(filled[place]) > most]
    are_texts = bool(wide) and all(isinstance(cell, str) for cell in filled[wide[0]])
    return wide[0] if are_texts else next(iter(several), None)


def _table(where: str, rows: list[list[Any]]) -> Table | None:
    """Return a sheet below its titles, without which it is none."""
    first = _names_at(rows[:TITLED])
    if first is None or len(rows) - first < LEAST_ROWS:
        return None
    names = [str(cell).strip() for cell in rows[first]]
    chosen = [place for place, name in enumerate(names) if name]
    if twice := sorted({name for name in names if name and names.count(name) > 1}):
        raise refusal(where, "there are two columns of this name", row=first + 1, key=", ".join(twice))
    columns = {
        names[place]: [row[place] if row[place] != "" else None for row in rows[first + 1 :]] for place in chosen
    }
    frame = pd.DataFrame(columns, index=range(first + 2, len(rows) + 1))
    return Table(where, frame.dropna(how="all"))
