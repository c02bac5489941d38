"""The record of a run: what the engine gave at its steps, and the chain at its own, which are shorter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from waxstudy.plugin import TRACE, FloatArray
from waxstudy.simulation.standalone import CHAIN_ROW

# columns of a step of the engine; temperatures at its end, the rest its mean
MINUTE = (
    "air_C",
    "operative_C",
    "floor_surface_C",
    "layer_C",
    "floor_heat_W_m2",
    "water_heat_W",
    "supply_C",
    "return_C",
)


@dataclass(frozen=True)
class Simulated:
    """What a run gives: a row per step of the engine (`MINUTE`) and one per step of the chain (`CHAIN_ROW`)."""

    minutes: FloatArray
    chain: FloatArray
    step_s: float
    minute_s: float = 60.0  # a step of the engine

    def minute(self, name: str) -> FloatArray:
        """Return a column of the minutes."""
        return self.minutes[:, MINUTE.index(name)]

    @property
    def per_minute(self) -> int:
        """Steps of the chain in one of the engine."""
        return round(self.minute_s / self.step_s)

    def stepped(self, name: str) -> FloatArray:
        """Return a column at the chain's step: temperatures straight between the ends of minutes, the rest held."""
        return np.ascontiguousarray(self._in_minutes(name)).ravel()

    def _in_minutes(self, name: str) -> FloatArray:
        """Return a column at the chain's step, a row for each minute."""
        ends = self.minute(name)
        if not name.endswith("_C"):
            return np.broadcast_to(ends[:, None], (len(ends), self.per_minute))
        before = np.concatenate((ends[:1], ends[:-1]))
        return before[:, None] + np.outer(ends - before, (np.arange(self.per_minute) + 1.0) / self.per_minute)

    def trace(self) -> FloatArray:
        """Return the run in the columns of `kernel.TRACE`; the minute's heat is shared out as the water flowed."""
        chain = self.chain.reshape(len(self.minutes), self.per_minute, len(CHAIN_ROW))
        trace = np.empty((*chain.shape[:2], len(TRACE)))
        for place, name in enumerate(TRACE):
            trace[..., place] = chain[..., CHAIN_ROW.index(name)] if name in CHAIN_ROW else self._in_minutes(name)
        flow = chain[..., CHAIN_ROW.index("flow_fraction")]
        mean = flow.mean(axis=1, keepdims=True)
        trace[..., TRACE.index("water_heat_W")] *= np.divide(flow, mean, out=np.ones_like(flow), where=mean > 0)
        return trace.reshape(-1, len(TRACE))

    def hours_below(self, limit_C: float) -> float:
        """Return the hours of the run with an operative temperature below the limit."""
        return float(np.sum(self.stepped("operative_C") < limit_C) * self.step_s / 3600.0)
