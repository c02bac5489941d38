"""Which files an import reads, and each by what it holds, whatever its name ends in. None is ever written to."""

from __future__ import annotations

import codecs
import gzip
import re
import shutil
import zlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pandas as pd

from waxstudy.dataset.notes import Notes
from waxstudy.dataset.tables import DatasetTable
from waxstudy.dataset.text import read_table
from waxstudy.importing.annotated import BEGINNING as ANNOTATED
from waxstudy.importing.annotated import read_annotated
from waxstudy.importing.file_log import BEGINNING as OF_LOG
from waxstudy.importing.file_log import read_file_log
from waxstudy.importing.history import read_history
from waxstudy.importing.limits import BEGINS
from waxstudy.importing.message_log import BEGINNING as OF_MESSAGES
from waxstudy.importing.message_log import read_message_log
from waxstudy.importing.reading import Readings, Table, refusal
from waxstudy.importing.stamps import is_stamps
from waxstudy.importing.status import NAMES as STATUS
from waxstudy.importing.weather_file import BEGINNING, read_weather
from waxstudy.importing.workbook import read_workbook
from waxstudy.plugin.files import DATA_BYTES, check_file, why
from waxstudy.results.atomic import scratch_folder
from waxstudy.study.problems import StudyError

ENDINGS = (
    ".csv", ".csv.gz", ".tsv", ".txt", ".log", ".xlsx", ".xls", ".ods", ".parquet", ".db", ".sqlite",
    ".sqlite3", ".epw",
)  # fmt: skip
ZIP, OLE, GZIP, SQLITE = b"PK\x03\x04", b"\xd0\xcf\x11\xe0", b"\x1f\x8b", b"SQLite"
# what begins so, seen before it is parted into columns: a line of JSON may have a million
NO_TABLES = {
    re.compile(rb"\s*(?:\{\s*[\"}]|\[\s*[\[{\"])"): "JSON",
    re.compile(rb"\S+[, ]\S[^\n]*=\S+ \d{10,19}\r?\n"): "InfluxDB's line protocol",
}
SCRATCH = "waxstudy-import-"


def files_of(sources: Sequence[Path]) -> list[Path]:
    """Return the files of an import, those of a folder by name; raise `StudyError` for a folder without any."""
    files: list[Path] = []
    for source in sources:
        found = sorted(each for each in source.iterdir() if _is_record(each)) if source.is_dir() else [source]
        if not found:
            raise refusal(str(source), "this folder holds no record", f"files that end in {', '.join(ENDINGS)}")
        files += [each for each in found if each not in files]
    return files


def _is_record(path: Path) -> bool:
    name = path.name.lower()
    is_named = path.is_file() and name.endswith(ENDINGS) and not name.startswith(".")
    return is_named and (not name.endswith(".log") or log_reader(_beginning(path)) is not None)  # others log too


def _beginning(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(BEGINS)


def log_reader(beginning: bytes) -> Callable[[Path, str], Table] | None:
    """Return what reads a log that begins so, None for what is no log of readings."""
    start = beginning.removeprefix(codecs.BOM_UTF8).lstrip()
    readers = ((OF_LOG, read_file_log), (OF_MESSAGES, read_message_log), (ANNOTATED, read_annotated))
    return next((read for begin, read in readers if begin.match(start)), None)


def tables_of(path: Path, shown: str = "") -> Iterator[Table | Readings]:
    """Yield what a file holds; raise `StudyError` where it cannot be read."""
    shown = shown or str(path)
    try:
        check_file(path)
        beginning = _beginning(path)
        if beginning.startswith(GZIP):
            yield from _unpacked(path, shown)
        elif beginning.startswith((ZIP, OLE)):
            yield from read_workbook(path, shown)
        elif beginning.startswith(SQLITE):
            yield from read_history(path, shown)
        elif beginning.startswith(BEGINNING):
            yield from read_weather(path, shown)
        elif read_log := log_reader(beginning):
            yield read_log(path, shown)
        else:
            _refuse_other(beginning, shown)
            yield _text(path, shown)
    except OSError as error:
        raise refusal(shown, f"cannot be read: {why(error)}") from error


def _refuse_other(beginning: bytes, shown: str) -> None:
    start = beginning.removeprefix(codecs.BOM_UTF8)
    if what := next((what for form, what in NO_TABLES.items() if form.match(start)), ""):
        raise refusal(shown, f"is no table: it holds {what}", "export a table, with a row for each time")


def _unpacked(path: Path, shown: str) -> Iterator[Table | Readings]:
    """Yield what a compressed file holds, which must not grow beyond what is read of any other."""
    with scratch_folder(SCRATCH) as folder:
        plain = folder / path.name.removesuffix(".gz")
        try:
            with gzip.open(path) as packed, plain.open("wb") as out:
                shutil.copyfileobj(_Limited(packed), out)
        except (EOFError, zlib.error, gzip.BadGzipFile) as error:
            raise refusal(shown, "is no whole gzip file: cut off, or damaged", "export it again") from error
        with plain.open("rb") as file:
            if file.read(2) == GZIP:
                raise refusal(shown, "is compressed twice", "unpack it once")
        yield from tables_of(plain, shown)


class _Limited:
    """What is read of a compressed file, up to `DATA_BYTES`."""

    def __init__(self, packed: gzip.GzipFile) -> None:
        self.packed, self.count = packed, 0

    def read(self, size: int = -1) -> bytes:
        data = self.packed.read(size)
        self.count += len(data)
        if self.count > DATA_BYTES:
            raise OSError(f"it is larger than {DATA_BYTES / 1e6:g} MB when unpacked")
        return data


def _text(path: Path, shown: str) -> Table:
    """Return a CSV or parquet file as the datasets' own reader has it, its rows counted as the file's lines."""
    notes, plain = Notes(shown), Notes(shown)
    frame = read_table(path, DatasetTable(), notes, repeated=STATUS)
    if frame is None or _begins_with_stamps(frame):  # cells of a first reading may be equal, which names are not
        nameless = read_table(path, DatasetTable(), plain, has_names=False)
        if nameless is not None and (frame is not None or any(is_stamps(nameless[name]) for name in nameless.columns)):
            nameless.index = nameless.index + plain.line_of(1)
            return Table(shown, nameless)
    if frame is None:
        raise StudyError(notes.problems)
    frame.index = frame.index + notes.line_of(1) + 1
    return Table(shown, frame)


def _begins_with_stamps(frame: pd.DataFrame) -> bool:
    """Whether a row of readings stands where names of columns should: a stamp is above stamps."""
    for name in filter(re.compile(r".*\d\d").match, map(str, frame.columns)):
        first: pd.Series = pd.Series([name])
        if pd.api.types.is_numeric_dtype(frame[name]):
            first = pd.to_numeric(first, errors="coerce").dropna()
        if is_stamps(first) and is_stamps(frame[name]):
            return True
    return False
