"""The record of a run: what the engine gave at its steps, and the chain at its own, which are shorter."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from waxstudy.plugin import TRACE, FloatArray
from waxstudy_energyplus.chain import CHAIN_ROW

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
    """What a run gives: a row per step of the engine (`MINUTE`) and a row per step of the chain (`chain.CHAIN_ROW`)."""

    minutes: FloatArray
    chain: FloatArray
    step_s: float
    minute_s: float = 60.0  # a step of the engine

    def minute(self, name: str) -> FloatArray:
        """Return a column of the minutes."""
        return self.minutes[:, MINUTE.index(name)]

    def stepped(self, name: str) -> FloatArray:
        """Return a column at the chain's step: temperatures straight between the ends of minutes, the rest held."""
        column, per_minute = self.minute(name), round(self.minute_s / self.step_s)
        if not name.endswith("_C"):
            return np.repeat(column, per_minute)
        ends_s = (np.arange(len(column)) + 1.0) * self.minute_s
        steps_s = (np.arange(len(column) * per_minute) + 1.0) * self.step_s
        return np.asarray(np.interp(steps_s, ends_s, column))

    def trace(self) -> FloatArray:
        """Return the run in the columns of `kernel.TRACE`; the minute's heat is shared out as the water flowed."""
        columns = {name: self.chain[:, place] for place, name in enumerate(CHAIN_ROW)}
        flow = columns["flow_fraction"].reshape(len(self.minutes), -1)
        mean = flow.mean(axis=1, keepdims=True)
        share = np.divide(flow, mean, out=np.ones_like(flow), where=mean > 0)
        columns["water_heat_W"] = self.stepped("water_heat_W") * share.ravel()
        return np.column_stack([columns[name] if name in columns else self.stepped(name) for name in TRACE])

    def hours_below(self, limit_C: float) -> float:
        """Return the hours of the run with an operative temperature below the limit."""
        return float(np.sum(self.stepped("operative_C") < limit_C) * self.step_s / 3600.0)
