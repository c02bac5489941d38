"""A record of flow: read and put on a regular grid."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from waxstudy.dataset.notes import Notes
from waxstudy.identification.description import Described
from waxstudy.identification.records import BoolArray, file_hash, read_samples
from waxstudy.identification.stroke import switched
from waxstudy.plugin import FloatArray
from waxstudy.study.problems import StudyError


@dataclass(frozen=True)
class FlowRecord:
    """A record of flow on a regular grid."""

    name: str
    file: str
    sha256: str
    is_simulated: bool
    interval_s: float
    on: BoolArray
    flow: FloatArray  # in the unit of the file
    missing: BoolArray
    unit: str
    warnings: tuple[str, ...]
    product: str | None = None  # if it is told


def read_flow(known: Described) -> FlowRecord:
    """Return a record of flow; raise `StudyError`."""
    notes = Notes(str(known.path))
    samples = read_samples(known, "flow", notes)
    on = None if samples is None else switched(samples.signal, samples.values, "flow", notes)
    if samples is not None and on is not None and not np.ptp(samples.values) > 0.0:
        notes.refuse("flow", f"is {samples.values[0]:g} throughout")
    if samples is None or on is None or notes.problems:
        raise StudyError(notes.problems)
    return FlowRecord(
        known.name,
        known.path.name,
        file_hash(known.path) if known.path.is_file() else "",
        known.is_simulated,
        samples.interval_s,
        on,
        samples.values,
        samples.missing,
        samples.unit,
        tuple(notes.warnings),
        known.product,
    )
