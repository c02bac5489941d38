"""To what a channel is rounded, and a record and its baseline with the coarser rounding of both."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.read import Dataset
from waxstudy.plugin import FloatArray

FEWEST_VALUES = 4  # of a channel whose step tells of rounding: what is on or off has two, or three by means
FEWEST_OF_TEMPERATURES = 2
LEAST_K, MOST_K = 0.1, 2.0  # chosen: less is lost in what a thermometer scatters, and nobody rounds to more
APART = 1.5  # chosen: times the finer step, from which the rounding differs
NEAR = 0.1  # chosen: of a step, by which values may miss their grid: these were rounded again, as 20.56 °C of 69 °F


def step(known: FloatArray, fewest: int = FEWEST_VALUES) -> float:
    """Return the smallest distance of two different values, 0 where fewer are there: what is on or off is no step."""
    steps = _steps(known, fewest)
    return float(np.min(steps)) if len(steps) else 0.0


def rounded_alike(dataset: Dataset, baseline: Dataset) -> tuple[Dataset, Dataset]:
    """Return a record and its baseline, each temperature rounded as in the coarser of them; the user is told.

    Rounding errors of a slow temperature last for hours, and would be taken for a change of the room.
    """
    values, before = dataset.values.copy(), baseline.values.copy()
    told: dict[tuple[str, str], list[str]] = {}
    for name in filter(_is_measured_temperature, map(str, before)):
        if name not in values:
            continue
        steps = [
            step(each[np.isfinite(each)], FEWEST_OF_TEMPERATURES)
            for each in (values[name].to_numpy(), before[name].to_numpy())
        ]
        if not LEAST_K <= max(steps) <= MOST_K or max(steps) < APART * min(steps) or not min(steps):
            continue
        fine, coarse = (before, values) if steps[0] > steps[1] else (values, before)
        rounded = _rounded(fine[name].to_numpy(), coarse[name].to_numpy())
        if rounded is not None:
            fine[name] = rounded
            told.setdefault((f"{steps[0]:.2g} K", f"{steps[1]:.2g} K"), []).append(name)
    if not told:
        return dataset, baseline
    said = [
        f"rounded to {here} in the record and to {there} in the baseline: {', '.join(names)}; both are read with the "
        "coarser, as another rounding would look like a change. What it hides is not seen"
        for (here, there), names in told.items()
    ]
    warnings = (*said, *dataset.warnings)
    return replace(dataset, values=values, warnings=warnings), replace(baseline, values=before)


def _is_measured_temperature(name: str) -> bool:
    return CHANNELS[name].unit == "C" and not CHANNELS[name].is_assumed


def _steps(known: FloatArray, fewest: int) -> FloatArray:
    values = np.unique(np.round(known, 9))
    steps = np.diff(values) if len(values) >= fewest else np.zeros(0)
    return np.asarray(steps[steps > 1e-9])


def _rounded(fine: FloatArray, coarse: FloatArray) -> FloatArray | None:
    """Return values (n,) on the grid of coarse ones, None where these lie on none."""
    known = coarse[np.isfinite(coarse)]
    steps = _steps(known, FEWEST_OF_TEMPERATURES)
    size, origin = float(np.mean(steps[steps < APART * steps.min()])), float(known[0])
    places = (known - origin) / size
    if np.any(np.abs(places - np.round(places)) > NEAR):
        return None
    return np.asarray(origin + size * np.round((fine - origin) / size))
