"""What is known of records before they are read: `records.toml` beside them, or nothing but their names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import takewhile
from pathlib import Path
from typing import Any, TypeVar

from waxstudy.dataset.tables import DatasetTable
from waxstudy.plugin import Parameters, parameter
from waxstudy.plugin.files import check_file, lacking
from waxstudy.plugin.registry import installed
from waxstudy.study.check import Check
from waxstudy.study.problems import StudyError
from waxstudy.study.source import read_source
from waxstudy.study.spots import RawTable, Spot

DESCRIPTION = "records.toml"
SUFFIXES = (".csv", ".txt", ".tsv", ".parquet")
TABLES = ("simulated", "origin", "columns", "format", "record")
LOOKED_AT = 4096  # bytes above a header
USER = "given by the user"


class Columns(Parameters):
    """`[columns]`: the file's names of what is read."""

    time: str | None = parameter(None, unit="", description="column of the time", source=USER)
    signal: str | None = parameter(None, unit="", description="column of the heating signal", source=USER)
    displacement: str | None = parameter(None, unit="", description="column of the displacement", source=USER)
    flow: str | None = parameter(None, unit="", description="column of the flow", source=USER)


class Format(Parameters):
    """`[format]`: how the files are written, as in `[dataset]` of a dataset; found if it is not stated."""

    separator: str | None = parameter(None, unit="", description="between the cells", source=USER)
    decimal: str | None = parameter(None, unit="", description="mark of decimals", source=USER)
    time_format: str | None = parameter(None, unit="", description="format of the stamps", source=USER)


class RecordTable(Parameters):
    """`[record.NAME]`"""

    file: str = parameter(unit="", description="the record's file", source=USER)
    product: str | None = parameter(None, unit="", description="what its maker calls the motor", source=USER)
    exemplar: str | None = parameter(None, unit="", description="which motor of that product", source=USER)
    valve: bool = parameter(False, unit="", description="whether a valve was attached", source=USER)
    profile_min: str | None = parameter(None, unit="min", description="on and off times, in words", source=USER)
    measured: str = parameter("displacement", unit="", description="displacement or flow", source=USER)


@dataclass(frozen=True)
class Described:
    """A record's file and what is known of it."""

    path: Path
    name: str
    product: str | None = None
    exemplar: str | None = None
    has_valve: bool = False
    profile: str = ""
    measured: str = "displacement"
    is_simulated: bool = False
    columns: Mapping[str, str] = field(default_factory=dict)
    about: DatasetTable = field(default_factory=DatasetTable)


def described(paths: Sequence[Path], measured: str = "displacement") -> list[Described]:
    """Return the records of files and folders; raise `StudyError`.

    What `records.toml` beside a file says of it holds for it. Records of another quantity are passed over, unless there
    is nothing else.
    """
    found: dict[Path, Described] = {}
    for path in paths:
        table = _in_folder(path if path.is_dir() else path.parent)
        if path.is_dir():
            files = sorted(p for p in path.iterdir() if p.suffix in SUFFIXES)
            found |= table or {p.resolve(): Described(p, p.stem) for p in files}
        else:
            found[path.resolve()] = table.get(path.resolve(), Described(path, path.stem))
    known = [replace(each, is_simulated=each.is_simulated or is_marked(each.path)) for each in found.values()]
    return _told_apart([each for each in known if each.measured == measured] or known)


def is_marked(path: Path) -> bool:
    """Whether a comment above the header says that a record is simulated, as those of the virtual bench do."""
    try:
        check_file(path)
        with path.open("rb") as file:
            head = file.read(LOOKED_AT).replace(b"\0", b"").decode("utf-8", errors="ignore").lstrip("\ufeff")
    except OSError:  # reading the record tells
        return False
    comments = takewhile(lambda line: not line.strip() or line.lstrip().startswith("#"), head.splitlines())
    return any("simulated" in line.lower() for line in comments)


def _told_apart(records: Sequence[Described]) -> list[Described]:
    """Return the records under names that differ: with their folder, and at last a number, where they do not."""
    names = [each.name for each in records]
    longer = [
        f"{each.path.resolve().parent.name}/{each.name}" if names.count(each.name) > 1 else each.name
        for each in records
    ]
    return [
        replace(each, name=name if longer.count(name) == 1 else f"{name} ({longer[:place].count(name) + 1})")
        for place, (each, name) in enumerate(zip(records, longer, strict=True))
    ]


def _in_folder(folder: Path) -> dict[Path, Described]:
    """Return what `records.toml` says, by file; files that it does not name share its columns and format."""
    path = folder / DESCRIPTION
    if not path.is_file():
        return {}
    check = Check(read_source(path), installed())
    values = check.source.values
    check.unknown_keys(Spot.table(), values, TABLES)
    columns = _part(check, "columns", Columns)
    written = _part(check, "format", Format)
    records = {name: _record(check, folder, name) for name in check.table(Spot.table("record")) or {}}
    about = check.parameters(DatasetTable, RawTable.of(written.model_dump(exclude_none=True), Spot.table("format")))
    if check.problems or about is None:
        raise StudyError(check.problems)
    common: dict[str, Any] = {
        "is_simulated": values.get("simulated") is True,
        "columns": columns.model_dump(exclude_none=True),
        "about": about,
    }
    named = {
        (folder / record.file).resolve(): Described(
            folder / record.file,
            name,
            record.product,
            record.exemplar,
            record.valve,
            record.profile_min or "",
            record.measured,
            **common,
        )
        for name, record in records.items()
        if record
    }
    if named:
        return named
    return {p.resolve(): Described(p, p.stem, **common) for p in sorted(folder.iterdir()) if p.suffix in SUFFIXES}


P = TypeVar("P", bound=Parameters)


def _part(check: Check, name: str, model: type[P]) -> P:
    spot = Spot.table(name)
    return check.parameters(model, RawTable.of(check.table(spot) or {}, spot)) or model()


def _record(check: Check, folder: Path, name: str) -> RecordTable | None:
    spot = Spot.table("record", name)
    record = check.parameters(RecordTable, RawTable.of(check.table(spot) or {}, spot))
    if record and (wrong := lacking(folder / record.file)):
        check.problem(spot.at("file"), wrong, value=record.file)
    return record
