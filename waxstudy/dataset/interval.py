"""A dataset at a longer interval than its own."""

from __future__ import annotations

from dataclasses import replace

import pandas as pd

from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.limits import LEAST_KNOWN
from waxstudy.dataset.read import Dataset


def is_longer(one: Dataset, other: Dataset) -> bool:
    """Whether the interval of one dataset is so much longer that the other must be read at it."""
    return round(one.interval_s / other.interval_s) > 1


def told(interval_s: float) -> str:
    """Return an interval in words."""
    return f"{interval_s / 60.0:g} min" if interval_s >= 60.0 else f"{interval_s:g} s"


def coarser(dataset: Dataset, interval_s: float, are_means: bool = False) -> Dataset:
    """Return a dataset at an interval that is a multiple of its own: instants at its ends, or means over it.

    Flows and heats are means in either case. What begins or ends within an interval is left out, and so is a value of
    which less than half as many samples are there as usual: a gap stays one.
    """
    place = dataset.time.ceil(pd.Timedelta(interval_s, "s"))
    groups = dataset.values.groupby(place, sort=True)
    values = groups.mean() if are_means else groups.last()
    for name in values.columns:
        if CHANNELS[name].is_mean:
            values[name] = groups[name].mean()
    count = groups.count()
    values = values.where(count >= LEAST_KNOWN * count.median())
    whole = groups.size().to_numpy() == round(interval_s / dataset.interval_s)
    values = values[whole]
    time = pd.DatetimeIndex(values.index, name=dataset.time.name)
    return replace(dataset, interval_s=interval_s, time=time, values=values)
