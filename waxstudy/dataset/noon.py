"""The sun of a record and of its baseline: one that is highest at another hour."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from waxstudy.dataset.channels import LIGHT
from waxstudy.dataset.limits import APART_H, DARK_H, LEAST_DAYS, RISEN
from waxstudy.dataset.read import Dataset
from waxstudy.dataset.stand_ins import SUN

OF_SUN = (SUN, *LIGHT)


def of_one_clock(dataset: Dataset, baseline: Dataset) -> Dataset:
    """Return a record that warns where its sun is earlier or later than that of its baseline."""
    for name in OF_SUN:
        if name in dataset.values and name in baseline.values:
            here, there = noon_h(dataset, name), noon_h(baseline, name)
            if abs(late_h := here - there) > APART_H:
                how = f"{abs(late_h):.1f} h {'later' if late_h > 0.0 else 'earlier'}"
                said = (
                    f"{name} is {how} than in the baseline, more than the season explains: check that it has the "
                    "clock of the other channels, without summer time, in record and baseline"
                )
                return replace(dataset, warnings=(said, *dataset.warnings))
    return dataset


def noon_h(dataset: Dataset, name: str) -> float:
    """Return the hour of the day halfway between sunrise and sunset, less the equation of time; NaN if none tells.

    Light of the sky reaches every window all day long, wherever it faces: days are as long before noon as after it.
    """
    from pvlib.solarposition import equation_of_time_spencer71

    sun = dataset.values[name]
    time = pd.DatetimeIndex(sun.index) - pd.Timedelta(dataset.interval_s / 2.0, "s")
    up = pd.Series(time, time)[(sun > RISEN * sun.max()).to_numpy()]
    days = up.groupby(up.index.normalize()).agg(["min", "max"])
    rise_h, set_h = ((days[end] - days.index).dt.total_seconds() / 3600.0 for end in ("min", "max"))
    has_night = (set_h > rise_h) & (rise_h > DARK_H) & (set_h < 24.0 - DARK_H)
    early_h = equation_of_time_spencer71(pd.DatetimeIndex(days.index).day_of_year) / 60.0
    noons_h = ((rise_h + set_h) / 2.0 + early_h)[has_night]
    return float(np.median(noons_h)) if len(noons_h) >= LEAST_DAYS else float("nan")
