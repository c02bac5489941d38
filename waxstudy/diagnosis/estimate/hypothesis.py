"""Hypotheses at fitted values, what they miss, and what an estimator needs to know of what they are fitted to."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from waxstudy.diagnosis.estimate.parameter_space import Edits, EffectType, Values
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.plugin import Belief, FloatArray


@dataclass(frozen=True)
class Residual:
    """What is missed of one channel: `error` in `unit`, and over its standard deviation (`whitened`), both (m,)."""

    channel: str
    unit: str
    error: FloatArray  # 0 where nothing is judged
    whitened: FloatArray  # 0 where nothing is judged
    judged: np.ndarray  # (m,) bool
    block: np.ndarray  # (m,) cycle or day
    part: np.ndarray  # (m,) FIT, HELD_OUT
    sample: np.ndarray  # (m,) index of the record's sample

    def loss(self, part: int | None = None) -> float:
        chosen = self.whitened if part is None else self.whitened[self.part == part]
        return float(chosen @ chosen)

    def gap(self, part: int | None = None) -> float:
        """Root mean square error in the channel's unit, over what is judged."""
        chosen = self.judged if part is None else self.judged & (self.part == part)
        return float(np.sqrt(np.mean(self.error[chosen] ** 2))) if chosen.any() else 0.0


@dataclass(frozen=True)
class Hypothesis:
    """A belief with effects and departures fitted to a problem, and what it misses."""

    effects: tuple[tuple[EffectType, Values], ...]
    convention: Convention
    departures: FloatArray
    residuals: Sequence[Residual] = field(repr=False)

    def loss(self, part: int) -> float:
        return sum(each.loss(part) for each in self.residuals)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(effect.name for effect, _ in self.effects)

    def residual_of(self, channel: str) -> Residual:
        return next(each for each in self.residuals if each.channel == channel)

    @property
    def whitened(self) -> FloatArray:
        """Whitened residuals of all channels, one after the other."""
        return np.concatenate([each.whitened for each in self.residuals])


class Problem(Protocol):
    """A part of a loop and its record, as something to fit. Nuisances are departures from the belief, 0 as believed."""

    name: str
    belief: Belief
    conventions: Sequence[Convention]  # ways in which the record may have been logged, the likeliest first
    sd: FloatArray  # (nuisances,) of the normal prior of each
    prior: FloatArray  # (nuisances, nuisances): turns departures over these into independent ones
    events: Sequence[int]  # nuisances that happened once and are fitted to all days
    is_smooth: bool  # whether anything that is judged has slopes, as nothing has that only switches
    discounts_noise: bool  # whether ways to log it let more or less of the drive's noise through

    def edited(self, effects: Edits, departures: FloatArray) -> Belief:
        """Return the belief with departures and effects; raise `ValueError` where it cannot be."""

    def at(self, effects: Edits, departures: FloatArray, convention: Convention) -> Hypothesis | None:
        """Return what a hypothesis misses at given values, or None where it cannot be simulated."""

    def drive_noise(self, fitted: Hypothesis) -> Mapping[int, float]:
        """Return what noise of the drive adds to a hypothesis' loss, by part of the record."""
