"""Levels as a loop has them: openings and outputs from 0 to 1, signals that are on or off and nothing between."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.notes import Notes
from waxstudy.plugin import FloatArray

if TYPE_CHECKING:
    import pandas as pd

NOISE = 0.05  # of an end: what an instrument may add to it, or a channel of volts may lack
MOST_BETWEEN = 0.35  # share of a signal's samples that may fall upon its switches
ADJACENT = 0.1  # share of those with one beside it, from which a level runs on and is no signal


def as_levels(rows: pd.DataFrame, has_modulator: bool, notes: Notes) -> pd.DataFrame:
    """Return the rows with levels cut off at 0 and 1, and signals that are on or off at every sample.

    The output before a believed modulator may be anything between; the user is told what was changed.
    """
    found = rows.copy()
    for name in rows.columns:
        if CHANNELS[name].quantity != "level":
            continue
        level = _within(name, rows[name].to_numpy(dtype=float), notes)
        is_signal = name == "heating_signal" or (name == "control_output" and not has_modulator)
        found[name] = _switched(name, level, notes) if is_signal else level
    return found


def _within(name: str, x: FloatArray, notes: Notes) -> FloatArray:
    beyond = (x < 0.0) | (x > 1.0)
    if beyond.any():
        least, most = float(np.nanmin(x)), float(np.nanmax(x))
        notes.assume(f"{name} reaches from {least:.3g} to {most:.3g}; it is cut off at 0 and 1.")
    return np.clip(x, 0.0, 1.0)


def _switched(name: str, level: FloatArray, notes: Notes) -> FloatArray:
    """Return a signal that is on or off, exactly so; what seems to run on, as it is.

    A sample between is the mean of an interval in which it switched, or a fault: its end is what follows it.
    """
    known = np.flatnonzero(np.isfinite(level))
    values = level[known]
    is_between = (values > NOISE) & (values < 1.0 - NOISE)
    count = int(is_between.sum())
    if not len(known) or count > MOST_BETWEEN * len(known) or not (values >= 1.0 - NOISE).any():
        return level
    if np.count_nonzero(is_between[1:] & is_between[:-1]) > ADJACENT * count:
        return level
    ends = np.flatnonzero(~is_between)
    follows = ends[np.clip(np.searchsorted(ends, np.arange(len(known))), 0, len(ends) - 1)]
    if count:
        lie = "1 sample lies" if count == 1 else f"{count} samples lie"
        first = f"the first is {values[np.argmax(is_between)]:.3g}"
        notes.warn(f"{name}: {lie} between 0 and 1 ({first}), as means over a switch do: taken as what follows")
    signal = level.copy()
    signal[known] = np.round(values[follows])
    return signal
