"""What a hypothesis misses of one channel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from waxstudy.plugin import FloatArray


@dataclass(frozen=True)
class Residual:
    """What is missed of one channel: `error` in `unit`, and over its standard deviation (`whitened`), both (m,)."""

    channel: str
    unit: str
    error: FloatArray  # 0 where nothing is judged
    whitened: FloatArray  # 0 where nothing is judged
    judged: np.ndarray  # (m,) bool
    block: np.ndarray  # (m,) cycle or day
    part: np.ndarray  # (m,) FIT, SELECT, SHRINK
    sample: np.ndarray  # (m,) index of the record's sample
    form: float = 0.0  # in `unit`: the most that the form of a room's model may leave, as a root mean square

    def loss(self, part: int | None = None) -> float:
        chosen = self.whitened if part is None else self.whitened[self.part == part]
        return float(chosen @ chosen)

    def gap(self, part: int | None = None) -> float:
        """Root mean square error in the channel's unit, over what is judged."""
        chosen = self.judged if part is None else self.judged & (self.part == part)
        return float(np.sqrt(np.mean(self.error[chosen] ** 2))) if chosen.any() else 0.0

    def count(self, part: int) -> int:
        """Samples that are judged of a part, at least 1."""
        return max(1, int(np.sum(self.judged & (self.part == part))))
