"""Simple diagnosers to compare with; each takes a dataset and returns the JSON of a diagnosis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from waxstudy.dataset.read import Dataset
from waxstudy.diagnosis.diagnose import record_of
from waxstudy.diagnosis.model.edits import EffectType
from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import Belief

Json = dict[str, Any]


def taken(dataset: Dataset) -> tuple[Record, Belief]:
    """Return a dataset as a diagnosis takes it."""
    record = record_of(dataset)
    return record, dataset.believed(record.inputs if record.has_inputs else None)


def answer(dataset: Dataset, found: Sequence[tuple[EffectType, Mapping[str, float]]], untestable: str = "") -> Json:
    """Return a diagnosis that names effects, with no interval and no doubt."""
    effects = [
        {
            "name": effect.name,
            "stage": effect.stage,
            "group": [effect.name],
            "parameters": {name: {"value": value, "low": None, "high": None} for name, value in values.items()},
            "shrink": {"value": None, "low": None, "high": None},
        }
        for effect, values in found
    ]
    verdict = "effect" if effects else ("untestable" if untestable else "none")
    return {"dataset": dataset.name, "verdict": verdict, "effects": effects, "unexplained": [], "untestable": []}
