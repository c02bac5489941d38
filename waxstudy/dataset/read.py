"""Reading a dataset: description, data, grid, checks; all problems at once (format: docs/datasets.md)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from waxstudy.dataset.building import read_room
from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.columns import TIME, channels_of
from waxstudy.dataset.grid import on_grid
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.stamps import stamps_of
from waxstudy.dataset.tables import Column, DatasetTable, Nominal
from waxstudy.dataset.text import read_table
from waxstudy.plugin import CHAIN
from waxstudy.plugin.registry import Registry, installed, nearest
from waxstudy.study.check import Check
from waxstudy.study.ladder import merge_block
from waxstudy.study.model import Choice
from waxstudy.study.problems import StudyError, listed
from waxstudy.study.source import read_source
from waxstudy.study.spots import RawTable, Spot

if TYPE_CHECKING:
    import pandas as pd

TABLES = ("dataset", "nominal", "building", "room", "noise", "columns")
FILES = ("data.csv", "data.parquet")


@dataclass(frozen=True)
class Dataset:
    """A record on a regular grid, and what the modeller believes."""

    name: str
    folder: Path
    interval_s: float
    time: pd.DatetimeIndex  # naive local standard time, end of each interval
    values: pd.DataFrame  # index = time; a column per channel that is there; NaN = missing or discarded
    assumed: tuple[str, ...]  # channels that are assumed rather than measured
    nominal: Mapping[str, Choice]  # chain blocks by kind, as Case.blocks
    setpoint_C: float | None  # believed; the channel setpoint_C, if there, wins
    room: Choice | None
    noise: Mapping[str, float]  # standard deviation by channel
    warnings: tuple[str, ...]  # what the user must know
    assumptions: tuple[str, ...]  # what was assumed, one sentence each


def read_dataset(folder: Path, registry: Registry | None = None) -> Dataset:
    """Return the checked dataset of a folder; raise `StudyError` with every problem of its files."""
    check = Check(read_source(folder / "dataset.toml"), registry or installed())
    path = _data_path(check, folder)
    notes = Notes(str(path or folder))
    _tell_unknown(check, (), TABLES, notes)
    about = _about(check, notes)
    columns, time = _columns(check)
    nominal, setpoint_C = _nominal(check, notes)
    room = read_room(check, notes)
    noise = _noise(check)
    told = not check.problems
    values = _values(path, about, columns, time, notes) if path and told else None
    problems = [*check.problems, *notes.problems]
    if problems or values is None:
        raise StudyError(problems)
    return Dataset(
        name=about.name or folder.resolve().name,
        folder=folder,
        interval_s=_interval_s(values),
        time=_index(values),
        values=values,
        assumed=tuple(name for name in about.inputs if name in values),
        nominal=nominal,
        setpoint_C=setpoint_C,
        room=room,
        noise=noise,
        warnings=tuple(dict.fromkeys(notes.warnings)),
        assumptions=tuple(dict.fromkeys(notes.assumptions)),
    )


def _values(
    path: Path, about: DatasetTable, columns: Mapping[str, Column], time: str, notes: Notes
) -> pd.DataFrame | None:
    """Return the channels on the grid, looked at; note what is wrong with them."""
    table = read_table(path, about, notes)
    if table is None:
        return None
    times = stamps_of(table, time, about, notes)
    channels = channels_of(table, columns, time, notes)
    if times is None or channels is None:
        return None
    return on_grid(channels, times, about, notes)


def _index(values: pd.DataFrame) -> pd.DatetimeIndex:
    import pandas as pd

    return pd.DatetimeIndex(values.index)


def _interval_s(values: pd.DataFrame) -> float:
    return float((values.index[1] - values.index[0]).total_seconds())


def _about(check: Check, notes: Notes) -> DatasetTable:
    """Return [dataset]; the defaults where it has a problem, which is noted."""
    spot = Spot.table("dataset")
    table = check.table(spot) or {}
    _tell_unknown(check, spot.path, DatasetTable.model_fields, notes)
    known = {key: value for key, value in table.items() if key in DatasetTable.model_fields}
    return check.parameters(DatasetTable, RawTable.of(known, spot)) or DatasetTable()


def _tell_unknown(check: Check, path: tuple[Any, ...], allowed: Any, notes: Notes) -> None:
    """Whoever records data may add remarks; a misspelled key should not go unnoticed."""
    table = check.table(Spot("", path, 0)) or {}
    for key in table:
        if key not in allowed:
            near = nearest(key, allowed)
            hint = f"; did you mean '{near}'?" if near else ""
            place = f"{check.source.file}:{check.source.line((*path, key))}"
            notes.warn(f"{place}: {'.'.join((*path, key))} is not known and not read{hint}")


def _data_path(check: Check, folder: Path) -> Path | None:
    spot = Spot.table("dataset").at("file")
    table = check.source.values.get("dataset")
    name = table.get("file") if isinstance(table, dict) else None
    if isinstance(name, str):
        path = folder / name
        if _is_file(path):
            return path
        check.problem(spot, "no such file", value=name, allowed=f"looked for {path}")
        return None
    found = [folder / name for name in FILES if _is_file(folder / name)]
    if not found:
        check.problem(Spot.table(), f"there is no {' or '.join(FILES)} beside it, and [dataset] names no file")
    return found[0] if found else None


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):  # too long, or with characters that no file name has
        return False


def _columns(check: Check) -> tuple[dict[str, Column], str]:
    """Return [columns]: an entry per channel, and the name of the time column."""
    spot = Spot.table("columns")
    table = dict(check.table(spot) or {})
    time = table.pop(TIME, TIME)
    if not isinstance(time, str):
        check.problem(spot.at(TIME), "must be the name of the time column in quotes", value=time)
    check.unknown_keys(spot, table, [TIME, *CHANNELS])
    columns: dict[str, Column] = {}
    for channel, entry in table.items():
        if channel in CHANNELS and (column := _column(check, spot.at(channel), entry)):
            columns[channel] = column
    return columns, str(time)


def _column(check: Check, spot: Spot, entry: Any) -> Column | None:
    """Return an entry: a name stands for a column, a list for the mean of its columns."""
    if isinstance(entry, str | list):
        entry = {"column" if isinstance(entry, str) else "mean": entry}
    if not isinstance(entry, dict):
        check.problem(spot, 'must be a column\'s name or a table such as { column = "...", scale = 0.001 }', value=entry)
        return None
    return check.parameters(Column, RawTable.of(entry, spot))


def _nominal(check: Check, notes: Notes) -> tuple[dict[str, Choice], float | None]:
    """Return the believed chain and setpoint; an empty [nominal] says that nothing is believed."""
    spot = Spot.table("nominal")
    if "nominal" not in check.source.values:
        check.problem(spot, "missing: the chain that is believed; an empty table if nothing is known of it")
        return {}, None
    table = check.table(spot) or {}
    check.unknown_keys(spot, table, [*CHAIN, "setpoint_C"])
    blocks: dict[str, RawTable] = {}
    for kind in CHAIN:
        if kind in table:
            merge_block(check, blocks, kind, table[kind], spot.at(kind))
    if blocks and "controller" not in blocks and "controller" not in table:
        allowed = f"installed: {listed(check.registry.names('controller'))}"
        check.problem(spot.at("controller"), "missing: a chain needs a controller", allowed=allowed)
    if not blocks:
        notes.warn("nothing is believed of the control chain ([nominal] has no block): the room alone can be looked at")
    rest = {key: value for key, value in table.items() if key == "setpoint_C"}
    believed = check.parameters(Nominal, RawTable.of(rest, spot))
    chain = {kind: check.choice(kind, block) for kind, block in blocks.items()}
    return {kind: choice for kind, choice in chain.items() if choice}, believed.setpoint_C if believed else None


def _noise(check: Check) -> dict[str, float]:
    spot = Spot.table("noise")
    table = check.table(spot) or {}
    check.unknown_keys(spot, table, CHANNELS)
    noise: dict[str, float] = {}
    for channel, sd in table.items():
        if isinstance(sd, bool) or not isinstance(sd, int | float) or not 0.0 <= sd < float("inf"):
            check.problem(spot.at(channel), "must be a standard deviation of at least 0", value=sd)
        elif channel in CHANNELS:
            noise[channel] = float(sd)
    return noise
