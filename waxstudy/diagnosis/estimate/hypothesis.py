"""A hypothesis at fitted values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from waxstudy.diagnosis.estimate.parameter_space import EffectType, Values
from waxstudy.diagnosis.estimate.residual import Residual
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.plugin import FloatArray


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

    def missed(self, parts: Sequence[int]) -> FloatArray:
        """Whitened residuals of all channels on some parts."""
        return np.concatenate([each.whitened[np.isin(each.part, parts)] for each in self.residuals])
