"""Reading dataset.toml: what the data file is, what its columns are, and what the modeller believes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

from waxstudy.dataset.building import read_room
from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.columns import TIME
from waxstudy.dataset.neighbours import NeighbourTable, read_neighbours
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.tables import Column, DatasetTable, Nominal, Site
from waxstudy.plugin import CHAIN, Parameters
from waxstudy.plugin.registry import hint
from waxstudy.study.check import Check
from waxstudy.study.ladder import merge_block
from waxstudy.study.lines import KeyPath
from waxstudy.study.model import Choice
from waxstudy.study.sentences import value_at
from waxstudy.study.spots import RawTable, Spot

TABLES = (
    "dataset", "site", "nominal", "building", "room", "noise", "columns", "baseline", "neighbours", "import", "believe",
)  # fmt: skip
FILES = ("data.csv", "data.parquet")

P = TypeVar("P", bound=Parameters)


@dataclass(frozen=True)
class Description:
    """What dataset.toml says; what has a problem is left out."""

    about: DatasetTable
    site: Site | None
    time: str  # name of the time column
    columns: Mapping[str, Column]
    nominal: Mapping[str, Choice]
    setpoint_C: float | None
    room: Choice | None
    noise: Mapping[str, float]
    baseline: str | None  # path from the folder of the file
    neighbours: NeighbourTable


def read_description(check: Check, notes: Notes) -> Description:
    """Return what the file says; note its problems in `check`, and what is not read in `notes`."""
    _tell_unknown(check, (), TABLES, notes)
    columns, time = _columns(check)
    nominal, setpoint_C = _nominal(check, notes)
    return Description(
        about=_about(check, notes),
        site=_whole(check, "site", Site),
        time=time,
        columns=columns,
        nominal=nominal,
        setpoint_C=setpoint_C,
        room=read_room(check, notes),
        noise=_noise(check),
        baseline=_baseline(check),
        neighbours=read_neighbours(check, _column),
    )


def _about(check: Check, notes: Notes) -> DatasetTable:
    """Return [dataset]; the defaults where it has a problem, which is noted."""
    spot = Spot.table("dataset")
    table = check.table(spot) or {}
    _tell_unknown(check, spot.path, list(DatasetTable.model_fields), notes)
    known = {key: value for key, value in table.items() if key in DatasetTable.model_fields}
    return check.parameters(DatasetTable, RawTable.of(known, spot)) or DatasetTable()


def _baseline(check: Check) -> str | None:
    spot = Spot.table("baseline")
    table = check.table(spot)
    check.unknown_keys(spot, table or {}, ["path"])
    if not table:
        return None
    if isinstance(table.get("path"), str):
        return str(table["path"])
    check.problem(spot.at("path"), "must be the folder of a dataset in quotes", value=table.get("path"))
    return None


def _whole(check: Check, name: str, kind: type[P]) -> P | None:
    """Return a table that may be left out, None where it is or has a problem, which is noted."""
    spot = Spot.table(name)
    table = check.table(spot)
    return check.parameters(kind, RawTable.of(table, spot)) if table else None


def _tell_unknown(check: Check, path: KeyPath, allowed: Iterable[str], notes: Notes) -> None:
    """Whoever records data may add remarks; a misspelled key should not go unnoticed."""
    table = value_at(check.source.values, path)
    for key in table if isinstance(table, dict) else ():
        if key not in allowed:
            place = f"{check.source.file}:{check.source.line((*path, key))}"
            notes.warn(f"{place}: {'.'.join(map(str, (*path, key)))} is not known and not read{hint(key, allowed)}")


def _columns(check: Check) -> tuple[dict[str, Column], str]:
    """Return [columns]: an entry per channel, and the name of the time column."""
    spot = Spot.table("columns")
    table = dict(check.table(spot) or {})
    time = table.pop(TIME, TIME)
    if not isinstance(time, str):
        check.problem(spot.at(TIME), "must be the name of the time column in quotes", value=time)
    check.unknown_keys(spot, table, [TIME, *CHANNELS])
    found = {name: _column(check, spot.at(name), entry) for name, entry in table.items() if name in CHANNELS}
    return {name: column for name, column in found.items() if column}, str(time)


def _column(check: Check, spot: Spot, entry: Any) -> Column | None:
    """Return an entry: a name stands for a column, a list for the mean of its columns."""
    if isinstance(entry, str | list):
        entry = {"column" if isinstance(entry, str) else "mean": entry}
    if not isinstance(entry, dict):
        check.problem(
            spot, 'must be a column\'s name or a table such as { column = "...", scale = 0.001 }', value=entry
        )
        return None
    return check.parameters(Column, RawTable.of(entry, spot))


def _nominal(check: Check, notes: Notes) -> tuple[dict[str, Choice], float | None]:
    """Return the believed chain and setpoint; an empty [nominal] says that nothing is believed."""
    spot = Spot.table("nominal")
    if "nominal" not in check.source.values and "neighbours" in check.source.values:
        return {}, None  # rooms beside each other need no chain
    if "nominal" not in check.source.values:
        check.problem(spot, "missing: the chain that is believed; an empty table if nothing is known of it")
        return {}, None
    table = check.table(spot) or {}
    check.unknown_keys(spot, table, [*CHAIN, "setpoint_C"])
    blocks: dict[str, RawTable] = {}
    for kind in CHAIN:
        if kind in table:
            merge_block(check, blocks, kind, table[kind], spot.at(kind))
    if not blocks:
        notes.warn(
            "nothing is believed of the control chain ([nominal] has no block): the room alone can be looked at; "
            "`waxstudy believe` asks for it"
        )
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
