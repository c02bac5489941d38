"""A record and its baseline with each temperature rounded as in the coarser of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.limits import COARSER_STEP, FEWEST_ROUNDED, LEAST_STEP_K, MOST_STEP_K, OFF_STEP
from waxstudy.dataset.read import Dataset
from waxstudy.dataset.resolution import step, steps
from waxstudy.plugin import FloatArray


def rounded_alike(dataset: Dataset, baseline: Dataset) -> tuple[Dataset, Dataset]:
    """Return a record and its baseline, each temperature rounded as in the coarser of them; the user is told.

    Rounding errors of a slow temperature last for hours, and would be taken for a change of the room.
    """
    here, there = dict[str, FloatArray](), dict[str, FloatArray]()
    told: dict[tuple[str, str], list[str]] = {}
    for name in filter(_is_measured_temperature, map(str, baseline.values)):
        if name not in dataset.values:
            continue
        pair = dataset.values[name].to_numpy(), baseline.values[name].to_numpy()
        sizes = [step(each[np.isfinite(each)], FEWEST_ROUNDED) for each in pair]
        if not LEAST_STEP_K <= max(sizes) <= MOST_STEP_K or max(sizes) < COARSER_STEP * min(sizes) or not min(sizes):
            continue
        is_record_coarse = sizes[0] > sizes[1]
        coarse, fine = pair if is_record_coarse else pair[::-1]
        rounded = _rounded(fine, coarse)
        if rounded is not None:
            (there if is_record_coarse else here)[name] = rounded
            told.setdefault((f"{sizes[0]:.2g} K", f"{sizes[1]:.2g} K"), []).append(name)
    if not told:
        return dataset, baseline
    said = [
        f"rounded to {ours} in the record and to {theirs} in the baseline: {', '.join(names)}; both are read with the "
        "coarser, as another rounding would look like a change. What it hides is not seen"
        for (ours, theirs), names in told.items()
    ]
    record = replace(dataset, values=dataset.values.assign(**here), warnings=(*said, *dataset.warnings))
    return record, replace(baseline, values=baseline.values.assign(**there))


def _is_measured_temperature(name: str) -> bool:
    return CHANNELS[name].unit == "C" and not CHANNELS[name].is_assumed


def _rounded(fine: FloatArray, coarse: FloatArray) -> FloatArray | None:
    """Return values (n,) on the grid of coarse ones, None where these lie on none."""
    known = coarse[np.isfinite(coarse)]
    sizes = steps(known, FEWEST_ROUNDED)
    size, origin = float(np.mean(sizes[sizes < COARSER_STEP * sizes.min()])), float(known[0])
    places = (known - origin) / size
    if np.any(np.abs(places - np.round(places)) > OFF_STEP):
        return None
    return np.asarray(origin + size * np.round((fine - origin) / size))
