"""Levels as a loop has them: openings and outputs from 0 to 1, signals that are on or off and nothing between."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.notes import Notes
from waxstudy.plugin import FloatArray

if TYPE_CHECKING:
    import pandas as pd

NEAR = 0.05  # of an end: what an instrument may add to it, or a channel of volts may lack
MOST_BETWEEN = 0.35  # share of a signal's samples that may fall upon its switches
FEW, FEWEST = 0.1, 3  # share of those, and count, that may be faults; more are pulses shorter than a sample
TOLD = 1e-3  # beyond an end, from which it is worth a word


def as_levels(values: pd.DataFrame, has_modulator: bool, notes: Notes) -> pd.DataFrame:
    """Return the samples on their grid with levels cut off at 0 and 1, and signals on or off where they can be.

    The output before a believed modulator may be anything between; so may output and signal without one, if they are
    more than a fault now and then. The user is told what was changed.
    """
    found = values.copy()
    for name in values.columns:
        if CHANNELS[name].quantity == "level":
            found[name] = _within(name, values[name].to_numpy(dtype=float), notes)
    if "control_output" in found and not has_modulator:
        output = found["control_output"].to_numpy()
        found["control_output"] = _as_signal("control_output", output, notes, is_mean=False)
    runs_on = "control_output" in found and not has_modulator and not _is_binary(found["control_output"].to_numpy())
    if "heating_signal" in found:
        signal = found["heating_signal"].to_numpy()
        found["heating_signal"] = _as_signal("heating_signal", signal, notes, is_mean=not runs_on)
    return found


def _within(name: str, x: FloatArray, notes: Notes) -> FloatArray:
    if ((x < -TOLD) | (x > 1.0 + TOLD)).any():
        least, most = float(np.nanmin(x)), float(np.nanmax(x))
        notes.assume(f"{name} reaches from {least:.3g} to {most:.3g}; it is cut off at 0 and 1.")
    return np.clip(x, 0.0, 1.0)


def _is_binary(x: FloatArray) -> bool:
    return bool(np.isin(x[np.isfinite(x)], (0.0, 1.0)).all())


def _as_signal(name: str, level: FloatArray, notes: Notes, *, is_mean: bool) -> FloatArray:
    """Return a signal exactly on or off; as it is where it runs on, or pulses within its samples.

    A sample between off and on is the mean of an interval in which it switched, if means are logged: its end is what
    follows. One between two of the same is a fault, and one beside a gap says nothing.
    """
    between = (level > NEAR) & (level < 1.0 - NEAR)
    if not (level >= 1.0 - NEAR).any() or between.sum() > MOST_BETWEEN * np.isfinite(level).sum():
        return level
    ends = np.where(between, np.nan, np.round(level))
    before, after = np.concatenate(([np.nan], ends[:-1])), np.concatenate((ends[1:], [np.nan]))
    switches = between & (np.abs(after - before) == 1.0)
    odd = np.count_nonzero(between & ~switches) if is_mean else np.count_nonzero(between)
    if odd > max(FEWEST, FEW * between.sum() if is_mean else 0):
        return level
    _tell(name, level, between, ends, notes)
    return np.where(between, np.where(switches | (after == before), after, np.nan), ends)


def _tell(name: str, level: FloatArray, between: np.ndarray, ends: FloatArray, notes: Notes) -> None:
    if count := int(between.sum()):
        lie = "1 sample lies" if count == 1 else f"{count} samples lie"
        first = f"the first is {level[np.argmax(between)]:.3g}"
        notes.warn(f"{name}: {lie} between off and on ({first}): taken as what follows, as of means over a switch")
    if np.nanmax(np.abs(level - ends), initial=0.0) > TOLD:
        notes.assume(f"{name} within {NEAR:g} of 0 and 1 is taken as off and on.")
