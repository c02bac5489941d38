"""Reading a dataset: description, data, grid, checks; all problems at once (format: docs/datasets.md)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd

from waxstudy.dataset.checks import AS_LOGGED, DEAD, ON_GRID, SAMPLES, Record, run
from waxstudy.dataset.columns import channels_of, without_empty
from waxstudy.dataset.description import FILES, Description, read_description
from waxstudy.dataset.grid import on_grid
from waxstudy.dataset.levels import as_levels
from waxstudy.dataset.neighbours import Neighbours, beside_record, measured, too_little
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.room import built, look_at_model_errors, look_at_roles
from waxstudy.dataset.stamps import stamps_of
from waxstudy.dataset.stand_ins import why_dark
from waxstudy.dataset.tables import Site
from waxstudy.dataset.text import read_table
from waxstudy.dataset.zones import is_zone
from waxstudy.plugin import Belief, Inputs
from waxstudy.plugin.files import lacking
from waxstudy.plugin.registry import Registry, installed
from waxstudy.results.checksums import sha256
from waxstudy.study.check import Check
from waxstudy.study.model import Choice
from waxstudy.study.problems import StudyError
from waxstudy.study.source import read_source
from waxstudy.study.spots import Spot


@dataclass(frozen=True, repr=False)
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
    room_tolerance: float  # factor on the priors of what is uncertain of the room
    noise: Mapping[str, float]  # standard deviation by channel
    site: Site | None  # where the room is
    warnings: tuple[str, ...]  # what the user must know
    assumptions: tuple[str, ...]  # what was assumed, one sentence each
    room_error_factor: float = 1.0  # on the error that the room states of its model
    spreads: Mapping[str, float] = field(default_factory=dict)  # stated of inputs, logarithms of a factor
    baseline: Path | None = None  # folder of a record of the same loop when it was healthy
    neighbours: Neighbours | None = None  # rooms that were measured beside each other
    origin: str = ""  # where the record comes from, in words
    sha256: Mapping[str, str] = field(default_factory=dict)  # of its files, by name

    def __repr__(self) -> str:
        days = len(self.time) * self.interval_s / 86_400.0
        believed = [choice.component.name for choice in (*self.nominal.values(), self.room) if choice]
        return (
            f"<waxstudy.Dataset '{self.name}': {days:.3g} days to {self.time[-1]}, every {self.interval_s:g} s\n"
            f"  channels: {', '.join(map(str, self.values))}\n"
            f"  believed: {', '.join(believed) or 'nothing'}\n"
            f"  folder:   {self.folder if self.folder.is_dir() else 'none, it was made of a frame'}>"
        )

    @property
    def days(self) -> pd.DatetimeIndex:
        """The days that it tells of: a first sample at midnight ends a day of which little else is there."""
        begins = (self.time - pd.Timedelta(seconds=self.interval_s)).normalize()
        days = pd.DatetimeIndex(begins.unique())
        is_lone = np.count_nonzero(begins == days[0]) == 1 and self.interval_s < 43_200.0
        return days[1:] if is_lone and len(days) > 1 else days

    def believed(self, inputs: Inputs | None) -> Belief:
        """Return what the modeller believes, with what drove the room."""
        return Belief(self.nominal, self.room, inputs, self.room_error_factor)


def read_dataset(folder: Path, registry: Registry | None = None) -> Dataset:
    """Return the checked dataset of a folder; raise `StudyError` with every problem of its files.

    The components that [nominal], [room] and [building] may name are those of `registry`, by default all installed.
    Whether the baseline that it names is there is looked at when it is read.
    """
    check = Check(read_source(folder / "dataset.toml"), registry or installed())
    path = _data_path(check, folder)
    notes = Notes(str(path))
    described = read_description(check, notes)
    room = built(check, described.room)
    if described.room:
        look_at_model_errors(check, described.room, described.about.room_error_factor, notes)
    is_clear = not any(problem.where in ("[dataset]", "[columns]", "[neighbours]") for problem in check.problems)
    full_L_h = room.full_flow_L_h if room else None
    record = _record(path, described, full_L_h, notes) if path and is_clear else None
    if room and record:
        look_at_roles(check, room, record[0], notes)
        if wrong := why_dark(record[0].columns, described.site):
            notes.warn(wrong)
    problems = [*check.problems, *notes.problems]
    if problems or record is None:
        raise StudyError(problems)
    values, interval_s, neighbours, zone = record
    return Dataset(
        name=described.about.name or folder.resolve().name,
        folder=folder,
        interval_s=interval_s,
        time=pd.DatetimeIndex(values.index),
        values=values,
        assumed=tuple(name for name in described.about.inputs if name in values),
        nominal=described.nominal,
        setpoint_C=described.setpoint_C,
        room=described.room,
        room_tolerance=described.about.room_tolerance,
        noise=described.noise,
        site=_with_zone(described.site, zone),
        spreads=described.about.spreads,
        warnings=tuple(dict.fromkeys(notes.warnings)),
        assumptions=tuple(dict.fromkeys(notes.assumptions)),
        room_error_factor=described.about.room_error_factor,
        baseline=folder / described.baseline if described.baseline else None,
        neighbours=neighbours,
        origin=described.about.origin or "",
        sha256={each.name: sha256(each) for each in (folder / "dataset.toml", path) if each},
    )


def _data_path(check: Check, folder: Path) -> Path | None:
    spot = Spot.table("dataset").at("file")
    table = check.source.values.get("dataset")
    name = table.get("file") if isinstance(table, dict) else None
    if isinstance(name, str):
        path = folder / name
        if not (wrong := lacking(path)):
            return path
        check.problem(spot, wrong, value=name, allowed=f"looked for {path}")
        return None
    found = [folder / name for name in FILES if (folder / name).exists()]
    if not found:
        check.problem(Spot.table(), f"there is no {' or '.join(FILES)} beside it, and [dataset] names no file")
    return found[0] if found else None


def _record(
    path: Path, described: Description, full_L_h: float | None, notes: Notes
) -> tuple[pd.DataFrame, float, Neighbours | None, str | None] | None:
    """Return the channels on the grid, looked at, its interval [s], the rooms, and the zone of its clock.

    Note what is wrong with them.
    """
    table = read_table(path, described.about, notes)
    if table is None:
        return None
    zone = described.site.timezone if described.site else None
    stamps = stamps_of(table, described.time, described.about, notes, zone)
    channels = channels_of(table, described.columns, described.time, notes, described.neighbours.read)
    if stamps is None or channels is None:
        return None
    times, zone = stamps
    logged = (table if described.neighbours.rooms else table.iloc[:0], times)
    del table  # a long record is several times in memory here, if what is done with stays
    usual_s = float(np.median(np.diff(times.as_unit("ns").asi8))) / 1e9
    run(SAMPLES, Record(channels, usual_s), notes)
    channels = without_empty(channels, notes)
    run(AS_LOGGED, Record(channels, usual_s, full_flow_L_h=full_L_h), notes)
    record = None if notes.problems else on_grid(channels, times, described.about, notes)
    if record is None:
        return None
    del channels
    interval_s = record[1]
    run(DEAD, Record(record[0], interval_s), notes)
    values = without_empty(record[0], notes)  # on the grid a nearer row may have taken a place
    del record
    run(ON_GRID, Record(values, interval_s, has_modulator="modulator" in described.nominal), notes)
    values = _held(without_empty(as_levels(values, described.nominal, notes), notes))
    return values, interval_s, _neighbours(logged, described, values, notes), zone


def _held(values: pd.DataFrame) -> pd.DataFrame:
    """Return channels in which a blank setpoint holds the last one: loggers write it down when it changes."""
    return values.assign(setpoint_C=values["setpoint_C"].ffill()) if "setpoint_C" in values else values


def _with_zone(site: Site | None, zone: str | None) -> Site | None:
    """Return where a room is, with the zone that stamps tell where none is stated."""
    return site.model_copy(update={"timezone": zone}) if site and zone and is_zone(zone) else site


def _neighbours(
    logged: tuple[pd.DataFrame, pd.DatetimeIndex], described: Description, values: pd.DataFrame, notes: Notes
) -> Neighbours | None:
    """Return the rooms beside each other, None without any; note what is wrong with them."""
    if not described.neighbours.rooms:
        return None
    found = measured(*logged, described.neighbours, described.about, notes)
    if found is None:
        return None
    name = described.about.name or "this room"
    rooms = beside_record(found, described.neighbours, described.columns, values, name)
    if len(rooms.rooms) < 2:
        notes.refuse("[neighbours]", "one room alone has no control: name another, or the room's own air in [columns]")
        return rooms
    for wrong in too_little(rooms):
        notes.refuse("[neighbours]", wrong)
    return rooms
