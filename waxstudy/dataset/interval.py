"""Records at a longer interval: a record and its baseline must show, and hide, the same."""

from __future__ import annotations

from dataclasses import replace

import pandas as pd

from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.levels import NEAR, as_levels
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.read import Dataset

# the first that both have tells means from instants; a signal between off and on may have been put right already
LEVELS = ("displacement", "heating_signal", "control_output")


def alike(dataset: Dataset, baseline: Dataset) -> tuple[Dataset, Dataset]:
    """Return a record and its baseline, both at the longer of their intervals.

    What a longer interval hides, or makes of a switch, would be taken for a change. The user is told. Intervals that
    differ by less than a half stay.
    """
    if round(baseline.interval_s / dataset.interval_s) > 1:
        found = _sampled_as(baseline, dataset)
        said = (
            f"The baseline has a sample every {_told(baseline)}, so the record is read every {_told(found)} as well: "
            "what so long an interval hides would else look like a change. Details of motor and valve are lost so."
        )
        return replace(found, warnings=(*found.warnings, said)), baseline
    if round(dataset.interval_s / baseline.interval_s) > 1:
        found = _sampled_as(dataset, baseline)
        said = f"The baseline is read every {_told(found)}, as the record has its samples."
        return replace(dataset, assumptions=(*dataset.assumptions, said)), found
    return dataset, baseline


def _told(dataset: Dataset) -> str:
    seconds = dataset.interval_s
    return f"{seconds / 60.0:g} min" if seconds >= 60.0 else f"{seconds:g} s"


def _sampled_as(coarse: Dataset, fine: Dataset) -> Dataset:
    """Return a fine dataset at about the interval of a coarse one: instants or means, as that seems to hold."""
    interval_s = round(coarse.interval_s / fine.interval_s) * fine.interval_s
    ways = [coarser(fine, interval_s, are_means) for are_means in (False, True)]
    found = min(ways, key=lambda way: _unlike(way, coarse))
    return replace(found, values=as_levels(found.values, found.nominal, Notes("")))


def _unlike(one: Dataset, other: Dataset) -> float:
    """Return by how much the shares of samples between off and on differ, of those not off: means have more of them."""
    name = next((each for each in LEVELS if each in one.values and each in other.values), None)
    return abs(_between(one.values[name]) - _between(other.values[name])) if name else 0.0


def _between(level: pd.Series) -> float:
    heats = level[level > NEAR]
    return float((heats < 1.0 - NEAR).mean()) if len(heats) else 0.0


def coarser(dataset: Dataset, interval_s: float, are_means: bool = False) -> Dataset:
    """Return a dataset at an interval that is a multiple of its own: instants at its ends, or means over it.

    Flows and heats are means in either case. What begins or ends within an interval is left out.
    """
    place = dataset.time.ceil(pd.Timedelta(interval_s, "s"))
    groups = dataset.values.groupby(place, sort=True)
    values = groups.mean() if are_means else groups.last()
    for name in values.columns:
        if CHANNELS[name].is_mean:
            values[name] = groups[name].mean()
    whole = groups.size().to_numpy() == round(interval_s / dataset.interval_s)
    values = values[whole]
    time = pd.DatetimeIndex(values.index, name=dataset.time.name)
    return replace(dataset, interval_s=interval_s, time=time, values=values)
