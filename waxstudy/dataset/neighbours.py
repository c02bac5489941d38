"""`[neighbours]`: rooms that were measured beside each other, each with its air and, if recorded, its own heat."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from waxstudy.dataset.channels import CHANNELS, GLOBAL
from waxstudy.dataset.checks import AS_LOGGED, SAMPLES, Record, run
from waxstudy.dataset.columns import channels_of
from waxstudy.dataset.grid import on_grid
from waxstudy.dataset.limits import LEAST_SHARED_DAYS
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.tables import Column, DatasetTable, given
from waxstudy.plugin import FloatArray, Parameters
from waxstudy.plugin.registry import nearest
from waxstudy.study.check import Check
from waxstudy.study.spots import RawTable, Spot

AIR, GAIN, SUN, OUTDOOR = "air_temperature_C", "internal_gain_W", "sun", "outdoor_temperature_C"


class RoomTable(Parameters):
    """What `[neighbours.NAME]` says besides its columns."""

    capacity_Wh_K: float | None = given("heat capacity that is assumed of its air side", unit="Wh/K", gt=0.0, le=1e5)


@dataclass(frozen=True)
class Neighbour:
    """What is said of a room."""

    name: str
    columns: Mapping[str, Column]  # of AIR and, where recorded, GAIN
    capacity_Wh_K: float | None


@dataclass(frozen=True)
class NeighbourTable:
    """What `[neighbours]` says; what has a problem is left out."""

    rooms: Sequence[Neighbour] = ()
    sun: Sequence[str] = ()  # columns of irradiance

    @property
    def read(self) -> list[str]:
        """The columns of the file that are read."""
        columns = [each for room in self.rooms for each in room.columns.values()]
        return [*self.sun, *(part.column for each in columns for part in each.parts)]


@dataclass(frozen=True)
class MeasuredRoom:
    """A room on the grid that all rooms share; NaN is missing."""

    name: str
    air_C: FloatArray  # (n,)
    gain_W: FloatArray | None  # (n,)
    capacity_Wh_K: float | None


@dataclass(frozen=True)
class Neighbours:
    """Rooms that were measured beside each other and what drives them, on all days of the file."""

    time: pd.DatetimeIndex  # (n,) ends of intervals, local standard time
    interval_s: float
    rooms: Sequence[MeasuredRoom]
    sun: Mapping[str, FloatArray]  # (n,) by column
    outdoor_C: FloatArray | None = None  # (n,)
    since: pd.Timestamp | None = None  # what ended before is of a baseline, and no finding


def read_neighbours(check: Check, column: Any) -> NeighbourTable:
    """Return [neighbours]; `column` reads an entry as those of [columns] are. Problems are noted."""
    spot = Spot.table("neighbours")
    table = dict(check.table(spot) or {})
    sun = table.pop(SUN, [])
    if not isinstance(sun, list) or not all(isinstance(each, str) for each in sun):
        check.problem(spot.at(SUN), "must be a list of columns in quotes", value=sun)
        sun = []
    rooms = [each for name, entry in table.items() if (each := _room(check, column, name, entry))]
    for each in _twice(rooms):
        check.problem(spot.at(each.name), "its air is the column of another room", value=_told(each))
    return NeighbourTable(rooms, sun)


def _room(check: Check, column: Any, name: str, entry: Any) -> Neighbour | None:
    spot = Spot.table("neighbours").at(name)
    if not isinstance(entry, dict) or "column" in entry or "mean" in entry or "sum" in entry:
        entry = {AIR: entry}
    check.unknown_keys(spot, entry, [AIR, GAIN, *RoomTable.model_fields])
    if AIR not in entry:
        check.problem(spot, f"{AIR} is missing: the column of the room's air")
        return None
    columns = {key: column(check, spot.at(key), entry[key]) for key in (AIR, GAIN) if key in entry}
    rest = {key: entry[key] for key in RoomTable.model_fields if key in entry}
    about = check.parameters(RoomTable, RawTable.of(rest, spot))
    if about is None or not all(columns.values()):
        return None
    return Neighbour(name, columns, about.capacity_Wh_K)


def _twice(rooms: Sequence[Neighbour]) -> Iterator[Neighbour]:
    """Yield rooms whose air is that of a room before them."""
    seen: set[tuple[str, ...]] = set()
    for each in rooms:
        if _columns(each) in seen:
            yield each
        seen.add(_columns(each))


def _columns(room: Neighbour) -> tuple[str, ...]:
    return tuple(sorted(part.column for part in room.columns[AIR].parts))


def _told(room: Neighbour) -> str:
    return ", ".join(_columns(room))


def measured(
    table: pd.DataFrame, times: pd.DatetimeIndex, described: NeighbourTable, about: DatasetTable, notes: Notes
) -> Neighbours | None:
    """Return the rooms on the grid of the record's stamps; note what makes them unusable."""
    usual_s = float(np.median(np.diff(times.as_unit("ns").asi8))) / 1e9
    rows = {each.name: _samples(table, each, usual_s, notes) for each in described.rooms}
    sun = _sun(table, described.sun, usual_s, notes)
    if notes.problems or sun is None:
        return None
    found = []
    for each in described.rooms:
        room = rows[each.name]
        gridded = None if room is None else on_grid(room, times, about, notes)
        if gridded is None:
            return None
        values = gridded[0]
        gain = values[GAIN].to_numpy(dtype=float) if GAIN in values else None
        found.append(MeasuredRoom(each.name, values[AIR].to_numpy(dtype=float), gain, each.capacity_Wh_K))
        index, interval_s = pd.DatetimeIndex(values.index), gridded[1]
    light = {str(name): _gridded(sun[name], times, about, notes) for name in sun}
    return None if notes.problems else Neighbours(index, interval_s, found, light)


def _gridded(sun: pd.Series, times: pd.DatetimeIndex, about: DatasetTable, notes: Notes) -> FloatArray:
    """Return the sun on the grid, as gains are: a mean."""
    found = on_grid(pd.DataFrame({GAIN: sun}), times, about, notes)
    assert found  # the rooms were
    return found[0][GAIN].to_numpy(dtype=float)


def _samples(table: pd.DataFrame, room: Neighbour, usual_s: float, notes: Notes) -> pd.DataFrame | None:
    """Return a room's columns as they were logged, looked at as the channels of the same name are."""
    own = Notes(notes.file, line_of=notes.line_of)
    rows = channels_of(table[_used(table, room)], room.columns, "", own)
    if rows is not None:
        run((*SAMPLES, *AS_LOGGED), Record(rows, usual_s), own)
        known = rows[AIR].dropna()
        if known.empty:
            own.refuse(AIR, "holds no value at all")
        elif known.nunique() == 1:
            own.refuse(AIR, f"is always {known.iloc[0]:g}: a thermometer that stands still tells nothing")
    notes.problems += [replace(each, key=f"[neighbours.{room.name}] {each.key}") for each in own.problems]
    notes.warnings += [f"room {room.name}: {each}" for each in own.warnings]
    return rows


def _used(table: pd.DataFrame, room: Neighbour) -> list[str]:
    """Return the columns of a room that the file has; of one that it lacks all, for the message to list them."""
    wanted = list(dict.fromkeys(part.column for each in room.columns.values() for part in each.parts))
    has_all = all(name in table.columns for name in wanted)
    return wanted if has_all else [str(name) for name in table.columns if name not in CHANNELS or name in wanted]


def _sun(table: pd.DataFrame, names: Sequence[str], usual_s: float, notes: Notes) -> pd.DataFrame | None:
    """Return columns of light, samples looked at as those of a record's are; in which unit they are does not count."""
    found = {}
    for name in names:
        if name not in table.columns:
            notes.refuse("[neighbours] sun", f"there is no column '{name}'", near=nearest(name, table.columns))
            continue
        own = Notes(notes.file, line_of=notes.line_of)
        rows = channels_of(table[[name]], {GLOBAL: Column(column=name)}, "", own)
        if rows is None or rows[GLOBAL].isna().all():
            notes.refuse("[neighbours] sun", f"column '{name}' holds no numbers")
            continue
        run(SAMPLES, Record(rows, usual_s), own)
        notes.warnings += [f"sun {name}: {each}" for each in own.warnings]
        found[name] = rows[GLOBAL]
    return pd.DataFrame(found, index=table.index)


def beside_record(
    neighbours: Neighbours, described: NeighbourTable, columns: Mapping[str, Column], values: pd.DataFrame, name: str
) -> Neighbours:
    """Return the rooms with the outdoor air of a record on their grid, and with its own room, if it has one.

    It has none where a column of its air is also a neighbour's.
    """
    outdoor_C = values[OUTDOOR].to_numpy(dtype=float) if OUTDOOR in values else None
    neighbours = replace(neighbours, outdoor_C=outdoor_C)
    if AIR not in values:
        return neighbours
    own = {part.column for part in (columns[AIR].parts if AIR in columns else Column(column=AIR).parts)}
    if any(own & set(_columns(each)) for each in described.rooms):
        return neighbours
    gain = values[GAIN].to_numpy(dtype=float) if GAIN in values else None
    room = MeasuredRoom(name, values[AIR].to_numpy(dtype=float), gain, None)
    return replace(neighbours, rooms=[room, *neighbours.rooms])


def too_little(house: Neighbours) -> Iterator[str]:
    """Yield why rooms cannot be each other's control: each needs days on which all that it is held against is known."""
    for room in house.rooms:
        others = [np.isfinite(each.air_C) for each in house.rooms if each is not room]
        drives = {"outdoors": house.outdoor_C, "its own heat": room.gain_W, **house.sun}
        recorded = {name: values for name, values in drives.items() if values is not None}
        known = np.any(others, axis=0) & np.isfinite([room.air_C, *recorded.values()]).all(axis=0)
        days = float(known.sum()) * house.interval_s / 86_400.0
        if days < LEAST_SHARED_DAYS:
            against = ", ".join(("another room", *recorded))
            least = f"at least {LEAST_SHARED_DAYS:g} are needed"
            yield f"{room.name} has {days:.1f} days in common with what it is held against ({against}): {least}"
