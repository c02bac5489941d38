"""What an estimator needs to know of what it fits: hypotheses at given values, and what nobody knows of the rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.parameter_space import EffectType, Values
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.plugin import Belief, FloatArray


class Problem(Protocol):
    """A part of a loop and its record, as something to fit. Nuisances are departures from the belief, 0 as believed."""

    name: str
    belief: Belief
    conventions: Sequence[Convention]  # ways in which the record may have been logged, the likeliest first
    sd: FloatArray  # (nuisances,) of the normal prior of each
    events: Sequence[int]  # nuisances that happened once and are fitted to all days
    is_smooth: bool  # whether anything that is judged has slopes, as nothing has that only switches
    discounts_noise: bool  # whether ways to log it let more or less of the drive's noise through

    def edited(self, effects: Sequence[tuple[EffectType, Values]], departures: FloatArray) -> Belief:
        """Return the belief with departures and effects; raise `ValueError` where it cannot be."""

    def at(
        self, effects: Sequence[tuple[EffectType, Values]], departures: FloatArray, convention: Convention
    ) -> Hypothesis | None:
        """Return what a hypothesis misses at given values, or None where it cannot be simulated."""

    def drive_noise(self, fitted: Hypothesis) -> Mapping[int, float]:
        """Return what noise of the drive adds to a hypothesis' loss, by part of the record."""
