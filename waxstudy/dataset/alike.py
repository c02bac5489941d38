"""A record and its baseline must show, and hide, the same: by their channels, their rounding and their intervals."""

from __future__ import annotations

from dataclasses import replace

import pandas as pd

from waxstudy.dataset.dead import without_dead
from waxstudy.dataset.interval import coarser, is_longer, told
from waxstudy.dataset.levels import as_levels
from waxstudy.dataset.limits import FEW_SAMPLES, NEAR_END
from waxstudy.dataset.noon import OF_SUN, of_one_clock
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.read import Dataset
from waxstudy.dataset.rounding import rounded_alike
from waxstudy.study.problems import listed

SETPOINT = "setpoint_C"
# between which the links of the chain lie, and what they aim at
OF_CHAIN = ("sensor_temperature_C", SETPOINT, "control_output", "heating_signal", "displacement", "flow_L_h")
LEVELS = ("displacement", "heating_signal", "control_output")  # the first that both have tells means from instants


def alike(dataset: Dataset, baseline: Dataset) -> tuple[Dataset, Dataset]:
    """Return a record and its baseline with the channels of both, the longer interval and the coarser rounding.

    What differs so would be taken for a change. The user is told, also where the two seem to have different clocks.
    """
    dataset, baseline = without_dead(dataset, baseline)
    dataset = of_one_clock(dataset, baseline)
    return rounded_alike(*_of_one_interval(*_of_same_channels(dataset, baseline)))


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


def _of_same_channels(dataset: Dataset, baseline: Dataset) -> tuple[Dataset, Dataset]:
    """Return a record without what its baseline lacks, and a baseline without what the record lacks of its chain.

    Nobody can tell what changed where only the record shows it, and both must be cut into the same links. What else a
    baseline has of the room, and of what drives it, tells more of the room that the record has. A setpoint that changes
    and that only one of them recorded is read in neither: the other may have changed as well.
    """
    seen, before = (_shown(each) for each in (dataset, baseline))
    is_lit = any(name in before for name in OF_SUN)
    is_stated = SETPOINT in seen and dataset.values[SETPOINT].nunique() == 1 and baseline.setpoint_C is not None
    known = (*before, *(OF_SUN if is_lit else ()), *((SETPOINT,) if is_stated else ()))
    more = [name for name in seen if name not in known]
    lost = [name for name in OF_CHAIN if name in before and name not in seen]
    stated_C = next((each.setpoint_C for each in (dataset, baseline) if each.setpoint_C is not None), None)
    if more:
        said = (
            f"The record is read without {listed(more)}, which the baseline lacks: nobody can tell whether that "
            "changed. To judge it as well, diagnose the record without a baseline."
        )
        dataset = replace(_without(dataset, more, stated_C), warnings=(said, *dataset.warnings))
    if lost:
        said = f"The baseline is read without {listed(lost)}, which the record lacks."
        dataset = replace(dataset, assumptions=(*dataset.assumptions, said))
        baseline = _without(baseline, lost, stated_C)
    return dataset, baseline


def _without(dataset: Dataset, names: list[str], stated_C: float | None) -> Dataset:
    """Return a dataset without channels; one that loses its setpoint has that which is stated of the loop."""
    values = dataset.values.drop(columns=names)
    setpoint_C = stated_C if SETPOINT in names and dataset.setpoint_C is None else dataset.setpoint_C
    return replace(dataset, values=values, setpoint_C=setpoint_C)


def _shown(dataset: Dataset) -> list[str]:
    """Return the channels that count as recorded."""
    return [str(name) for name in dataset.values if dataset.values[name].count() > FEW_SAMPLES]


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
