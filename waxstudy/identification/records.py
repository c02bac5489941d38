"""A record of displacement: read, put on a regular grid, normalised by its stroke."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from waxstudy.dataset.notes import Notes
from waxstudy.dataset.text import read_table
from waxstudy.identification.columns import find, seconds_of, values_of, without_units
from waxstudy.identification.description import Described
from waxstudy.identification.stroke import normalised, switched, without_outliers
from waxstudy.plugin import FloatArray
from waxstudy.study.problems import Problem, StudyError

LONGEST_INTERVAL_S = 10.5  # beyond, a ramp has too few samples
GAP_S = 15.0  # from the third missing sample on, or this
GAP_SAMPLES = 3.0
MOST_EMPTY = 10.0  # samples of the grid per row

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True)
class Record:
    """A record of one motor on a regular grid."""

    name: str
    file: str
    sha256: str
    product: str
    exemplar: str
    has_valve: bool
    profile: str
    is_simulated: bool
    interval_s: float
    on: BoolArray  # (n,) heating signal
    opening: FloatArray  # (n,) 0 closed, 1 open; filled in where missing
    missing: BoolArray  # (n,) within a gap
    stroke: float  # in the unit of the file
    unit: str
    warnings: tuple[str, ...]

    @property
    def time_s(self) -> FloatArray:
        return np.asarray(self.interval_s * np.arange(len(self.on)), dtype=float)

    @property
    def duration_min(self) -> float:
        return self.interval_s * len(self.on) / 60.0


@dataclass(frozen=True)
class Samples:
    """What a file holds, on a regular grid."""

    interval_s: float
    signal: FloatArray
    values: FloatArray
    missing: BoolArray
    unit: str


def read_records(known: Sequence[Described], product: str) -> list[Record]:
    """Return every record; raise `StudyError` with the problems of all. A product that nobody told is `product`."""
    problems: list[Problem] = []
    records: list[Record] = []
    for each in known:
        notes = Notes(str(each.path))
        record = _read(each, product, notes)
        problems += notes.problems
        if record is not None and not notes.problems:
            records.append(replace(record, warnings=tuple(dict.fromkeys(notes.warnings))))
    if problems:
        raise StudyError(problems)
    return _without_copies(records)


def _without_copies(records: Sequence[Record]) -> list[Record]:
    """Return records whose bytes differ: a copy is no second witness."""
    kept: dict[str, Record] = {}
    for record in records:
        first = kept.setdefault(record.sha256, record)
        if first is not record:
            copy = f"{record.file} is a copy of this file: passed over"
            kept[record.sha256] = replace(first, warnings=(*first.warnings, copy))
    return list(kept.values())


def _read(known: Described, product: str, notes: Notes) -> Record | None:
    samples = read_samples(known, "displacement", notes)
    return None if samples is None else record_of(samples, known, product, notes, file_hash(known.path))


def record_of(samples: Samples, known: Described, product: str, notes: Notes, sha256: str = "") -> Record | None:
    """Return the normalised record; note why it cannot be used."""
    on = switched(samples.signal, samples.values, "displacement", notes)
    if on is None:
        return None
    stroke = normalised(samples.values, on, samples.interval_s, notes)
    if stroke is None:
        return None
    return Record(
        name=known.name,
        file=known.path.name,
        sha256=sha256,
        product=known.product or product,
        exemplar=known.exemplar or known.name,
        has_valve=known.has_valve,
        profile=known.profile,
        is_simulated=known.is_simulated,
        interval_s=samples.interval_s,
        on=on,
        opening=stroke.opening,
        missing=samples.missing,
        stroke=stroke.length,
        unit=samples.unit,
        warnings=(),
    )


def read_samples(known: Described, wanted: str, notes: Notes) -> Samples | None:
    """Return signal and what is wanted of a file on a regular grid; note why they cannot be had."""
    table = read_table(known.path, known.about, notes)
    if table is None or (table := without_units(table, notes)).empty:
        if table is not None:
            notes.refuse("", "holds no rows")
        return None
    found = {name: find(table, name, known.columns, notes) for name in ("time", "signal", wanted)}
    time, signal, value = found.values()
    if time is None or signal is None or value is None:
        return None
    time_s = seconds_of(table, time, known.about, notes)
    signals, values = (values_of(table, name, named, notes) for name, named in (("signal", signal), (wanted, value)))
    if time_s is None or signals is None or values is None:
        return None
    signals = without_outliers(signals, notes)
    return samples_of(time_s, signals, values, value.unit, notes)


def samples_of(time_s: FloatArray, signal: FloatArray, values: FloatArray, unit: str, notes: Notes) -> Samples | None:
    """Return signal and values on a regular grid, and where they are made up; the signal is held."""
    steps = np.diff(time_s)
    interval_s = float(np.median(steps))
    if interval_s > LONGEST_INTERVAL_S:
        notes.refuse("time", f"samples are {interval_s:g} s apart: at most 10 s tell rise and fall from the rest")
        return None
    if np.ptp(steps) <= 0.01 * interval_s:
        grid_s, nearest = time_s, np.arange(len(time_s))
    else:
        count = round((time_s[-1] - time_s[0]) / interval_s) + 1
        if count > MOST_EMPTY * len(time_s):
            row = int(np.argmax(steps))
            notes.refuse("time", f"a gap of {steps[row] / 3600.0:.3g} h: split the record there", line=row + 3)
            return None
        grid_s = time_s[0] + interval_s * np.arange(count)
        nearest = np.clip(np.searchsorted(time_s, grid_s + 0.5 * interval_s, side="right") - 1, 0, len(time_s) - 1)
    known = np.isfinite(values) & np.isfinite(signal)
    if not known.any():
        notes.refuse("", "no row holds both signal and value")
        return None
    filled = np.interp(grid_s, time_s[known], values[known])
    held = signal[known][np.clip(np.searchsorted(np.flatnonzero(known), nearest, side="right") - 1, 0, None)]
    missing = _far(grid_s, time_s[known], interval_s)
    if missing.any():
        share = 100.0 * float(missing.mean())
        notes.warn(f"{share:.2g} % of the time is in gaps; cycles that touch one are left out")
    return Samples(interval_s, held, filled, missing, unit)


def _far(grid_s: FloatArray, known_s: FloatArray, interval_s: float) -> BoolArray:
    """Return where the grid lies in a gap between two samples, before the first one or after the last."""
    outside_s = grid_s[0] - interval_s, grid_s[-1] + interval_s  # where the record would go on
    samples_s = np.concatenate((outside_s[:1], known_s, outside_s[1:]))
    after = np.searchsorted(samples_s, grid_s, side="left").clip(1, len(samples_s) - 1)
    wide = np.diff(samples_s)[after - 1] > max(GAP_S, GAP_SAMPLES * interval_s)
    return np.asarray(wide & (grid_s != samples_s[after]) & (grid_s != samples_s[after - 1]))


def file_hash(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
