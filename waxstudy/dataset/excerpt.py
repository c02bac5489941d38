"""What is looked at of a long or fine record: its time and memory would grow with every sample."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from waxstudy.dataset.interval import coarser
from waxstudy.dataset.limits import AS_GOOD, FINEST_S, MOST_DAYS
from waxstudy.dataset.read import Dataset
from waxstudy.plugin import FloatArray

SWITCHING = ("heating_signal", "control_output", "displacement", "flow_L_h")  # the first that was recorded


def excerpt(dataset: Dataset) -> Dataset:
    """Return the days of a dataset that tell most, at `FINEST_S` at most; a warning says what was left out."""
    return _days(_coarser(dataset))


def _coarser(dataset: Dataset) -> Dataset:
    factor = int(np.ceil(FINEST_S / dataset.interval_s - 1e-9))
    if factor < 2:
        return dataset
    interval_s = factor * dataset.interval_s
    every = f"{dataset.interval_s:g} s"
    said = f"Samples every {every} are finer than anything in a loop: they are taken every {interval_s:g} s."
    return replace(coarser(dataset, interval_s), assumptions=(*dataset.assumptions, said))


def _days(dataset: Dataset) -> Dataset:
    day = (dataset.time - pd.Timedelta(dataset.interval_s, "s")).normalize()
    days = day.unique()
    if len(days) <= MOST_DAYS + 1:
        return dataset
    told = pd.Series(_telling(dataset)).groupby(np.asarray(day)).sum().to_numpy()
    sums = np.convolve(told, np.ones(MOST_DAYS), mode="valid")
    first = int(np.flatnonzero(sums >= AS_GOOD * sums.max())[-1])
    chosen = (day >= days[first]) & (day <= days[first + MOST_DAYS - 1])
    begin, end = (f"{each:%Y-%m-%d}" for each in (days[first], days[first + MOST_DAYS - 1]))
    moves = "the valve moves most and " if _switching(dataset) else ""
    said = (
        f"Of the record's {len(days)} days the {MOST_DAYS} from {begin} to {end} are judged, which tell most: "
        f"{moves}least is missing there. What shows on other days only is not seen: cut the record to judge those."
    )
    if dataset.neighbours:
        said += " Rooms beside each other are judged on all days."
    return replace(
        dataset, time=dataset.time[chosen], values=dataset.values[chosen], warnings=(*dataset.warnings, said)
    )


def _telling(dataset: Dataset) -> FloatArray:
    """Return what each sample tells: that it is there, and as much as a day of samples where the valve opens."""
    there = dataset.values.notna().mean(axis=1).to_numpy(dtype=float) * dataset.interval_s / 86_400.0
    name = _switching(dataset)
    if name is None:
        return np.asarray(there)
    values = dataset.values[name].to_numpy(dtype=float)
    on = values > 0.5 * np.nanmax(values, initial=0.0)
    return np.asarray(there + np.append(0.0, on[1:] & ~on[:-1]))


def _switching(dataset: Dataset) -> str | None:
    """Return the recorded channel that tells when the valve moves, None where there is none."""
    return next((each for each in SWITCHING if each in dataset.values), None)
