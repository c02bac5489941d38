"""What a check of a record is, and how a list of checks is run."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby
from typing import NamedTuple

import numpy as np
import pandas as pd

from waxstudy.dataset.channels import CHANNELS, Quantity
from waxstudy.dataset.limits import ENOUGH
from waxstudy.dataset.notes import Notes

ORDER = list(CHANNELS)


@dataclass(frozen=True)
class Record:
    """What a check may look at."""

    values: pd.DataFrame  # a column per channel, in the order of the channel table
    interval_s: float  # of the grid; of rows as they were logged, the usual distance of their stamps
    has_modulator: bool = False  # whether one is believed
    full_flow_L_h: float | None = None  # of the believed room with its valve open


class Refuse(NamedTuple):
    """A fault that makes the record unusable."""

    who: Hashable  # the channels at fault
    wrong: str
    mend: str = ""  # with the numbers of this record, if there are any


class Warn(NamedTuple):
    """A doubt that the user must know."""

    sentence: str


class Discard(NamedTuple):
    """Samples to be set to missing; the user is told how many."""

    channel: Hashable
    bad: np.ndarray  # (rows,) whether a sample is one of them
    what: str


Findings = Iterator[Refuse | Warn | Discard]
Look = Callable[..., Findings]  # is handed the record, and the series of the channels that it looks at


class Check(NamedTuple):
    """A fault that a record may have."""

    name: str
    about: str  # what its neighbours in the list are about too: those are run channel by channel
    does: str  # refuses, warns, discards
    of: tuple[tuple[str, ...], ...]  # channels that are looked at together, wherever all of them are there
    fewest: int  # samples that they must have in common, and those alone are looked at; 0: all, missing ones too
    sees: str  # what it looks at and what it takes for a fault
    mend: str
    look: Look


def check(about: str, does: str, *of: tuple[str, ...], mend: str, fewest: int = ENOUGH) -> Callable[[Look], Check]:
    """Make a check of a function: it has its name, and sees what its docstring says, with limits in braces."""

    def made(look: Look) -> Check:
        sees = " ".join(str(look.__doc__).format_map(look.__globals__).split())
        return Check(look.__name__.replace("_", "-"), about, does, of, fewest, sees, mend, look)

    return made


def each(*quantities: Quantity) -> list[tuple[str]]:
    """Return the channels of some quantities, one by one; of all, if none is named."""
    return [(channel.name,) for channel in CHANNELS.values() if not quantities or channel.quantity in quantities]


TEMPERATURES = each("indoor", "water", "outdoor")


def quantity_of(channel: pd.Series) -> Quantity:
    return CHANNELS[str(channel.name)].quantity


def run(checks: Iterable[Check], record: Record, notes: Notes) -> None:
    """Note what checks find; what they discard is missing from `record.values` then."""
    there = set(record.values.columns)
    for _, alike in groupby(checks, key=lambda check: check.about):
        looks = [(check, names) for check in alike for names in check.of if there.issuperset(names)]
        for check, names in sorted(looks, key=lambda look: [ORDER.index(name) for name in look[1][:1]]):
            seen = record.values[list(names)].dropna() if check.fewest else record.values
            if len(seen) >= check.fewest:
                for finding in check.look(record, *(seen[name] for name in names)):
                    _note(finding, record.values, notes)


def _note(finding: Refuse | Warn | Discard, values: pd.DataFrame, notes: Notes) -> None:
    match finding:
        case Refuse(who, wrong, mend):
            notes.refuse(str(who), wrong, allowed=mend)
        case Warn(sentence):
            notes.warn(sentence)
        case Discard(channel, bad, what):
            notes.lost(str(channel), values[channel].to_numpy()[bad], what)
            values.loc[bad, channel] = np.nan
