"""Run a study at many values of its parameters."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from waxstudy.plugin.registry import installed
from waxstudy.simulation.run import Progress
from waxstudy.study.read import study_of
from waxstudy.study.source import read_source, source_of
from waxstudy.sweeps.axes import NAME, Sweep, read_sweep
from waxstudy.sweeps.kinds import Kind
from waxstudy.sweeps.place import studies
from waxstudy.sweeps.result import Swept, read_swept
from waxstudy.sweeps.run import Where, run


def sweep(
    study: str | Path | Mapping[str, Any],
    points: str | Path | pd.DataFrame,
    out: str | Path,
    *,
    executor: Kind = "threads",
    workers: int | None = None,
    scheduler: str | None = None,
    jit: bool = True,
    progress: Progress | None = None,
) -> Swept:
    """Run a study at every point, and return what came out; what the folder `out` holds is not computed again.

    `points` is a sweep file, or a frame with a row for each point and a column for each parameter, such as
    `room.window_U_W_m2K`. A point that fails is told in `failed` and left out of `frame`. Raises `StudyError` for
    what is wrong with study or points, `BackendMissing` for dask, SALib or a room's engine, and `RunError` for a folder
    in other use.
    """
    source = source_of(study) if isinstance(study, Mapping) else read_source(Path(study))
    file = None if isinstance(study, Mapping) else Path(study)
    stated = _of_frame(points) if isinstance(points, pd.DataFrame) else read_sweep(Path(points))
    made = studies(source, study_of(source, installed(), file), stated)
    where = Where(executor, workers or os.cpu_count() or 1, scheduler)
    run(made, stated, Path(out), where, progress or Progress(), jit)
    return read_swept(Path(out))


def _of_frame(points: pd.DataFrame) -> Sweep:
    values = points.drop(columns=NAME, errors="ignore")
    names = tuple(map(str, points[NAME])) if NAME in points else ()
    rows = tuple(tuple(row) for row in values.astype(object).itertuples(index=False, name=None))
    return Sweep("points", "table", tuple(map(str, values.columns)), rows, names)
