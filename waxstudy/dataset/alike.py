"""A record and its baseline must show, and hide, the same: by their channels, their rounding and their intervals."""

from __future__ import annotations

from dataclasses import replace

import pandas as pd

from waxstudy.dataset.interval import coarser, is_longer, told
from waxstudy.dataset.levels import as_levels
from waxstudy.dataset.limits import NEAR_END
from waxstudy.dataset.noon import of_one_clock, without_dead_sun
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.read import Dataset
from waxstudy.dataset.rounding import rounded_alike
from waxstudy.study.problems import listed

# between which the links of the chain lie
OF_CHAIN = ("sensor_temperature_C", "control_output", "heating_signal", "displacement", "flow_L_h")
LEVELS = ("displacement", "heating_signal", "control_output")  # the first that both have tells means from instants


def alike(dataset: Dataset, baseline: Dataset) -> tuple[Dataset, Dataset]:
    """Return a record and its baseline with the record's chain, the longer interval and the coarser rounding of both.

    What differs so would be taken for a change. The user is told, also where the two seem to have different clocks.
    """
    dataset, baseline = without_dead_sun(dataset, baseline)
    dataset = of_one_clock(dataset, baseline)
    return rounded_alike(*_of_one_interval(*_of_one_chain(dataset, baseline)))


def _of_one_interval(dataset: Dataset, baseline: Dataset) -> tuple[Dataset, Dataset]:
    """Return both at the longer of their intervals: what that hides, or makes of a switch, would look like a change.

    Intervals that differ by less than a half stay.
    """
    if is_longer(baseline, dataset):
        found, kind = _sampled_as(baseline, dataset)
        said = (
            f"The baseline has a sample every {told(baseline.interval_s)}, so the record is read as {kind} of "
            f"{told(found.interval_s)}: what so long an interval hides would look like a change. "
            "What happens within it is not seen."
        )
        return replace(found, warnings=(*found.warnings, said)), baseline
    if is_longer(dataset, baseline):
        found, kind = _sampled_as(dataset, baseline)
        said = f"The baseline is read as {kind} of {told(found.interval_s)}, as the record seems to hold."
        return replace(dataset, assumptions=(*dataset.assumptions, said)), found
    return dataset, baseline


def _of_one_chain(dataset: Dataset, baseline: Dataset) -> tuple[Dataset, Dataset]:
    """Return a baseline without what a record lacks of its chain: both must be cut into the same links."""
    more = [name for name in OF_CHAIN if name in baseline.values and name not in dataset.values]
    if not more:
        return dataset, baseline
    said = f"The baseline is read without {listed(more)}, which the record lacks."
    values = baseline.values.drop(columns=more)
    return replace(dataset, assumptions=(*dataset.assumptions, said)), replace(baseline, values=values)


def _sampled_as(coarse: Dataset, fine: Dataset) -> tuple[Dataset, str]:
    """Return a fine dataset at about the interval of a coarse one, and of which kind that seems to be.

    Where nothing tells, it is taken for means: that is what is kept of old records.
    """
    interval_s = round(coarse.interval_s / fine.interval_s) * fine.interval_s
    means, instants = (coarser(fine, interval_s, are_means) for are_means in (True, False))
    are_means = _unlike(means, coarse) <= _unlike(instants, coarse)
    found, notes = means if are_means else instants, Notes("")
    values = as_levels(found.values, found.nominal, notes)
    warnings, assumptions = (*found.warnings, *notes.warnings), (*found.assumptions, *notes.assumptions)
    found = replace(found, values=values, warnings=warnings, assumptions=assumptions)
    return found, "means" if are_means else "instants at the end"


def _unlike(one: Dataset, other: Dataset) -> float:
    """Return by how much the shares of samples between off and on differ, of those not off: means have more of them.

    A signal of the other one that is on or off only may have been put right, and then so may this one's be.
    """
    name = next((each for each in LEVELS if each in one.values and each in other.values), None)
    if name is None:
        return 0.0
    levels = [one.values[name], as_levels(one.values, one.nominal, Notes(""))[name]]
    return min(abs(_between(level) - _between(other.values[name])) for level in levels)


def _between(level: pd.Series) -> float:
    heats = level[level > NEAR_END]
    return float((heats < 1.0 - NEAR_END).mean()) if len(heats) else 0.0
