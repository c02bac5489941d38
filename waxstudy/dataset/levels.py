"""Levels as a loop has them: openings and outputs from 0 to 1, signals that are on or off and nothing between."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
import pandas as pd

from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.limits import BEYOND_END, FEW_BETWEEN, FEWEST_BETWEEN, MOST_BETWEEN, NEAR_END
from waxstudy.dataset.notes import Notes
from waxstudy.plugin import Choice, FloatArray, SimulationError
from waxstudy.plugin.registry import PluginError
from waxstudy.simulation.chain import Stepped

SWEEP_K, SWEEP_S = np.geomspace(1e-4, 3.0, 100), 60.0  # control errors of both signs, and how long each lasts
ERRORS_K, LEVELS = (*(-SWEEP_K[::-1]).tolist(), *SWEEP_K.tolist()), tuple(np.linspace(0.0, 1.0, 100).tolist())


def as_levels(values: pd.DataFrame, nominal: Mapping[str, Choice], notes: Notes) -> pd.DataFrame:
    """Return the samples on their grid with levels cut off at 0 and 1, and signals on or off where they can be.

    What a believed modulator gives is a signal, and without one what a believed controller gives that only switches.
    What any other controller gives is none. The user is told what was changed.
    """
    found = values.copy(deep=False)
    for name in values.columns:
        if CHANNELS[name].quantity == "level":
            found[name] = _within(name, values[name].to_numpy(dtype=float), notes)
    for name in signals_of(nominal):
        if name in found:
            found[name] = _as_signal(name, found[name].to_numpy(), notes)
    return found


def signals_of(nominal: Mapping[str, Choice]) -> tuple[str, ...]:
    """Return the channels that are on or off by what is believed of a loop."""
    if "modulator" in nominal or "controller" not in nominal:
        return ("heating_signal",)
    return ("control_output", "heating_signal") if only_switches(nominal["controller"]) else ()


def drives_by_switching(nominal: Mapping[str, Choice]) -> bool | None:
    """Whether what drives the motor only switches; None where neither modulator nor controller is believed."""
    if "modulator" in nominal:
        return only_switches(nominal["modulator"], LEVELS)
    return only_switches(nominal["controller"]) if "controller" in nominal else None


@cache
def only_switches(block: Choice, given: tuple[float, ...] = ERRORS_K) -> bool:
    """Whether a block gives nothing but on and off: a controller from far too warm to far too cold."""
    try:
        stepped = Stepped(block, SWEEP_S)
        return all(stepped.step(u, n * SWEEP_S) in (0.0, 1.0) for n, u in enumerate(given))
    except (SimulationError, PluginError):  # which a diagnosis tells of
        return False


def _within(name: str, x: FloatArray, notes: Notes) -> FloatArray:
    if ((x < -BEYOND_END) | (x > 1.0 + BEYOND_END)).any():
        least, most = float(np.nanmin(x)), float(np.nanmax(x))
        notes.assume(f"{name} reaches from {least:.3g} to {most:.3g}; it is cut off at 0 and 1.")
    return np.clip(x, 0.0, 1.0)


def _as_signal(name: str, level: FloatArray, notes: Notes) -> FloatArray:
    """Return a signal exactly on or off; as it is where it runs on, or pulses within its samples.

    A sample between off and on is the mean of an interval in which it switched: its end is what follows. One between
    two of the same is a fault, and one beside a gap says nothing.
    """
    between = (level > NEAR_END) & (level < 1.0 - NEAR_END)
    if not (level >= 1.0 - NEAR_END).any() or between.sum() > MOST_BETWEEN * np.isfinite(level).sum():
        return level
    ends = np.where(between, np.nan, np.round(level))
    before, after = np.concatenate(([np.nan], ends[:-1])), np.concatenate((ends[1:], [np.nan]))
    switches = between & (np.abs(after - before) == 1.0)
    if np.count_nonzero(between & ~switches) > max(FEWEST_BETWEEN, FEW_BETWEEN * between.sum()):
        return level
    _tell(name, level, between, ends, notes)
    return np.where(between, np.where(switches | (after == before), after, np.nan), ends)


def _tell(name: str, level: FloatArray, between: np.ndarray, ends: FloatArray, notes: Notes) -> None:
    if count := int(between.sum()):
        lie = "1 sample lies" if count == 1 else f"{count} samples lie"
        first = f"the first is {level[np.argmax(between)]:.3g}"
        notes.warn(f"{name}: {lie} between off and on ({first}): taken as what follows, as of means over a switch")
    if np.nanmax(np.abs(level - ends), initial=0.0) > BEYOND_END:
        notes.assume(f"{name} within {NEAR_END:g} of 0 and 1 is taken as off and on.")
