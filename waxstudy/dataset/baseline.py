"""The baseline of a dataset: a record of the same loop when it was healthy."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

from waxstudy.dataset.interval import is_longer, told
from waxstudy.dataset.limits import LEAST_DAYS, LEAST_SAMPLES, LONGEST_INTERVAL_S
from waxstudy.dataset.read import Dataset, read_dataset
from waxstudy.plugin.files import lacking
from waxstudy.plugin.registry import Registry, installed
from waxstudy.study.check import Check
from waxstudy.study.problems import Problem, StudyError
from waxstudy.study.sentences import value_at
from waxstudy.study.source import read_source
from waxstudy.study.spots import Spot

BASELINE = Spot.table("baseline")
ITSELF = "a record cannot be its own baseline"


def read_baseline(dataset: Dataset, folder: Path, registry: Registry | None = None) -> Dataset:
    """Return the baseline in a folder; raise `StudyError` where it cannot be one of this dataset.

    That is the dataset itself, and one of another loop, that overlaps with it in time, is shorter than three days or
    was sampled too seldom.
    """
    if folder.resolve() == dataset.folder.resolve():
        raise StudyError([_of(folder, ITSELF)])
    return checked(dataset, read_dataset(folder, registry))


def checked(dataset: Dataset, baseline: Dataset) -> Dataset:
    """Return a baseline that was read before; raise `StudyError` where it cannot be one of this dataset."""
    about = dataset, baseline
    problems = [*_differences(*about), *_overlap(*about), *_too_short(baseline), *_too_seldom(*about)]
    if problems:
        raise StudyError([_of(baseline.folder, wrong) for wrong in problems])
    return baseline


def named_baseline(dataset: Dataset, registry: Registry | None = None) -> Dataset | None:
    """Return the baseline that dataset.toml names, None where it names none; raise `StudyError` as `read_baseline`."""
    if dataset.baseline is None:
        return None
    is_lacking = bool(lacking(dataset.baseline / "dataset.toml"))
    if dataset.folder.is_dir() and (is_lacking or dataset.baseline.resolve() == dataset.folder.resolve()):
        check, spot = Check(read_source(dataset.folder / "dataset.toml"), registry or installed()), BASELINE.at("path")
        wrong, allowed = ("no such dataset", f"looked for {dataset.baseline}") if is_lacking else (ITSELF, "")
        check.problem(spot, wrong, value=value_at(check.source.values, spot.path), allowed=allowed)
        raise StudyError(check.problems)
    return read_baseline(dataset, dataset.baseline, registry)


def _of(folder: Path, wrong: str) -> Problem:
    return Problem(str(folder / "dataset.toml"), 0, BASELINE.where, "", "", wrong)


def parted(dataset: Dataset, first: pd.Timestamp, last: pd.Timestamp) -> tuple[Dataset, Dataset]:
    """Return the days from `first` to `last`, both included, as a baseline, and the days after them as the record.

    Raises `StudyError` where these days are not in the record, or less than three days are left on either side.
    """
    begins = dataset.time - pd.Timedelta(seconds=dataset.interval_s)
    day, days = begins.normalize(), dataset.days
    chosen, after = (day >= first) & (day <= last), day > last
    there = f"the record has {days[0].date()}..{days[-1].date()}"
    if first > last:
        raise _wrong(dataset, f"{first.date()}..{last.date()}: the days go backwards ({there})")
    if first < days[0] or last > days[-1]:
        lies = "lies outside" if last < days[0] or first > days[-1] else "reaches beyond"
        raise _wrong(dataset, f"{first.date()}..{last.date()} {lies} the record ({there})")
    if problem := next(_too_short(_rows(dataset, chosen)), ""):
        raise _wrong(dataset, problem)
    if np.count_nonzero(after) * dataset.interval_s < LEAST_DAYS * 86_400.0:
        raise _wrong(dataset, f"less than {LEAST_DAYS:g} days come after {last.date()}, and nothing is left to judge")
    judged = _rows(dataset, after)
    if judged.neighbours:
        judged = replace(judged, neighbours=replace(judged.neighbours, since=last + pd.Timedelta(1, "D")))
    return _rows(dataset, chosen), judged


def _rows(dataset: Dataset, chosen: np.ndarray) -> Dataset:
    return replace(dataset, time=dataset.time[chosen], values=dataset.values[chosen], baseline=None)


def _wrong(dataset: Dataset, wrong: str) -> StudyError:
    return StudyError([Problem(str(dataset.folder / "dataset.toml"), 0, "", "--baseline-days", "", wrong)])


def _differences(dataset: Dataset, baseline: Dataset) -> Iterator[str]:
    """Yield what is believed otherwise of the two: then they are not of one loop."""
    for kind in sorted({*dataset.nominal, *baseline.nominal}):
        pair = [each.nominal[kind].described() if kind in each.nominal else {} for each in (dataset, baseline)]
        yield from (f"another loop: {kind} {told}" for told in _told(*pair))
    rooms = [each.room.described() if each.room else {} for each in (dataset, baseline)]
    yield from (f"another loop: room {told}" for told in _told(*rooms))


def _told(one: dict[str, object], other: dict[str, object]) -> Iterator[str]:
    """Yield the first key in which two descriptions differ, with that of the table in it that does."""
    for key in (*one, *(key for key in other if key not in one)):
        here, there = one.get(key), other.get(key)
        if here != there:
            if isinstance(here, dict) and isinstance(there, dict):
                yield from (f"{key} {told}" for told in _told(here, there))
            else:
                yield f"{key} is {_short(there)} in the baseline and {_short(here)} in the record"
            return


def _short(value: object) -> str:
    text = "not there" if value is None else str(value)
    return text if len(text) <= 40 else "otherwise"


def _overlap(dataset: Dataset, baseline: Dataset) -> Iterator[str]:
    if baseline.time[0] <= dataset.time[-1] and dataset.time[0] <= baseline.time[-1]:
        first, last = max(baseline.time[0], dataset.time[0]), min(baseline.time[-1], dataset.time[-1])
        yield f"it overlaps with the record, from {first} to {last}: a baseline is from another time"


def _too_seldom(dataset: Dataset, baseline: Dataset) -> Iterator[str]:
    """Yield why the two cannot be read at the longer of their intervals."""
    if is_longer(baseline, dataset) and baseline.interval_s > LONGEST_INTERVAL_S:
        every = told(baseline.interval_s)
        least = told(LONGEST_INTERVAL_S)
        yield f"a sample every {every} is too seldom for a baseline: one every {least} is needed at least"
    elif is_longer(baseline, dataset):
        yield from _too_few("baseline", baseline, "record", dataset)
    elif is_longer(dataset, baseline):
        yield from _too_few("record", dataset, "baseline", baseline)


def _too_few(coarse_name: str, coarse: Dataset, fine_name: str, fine: Dataset) -> Iterator[str]:
    """Yield that a dataset is too short to be read at the other one's interval, if it is."""
    hours, least = len(fine.time) * fine.interval_s / 3600.0, LEAST_SAMPLES * coarse.interval_s / 3600.0
    if hours < least:
        every = f"the {coarse_name} has a sample every {told(coarse.interval_s)}"
        yield f"{every}, and the {fine_name} is {hours:.3g} h long: {least:.3g} h are needed to compare them"


def refuse_too_short(dataset: Dataset) -> None:
    """Raise `StudyError` where a record is too short to say how a loop is when healthy."""
    if problem := next(_too_short(dataset), ""):
        raise StudyError([Problem(str(dataset.folder / "dataset.toml"), 0, "", "", "", problem)])


def _too_short(baseline: Dataset) -> Iterator[str]:
    days = len(baseline.time) * baseline.interval_s / 86_400.0
    if days < LEAST_DAYS:
        yield f"a baseline of {days:.1f} days is too short: at least {LEAST_DAYS:g} days are needed"
