"""Readings of one entity in several files: one after another, or exported twice."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from waxstudy.importing.layouts import without_ending
from waxstudy.importing.limits import TOLD_TWICE
from waxstudy.importing.reading import Readings, refusal

Files = tuple[str, str]  # the one that begins first, and another


class Overlap(NamedTuple):
    """What two files tell of an entity where they overlap in time."""

    is_same: bool  # nearly all stamps are in both, and no reading differs
    varies: bool


def joined(found: Sequence[Readings]) -> list[Readings]:
    """Return readings of one entity in several files as one.

    Files may overlap in time where they tell the same of all that both have. What they tell otherwise is told apart by
    the files' names.
    """
    by_entity: dict[str, list[Readings]] = {}
    for each in found:
        by_entity.setdefault(each.entity, []).append(each)
    parts = [sorted(filter(lambda each: len(each.times), each), key=_begin) for each in by_entity.values()]
    twice = _told_twice(parts)
    return [whole for each in parts for whole in (_in_turn(each, twice) if len(each) > 1 else each)]


def _begin(readings: Readings) -> pd.Timestamp:
    return readings.times.min()


def _overlapping(parts: Sequence[Readings]) -> Iterator[tuple[Files, Readings, Readings]]:
    """Yield readings of one entity, in the order of their begins, that overlap in time."""
    for former, later in combinations(parts, 2):
        if _begin(later) < former.times.max():
            yield (former.where, later.where), former, later


def _told_twice(entities: Iterable[Sequence[Readings]]) -> set[Files]:
    """Return files that tell the same where they overlap; what never varies there tells nothing."""
    found: dict[Files, list[Overlap]] = {}
    for parts in entities:
        for files, former, later in _overlapping(parts):
            found.setdefault(files, []).append(_overlap(former, later))
    return {
        files
        for files, overlaps in found.items()
        if all(each.is_same for each in overlaps) and any(each.varies for each in overlaps)
    }


def _overlap(former: Readings, later: Readings) -> Overlap:
    begin, end = _begin(later), min(former.times.max(), later.times.max())
    one, other = (_between(each, begin, end) for each in (former, later))
    both = one.index.intersection(other.index)
    one_told, other_told = one[both], other[both]
    numbers = [pd.to_numeric(each, errors="coerce") for each in (one_told, other_told)]
    is_equal = (numbers[0] == numbers[1]) | (one_told.astype(str) == other_told.astype(str))
    most = max(len(one), len(other)) - 1  # an export begins with the state at its begin, which no other file has
    is_same = len(both) >= TOLD_TWICE * most and bool(is_equal.all())
    return Overlap(is_same, one_told.nunique() > 1)


def _between(readings: Readings, begin: pd.Timestamp, end: pd.Timestamp) -> pd.Series:
    """Return what is written from one time to another, by stamps; of several at one stamp the last."""
    written = pd.Series(readings.written.to_numpy(dtype=object), readings.times)
    chosen = written[(written.index >= begin) & (written.index <= end)]
    return chosen[~chosen.index.duplicated(keep="last")]


def _in_turn(parts: Sequence[Readings], twice: set[Files]) -> list[Readings]:
    entity, overlaps = parts[0].entity, [files for files, _, _ in _overlapping(parts)]
    if any(files not in twice for files in overlaps):
        return [replace(each, entity=f"{_stem(each.where)}/{entity}") for each in parts]
    if len(names := {each.unit for each in parts}) > 1:
        units = ", ".join(f"'{each.unit}' in {each.where}" for each in parts)
        raise refusal(parts[0].where, f"{entity} has {len(names)} units: {units}", "import what has one unit")
    times = pd.DatetimeIndex(parts[0].times.append([each.times for each in parts[1:]]))
    written = pd.concat([each.written.astype(object) for each in parts])
    order = np.argsort(times, kind="stable")
    times, written = times[order], written.iloc[order]
    once = ~times.duplicated(keep="last")  # a file may begin with the last row of the one before
    said = [f"{later} tells again what {former} tells: read once." for former, later in overlaps]
    notes = tuple(dict.fromkeys([*(note for each in parts for note in each.notes), *said]))
    return [replace(parts[0], times=times[once], written=written[once], notes=notes)]


def _stem(where: str) -> str:
    """Return a file's name without its ending, and its sheet or table."""
    path, _, part = where.partition(", ")
    return without_ending(Path(path)) + (f" ({part})" if part else "")
