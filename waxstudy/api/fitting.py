"""Fit blocks to measurements."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import pandas as pd

from waxstudy.identification.description import described
from waxstudy.identification.flow import read_flow
from waxstudy.identification.fragment import read_fragment
from waxstudy.identification.performance import block
from waxstudy.identification.records import read_records
from waxstudy.identification.result import ActuatorFit, fit
from waxstudy.identification.valve import ValveFit
from waxstudy.identification.valve import fit_valve as find_curve

UNNAMED = "unnamed"
Frames = Mapping[str, pd.DataFrame] | Iterable[pd.DataFrame] | pd.DataFrame


def fit_actuator(frames: Frames, *, product: str = UNNAMED, seed: int = 1) -> ActuatorFit:
    """Return the characteristic times of a motor from records of its displacement (docs/fit.md).

    A record is a frame with columns `time_s`, `signal` and `displacement_mm`, or such as `fit actuator` takes; a
    mapping gives each a name. `.fragment(product)` is what a study takes. Raises `StudyError`,
    `ValueError` for two records of one name.
    """
    with tempfile.TemporaryDirectory(prefix="waxstudy-fit-") as place:
        paths = [_written(Path(place), name, frame) for name, frame in _named(frames)]
        return fit(read_records(described(paths), product), seed)


def fit_valve(
    record: pd.DataFrame | str | Path,
    *,
    actuator: str | Path,
    authority: float | None = None,
    how_authority: str = "",
    columns: Mapping[str, str] | None = None,
    seed: int = 1,
) -> ValveFit:
    """Return the curve of a quick-opening valve from a record of flow and heating signal (docs/fit.md).

    The record is a frame or a file; `columns` says which of its columns is `time`, `signal` or `flow`. `actuator` is
    the file of a fragment, as `fit actuator` writes it. Raises `StudyError`, `ValueError` for what is no actuator.
    """
    if isinstance(record, pd.DataFrame):
        with tempfile.TemporaryDirectory(prefix="waxstudy-fit-") as place:
            path = _written(Path(place), "flow", record)
            return fit_valve(
                path, actuator=actuator, authority=authority, how_authority=how_authority, columns=columns, seed=seed
            )
    values, about = read_fragment(Path(actuator), "actuator")
    chosen = block("actuator", values)
    (known,) = described([Path(record)], "flow")
    product = about.get("product")
    return find_curve(
        read_flow(replace(known, columns={**known.columns, **(columns or {})})),
        chosen,
        authority=authority,
        how_authority=how_authority or ("fitted" if authority is None else "given"),
        is_simulated=about.get("simulated") is True,
        product=product if isinstance(product, str) else None,
        seed=seed,
    )


def _named(frames: Frames) -> list[tuple[str, pd.DataFrame]]:
    if isinstance(frames, pd.DataFrame):
        return [("record", frames)]
    if isinstance(frames, Mapping):
        return list(frames.items())
    return [(f"record-{number}", frame) for number, frame in enumerate(frames, start=1)]


def _written(folder: Path, name: str, frame: pd.DataFrame) -> Path:
    plain = re.sub(r"[^-.+ \w]", "_", name)  # a file's name, by which the record is told
    path = folder / f"{plain}.csv"
    if path.exists():
        raise ValueError(f"two records are named '{plain}'")
    frame.to_csv(path, index=not isinstance(frame.index, pd.RangeIndex))
    return path
