"""Channels that are dead in a record or in its baseline, as the other of the two tells."""

from __future__ import annotations

from dataclasses import replace

from waxstudy.dataset.checks.samples import MOVING_ONES
from waxstudy.dataset.noon import OF_SUN
from waxstudy.dataset.read import Dataset

MOVING = tuple(name for (name,) in MOVING_ONES)


def without_dead(dataset: Dataset, baseline: Dataset) -> tuple[Dataset, Dataset]:
    """Return both without a sun that is 0 throughout, or a temperature that never changes, where the other one's does.

    What is dropped counts as not recorded, and the record warns of it. What is steady in both, as in a chamber, or is
    assumed, stays.
    """
    both = [name for name in (*OF_SUN, *MOVING) if name in dataset.values and name in baseline.values]
    here = [name for name in both if _is_dead(dataset, name) and _lives(baseline, name)]
    there = [name for name in both if _is_dead(baseline, name) and _lives(dataset, name)]
    said = [*_said(dataset, here, "", "baseline"), *_said(baseline, there, " in the baseline", "record")]
    warned = replace(dataset, warnings=(*said, *dataset.warnings)) if said else dataset
    return _without(warned, here), _without(baseline, there)


def _is_dead(dataset: Dataset, name: str) -> bool:
    values = dataset.values[name].dropna()
    if name in OF_SUN:
        return len(values) > 0 and not (values > 0.0).any()
    return values.nunique() == 1 and name not in dataset.assumed


def _lives(dataset: Dataset, name: str) -> bool:
    values = dataset.values[name]
    return bool((values > 0.0).any()) if name in OF_SUN else values.nunique() > 1 and name not in dataset.assumed


def _said(of: Dataset, dead: list[str], where: str, other: str) -> list[str]:
    sun, still = ([name for name in dead if (name in OF_SUN) == is_sun] for is_sun in (True, False))
    of_sun = [f"{', '.join(sun)}: 0 throughout{where}, though the {other} has sun; taken as not recorded"]
    values = {name: of.values[name].dropna().iloc[0] for name in still}
    of_rest = [
        f"{name}: {value:g} C throughout{where}, though it moves in the {other}; taken as not recorded (if it is "
        "meant, name it in `inputs` of [dataset])"
        for name, value in values.items()
    ]
    return [*(of_sun if sun else []), *of_rest]


def _without(dataset: Dataset, names: list[str]) -> Dataset:
    return replace(dataset, values=dataset.values.drop(columns=names)) if names else dataset
