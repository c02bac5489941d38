"""Samples so long that pulses come and go within them: what a switch was logged as is a share of time."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from waxstudy.dataset.levels import drives_by_switching, signals_of
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import Belief, FloatArray

SETTLED_S = 6 * 3600.0  # chosen: by then any motor stands still
BEHIND = ("displacement",)  # a channel that is hidden with the signal before it


def hidden_pulses(record: Record, belief: Belief) -> frozenset[str]:
    """Return the channels of the chain that long samples show as means over pulses.

    That is a signal which is believed to be on or off and was logged between, and what a motor does on it. Samples of
    five minutes and less are as short as a stroke of most motors.
    """
    if record.interval_s <= WEIGHTS.hidden_s or not drives_by_switching(belief.blocks):
        return frozenset()
    found = {name for name in signals_of(belief.blocks) if record.has(name) and name not in record.binary}
    return frozenset((*found, *filter(record.has, BEHIND))) if found else frozenset()


def by_shares(
    share: FloatArray, settled: Callable[[float], Mapping[str, FloatArray]]
) -> tuple[Mapping[str, FloatArray], Mapping[str, FloatArray]]:
    """Return what blocks show at the ends of samples and as their means, driven for a share (n,) of each sample.

    `settled` gives each block's output where its drive is off (0) or on (1) for long. Between the two nothing is seen.
    """
    off, on = settled(0.0), settled(1.0)
    shown = {kind: np.asarray(off[kind][-1] + (on[kind][-1] - off[kind][-1]) * share) for kind in off}
    return shown, shown
