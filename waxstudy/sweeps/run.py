"""Run a sweep: each finished point is kept at once, and a sweep that was interrupted goes on from there.

The folder is read by `waxstudy.sweeps.result`; `points/KEY.parquet` holds the key figures of one point, and its key is
a digest of all that they depend on.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pandas as pd

from waxstudy.plugin import Component, SimulationError
from waxstudy.plugin.files import check_file
from waxstudy.results.atomic import sole_use, whole_file
from waxstudy.results.folder import RunError, holds_run
from waxstudy.results.kpis import units_of
from waxstudy.results.parquet import write_parquet
from waxstudy.simulation.run import Progress
from waxstudy.study.model import Study
from waxstudy.sweeps.axes import NAME, Sweep
from waxstudy.sweeps.executors import executor
from waxstudy.sweeps.kinds import Kind
from waxstudy.sweeps.place import places
from waxstudy.sweeps.point import computed, engines_of, key_of
from waxstudy.sweeps.result import FORMAT, MANIFEST, POINTS, TABLE

Stated = TypeVar("Stated")  # what a point is computed from
Work = Callable[[Stated, np.ndarray], pd.DataFrame]  # given the executor's stop too


@dataclass
class Where:
    """Where points are computed."""

    kind: Kind = "threads"
    workers: int = field(default_factory=lambda: os.cpu_count() or 1)
    scheduler: str | None = None


def run(
    studies: Sequence[Study], sweep: Sweep, folder: Path, where: Where, told: Progress, jit: bool = True
) -> dict[int, str]:
    """Compute the points that the folder does not hold and write its table; return why which points failed.

    Raises `RunError` for a folder that holds something else or is in use, `BackendMissing`, `OSError`, and
    `KeyboardInterrupt`; what was finished before that is kept.
    """
    with points_folder(folder, POINTS, "sweep"):
        digests: dict[type[Component], str] = {}
        engines = engines_of(studies, jit)
        keys = [key_of(study, digests, engine) for study, engine in zip(studies, engines, strict=True)]
        told.total(len(keys))
        files = [folder / POINTS / f"{key}.parquet" for key in keys]
        # points that are alike are computed once
        first = {key: number for number, key in reversed(list(enumerate(keys))) if not is_whole(files[number])}
        for _ in range(len(keys) - len(first)):
            told.done(None, True)
        todo = {number: studies[number].described() for number in sorted(first.values())}
        failed = compute_points(todo, files, where, told, partial(computed, jit=jit))
        reasons = {number: failed[first[key]] for number, key in enumerate(keys) if first.get(key, -1) in failed}
        _finish(folder, studies[0], sweep, files, reasons)
    return reasons


@contextmanager
def points_folder(folder: Path, points: str, what: str) -> Iterator[None]:
    """Make a folder for points that are kept in one of this name in it, and hold it; raise `RunError`, `OSError`."""
    if folder.is_dir() and any(folder.iterdir()) and not (folder / points).is_dir():
        held = "a run" if holds_run(folder) else f"no {what}"
        raise RunError(f"{folder}: this folder is in use and holds {held}; choose another with --out")
    (folder / points).mkdir(parents=True, exist_ok=True)
    with sole_use(folder) as is_ours:
        if not is_ours:
            raise RunError(f"{folder}: another {what} is at work in this folder")
        yield


def is_whole(file: Path) -> bool:
    """Whether a point has been kept, and can be read."""
    try:
        check_file(file)
        return len(pd.read_parquet(file)) > 0
    except (OSError, ValueError):
        return False


def compute_points(
    todo: dict[int, Stated],
    files: Sequence[Path],
    where: Where,
    told: Progress,
    work: Work[Stated],
    units: Mapping[str, str] | None = None,
) -> dict[int, str]:
    """Compute points until all have ended, and keep each in its file; return why which failed.

    Those that a dying process had are computed again, one by one. `units` are of columns that are no key figures.
    """
    failed: dict[int, str] = {}

    def ended(number: int, outcome: Future[pd.DataFrame]) -> None:
        try:
            figures = outcome.result()
            with whole_file(files[number]) as path:
                write_parquet(figures, path, {**units_of(map(str, figures)), **(units or {})})
        except SimulationError as error:
            failed[number] = str(error)
            told.warn(f"point {number}: {error}; it is left out")
        del todo[number]
        told.done(None, True)

    while todo:
        lost = _attempt(todo, where, work, ended)
        for number in lost:
            told.warn(f"point {number}: the process that computed it ended; it is computed again alone")
            if _attempt({number: todo[number]}, Where(where.kind, 1, where.scheduler), work, ended):
                failed[number] = "the process that computes it ends before it is done, alone too"
                told.warn(f"point {number}: {failed[number]}; it is left out")
                del todo[number]
                told.done(None, True)
    return failed


def _attempt(
    todo: Mapping[int, Stated],
    where: Where,
    work: Work[Stated],
    ended: Callable[[int, Future[pd.DataFrame]], None],
) -> list[int]:
    """Compute what is to be done; return which points were under way when a process died, as far as one did."""
    running: dict[Future[pd.DataFrame], int] = {}
    rest = iter(list(todo.items()))
    with executor(where.kind, where.workers, where.scheduler) as (pool, stop):
        while True:
            # few at a time: a sweep that is stopped has little to take back
            try:
                for number, stated in islice(rest, 2 * where.workers - len(running)):
                    running[pool.submit(work, stated, stop)] = number
            except BrokenProcessPool:  # a process died while nobody waited for it
                return sorted(running.values())
            if not running:
                return []
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                try:
                    ended(running[future], future)
                except BrokenProcessPool:
                    return sorted(running.values())
                del running[future]


def _finish(folder: Path, study: Study, sweep: Sweep, files: Sequence[Path], failed: dict[int, str]) -> None:
    places_of = places(study)
    table = tidy(sweep, files, failed)
    units = {"point": "1", NAME: "1", **{key: places_of[key].unit for key in sweep.keys}, **units_of(map(str, table))}
    with whole_file(folder / TABLE) as path:
        write_parquet(table, path, units)
    said = {
        "format": FORMAT,
        "study": study.name,
        "method": sweep.method,
        "keys": list(sweep.keys),
        "ranges": {key: [axis.low, axis.high] for key, axis in (sweep.ranges or {}).items()},
        "points": len(files),
        "failed": {str(number): reason for number, reason in failed.items()},
    }
    with whole_file(folder / MANIFEST) as path:
        path.write_text(json.dumps(said, indent=1) + "\n")


def tidy(sweep: Sweep, files: Sequence[Path], failed: dict[int, str]) -> pd.DataFrame:
    """Return a row for each point, case, week and member; parameters first, each in a column of its key."""
    frames = []
    for number, values in enumerate(sweep.points):
        if number in failed:
            continue
        stated: dict[str, Any] = {"point": number}
        if sweep.names:
            stated[NAME] = sweep.names[number]
        figures = pd.read_parquet(files[number])
        stated |= dict(zip(sweep.keys, values, strict=True))
        frames.append(pd.concat([pd.DataFrame([stated] * len(figures)), figures], axis=1))
    return pd.concat(frames, ignore_index=True) if frames else pd.DataFrame({"point": []})
