"""Readings of one entity in several files: one after another, or exported twice."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from waxstudy.importing.layouts import DATED, without_ending
from waxstudy.importing.limits import TOLD_TWICE
from waxstudy.importing.reading import Readings, refusal

Files = frozenset[str]


class Overlap(NamedTuple):
    """Readings of one entity in two files, which overlap in time."""

    former: Readings
    later: Readings

    @property
    def files(self) -> Files:
        return frozenset((self.former.where, self.later.where))


class Told(NamedTuple):
    """What two files tell of an entity where they overlap."""

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
    entities = [sorted(filter(lambda each: len(each.times), each), key=_begin) for each in by_entity.values()]
    twice = _told_twice(entities)
    return [whole for parts in entities for whole in (_in_turn(parts, twice) if len(parts) > 1 else parts)]


def _begin(readings: Readings) -> pd.Timestamp:
    return readings.times.min()


def _overlaps(parts: Sequence[Readings]) -> Iterator[Overlap]:
    """Yield what overlaps in time among readings of one entity, which are in the order of their begins."""
    for place, former in enumerate(parts):
        end = former.times.max()
        for later in parts[place + 1 :]:
            if _begin(later) >= end:
                break
            yield Overlap(former, later)


def _told_twice(entities: Iterable[Sequence[Readings]]) -> set[Files]:
    """Return files that tell the same where they overlap.

    What never varies there tells nothing, unless the files have one name but for their days.
    """
    same: dict[Files, bool] = {}
    differ: set[Files] = set()
    for overlap in (each for parts in entities for each in _overlaps(parts)):
        if overlap.files not in differ:
            told = _told(overlap)
            are_of_one = len({_without_days(each) for each in overlap.files}) == 1
            same[overlap.files] = same.get(overlap.files, False) or told.varies or are_of_one
            differ |= set() if told.is_same else {overlap.files}
    return {files for files, is_same in same.items() if is_same and files not in differ}


def _told(overlap: Overlap) -> Told:
    """Return what is told where two files overlap; the last reading of the former may be a mean that was not over."""
    begin, end = _begin(overlap.later), overlap.former.times.max()
    one, other = (_between(each, begin, end) for each in overlap)
    both = one.index.intersection(other.index)
    most = max(len(one), len(other)) - 1  # an export begins with the state at its begin, which no other file has
    one, other = one[both], other[both]
    unlike = pd.to_numeric(one, errors="coerce") != pd.to_numeric(other, errors="coerce")
    is_same = len(both) >= TOLD_TWICE * most and bool((one[unlike].astype(str) == other[unlike].astype(str)).all())
    return Told(is_same, len(one) > 1 and bool((one.astype(str) != str(one.iloc[0])).any()))


def _between(readings: Readings, begin: pd.Timestamp, end: pd.Timestamp) -> pd.Series:
    """Return what is written from one time until before another, by stamps; of several at one stamp the last."""
    written = pd.Series(readings.written.to_numpy(dtype=object), readings.times).dropna()
    chosen = written[(written.index >= begin) & (written.index < end)]
    return chosen[~chosen.index.duplicated(keep="last")]


def _in_turn(parts: list[Readings], twice: set[Files]) -> list[Readings]:
    entity, overlaps = parts[0].entity, list(_overlaps(parts))
    if any(each.files not in twice for each in overlaps):
        return [replace(each, entity=f"{_stem(each.where)}/{entity}") for each in parts]
    if len(names := {each.unit for each in parts}) > 1:
        units = ", ".join(f"'{each.unit}' in {each.where}" for each in parts)
        raise refusal(parts[0].where, f"{entity} has {len(names)} units: {units}", "import what has one unit")
    times = pd.DatetimeIndex(parts[0].times.append([each.times for each in parts[1:]]))
    written = pd.concat([each.written.astype(object) for each in parts])
    order = np.argsort(times, kind="stable")
    times, written = times[order], written.iloc[order]
    once = ~times.duplicated(keep="last")  # a file may begin with the last row of the one before
    notes = tuple(dict.fromkeys([*(note for each in parts for note in each.notes), *_said(overlaps)]))
    return [replace(parts[0], times=times[once], written=written[once], notes=notes)]


def _said(overlaps: Sequence[Overlap]) -> Iterator[str]:
    if overlaps:
        first = overlaps[0]
        others = f", as do {len(overlaps) - 1} other pairs of files" if len(overlaps) > 1 else ""
        yield f"{first.later.where} tells again what {first.former.where} tells{others}: read once."


def _without_days(where: str) -> tuple[Path, str]:
    """Return the folder and name of a source without the days that it is of."""
    path, _, part = where.partition(", ")
    return Path(path).parent, DATED.sub("", without_ending(Path(path))) + part


def _stem(where: str) -> str:
    """Return a file's name without its ending, and its sheet or table."""
    path, _, part = where.partition(", ")
    return without_ending(Path(path)) + (f" ({part})" if part else "")
