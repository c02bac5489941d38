"""A hypothesis at fitted values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from waxstudy.gap.judge import Errors
from waxstudy.gap.reading import Reading
from waxstudy.gap.space import EffectType, Values
from waxstudy.plugin import FloatArray


@dataclass(frozen=True)
class Fitted:
    """A belief with effects and departures fitted to a link: what it says, and what it misses."""

    effects: tuple[tuple[EffectType, Values], ...]
    reading: Reading
    departures: FloatArray
    errors: Sequence[Errors] = field(repr=False)

    def loss(self, part: int) -> float:
        return sum(each.loss(part) for each in self.errors)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(effect.name for effect, _ in self.effects)

    def errors_of(self, channel: str) -> Errors:
        return next(each for each in self.errors if each.channel == channel)

    @property
    def whitened(self) -> FloatArray:
        """Whitened errors of all channels, one after the other."""
        return np.concatenate([each.whitened for each in self.errors])

    def missed(self, parts: Sequence[int]) -> FloatArray:
        """Whitened errors of all channels on some parts."""
        return np.concatenate([each.whitened[np.isin(each.part, parts)] for each in self.errors])
