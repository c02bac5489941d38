"""What is told of one loop in one call: its figures, and the series that fleets are summed of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy.results.kpis import FULLY_OPEN
from waxstudy.simulation import kernel

MOST_OF_FLOW = 0.9
LATER_S = 300.0  # over which what comes after the call is averaged
# of a row of the table of loops: where it belongs, then what it tells; drawn values stand between, by their keys
PLACE = {"loop": "1", "room": "1", "week": "1", "state": "1", "at_h": "h", "pause_s": "s"}
FIGURES = {
    "opening_before": "1",
    "flow_s": "s",
    "opening_s": "s",
    "added_Wh": "Wh",
    "early_Wh": "Wh",
    "later_Wh": "Wh",
    "coldest_C": "C",
    "warmest_C": "C",
    "warmer_K": "K",
    "colder_K": "K",
    "below_min": "min",
    "below_without_min": "min",
    "full_flow_L_h": "L/h",
    "idle_share": "1",
}
SERIES = {"heat_W": "W", "without_W": "W", "flow_L_h": "L/h", "later_W": "W"}
UNITS = {**PLACE, **FIGURES, **SERIES}
COLUMN = {name: place for place, name in enumerate(kernel.TRACE)}


@dataclass(frozen=True)
class Called:
    """A loop's traces with the call and without it, from the same step on, as long as each other.

    The call begins at step `begin` of them, which is not their first, and ends at `end`.
    """

    trace: FloatArray
    without: FloatArray
    begin: int
    end: int
    step_s: float
    signal: str
    full_flow_L_h: float
    limit_C: float  # operative temperature below which minutes count

    def figures(self) -> dict[str, Any]:
        """Return `FIGURES` but for `idle_share`, and `SERIES`."""
        call, heat_W = slice(self.begin, self.end), self._of("water_heat_W")
        more_W = heat_W - self._of("water_heat_W", self.without)
        operative_C, without_C = self._of("operative_C"), self._of("operative_C", self.without)
        apart_K = operative_C - without_C
        flow, opening = self._of("flow_fraction")[call], self._of("opening")
        return {
            "opening_before": float(opening[self.begin - 1]),
            "flow_s": self._first(flow, MOST_OF_FLOW),
            "opening_s": self._first(opening[call], FULLY_OPEN),
            "added_Wh": self._Wh(more_W[call]),
            "early_Wh": self._Wh(more_W[: self.begin]),
            "later_Wh": self._Wh(more_W[self.end :]),
            "coldest_C": float(operative_C.min()),
            "warmest_C": float(operative_C.max()),
            "warmer_K": float(apart_K.max()),
            "colder_K": float(-apart_K.min()),
            "below_min": float(np.sum(operative_C < self.limit_C)) * self.step_s / 60.0,
            "below_without_min": float(np.sum(without_C < self.limit_C)) * self.step_s / 60.0,
            "full_flow_L_h": self.full_flow_L_h,
            **{name: values.astype(np.float32) for name, values in self._series(flow, more_W).items()},
        }

    def _series(self, flow: FloatArray, more_W: FloatArray) -> dict[str, FloatArray]:
        call = slice(self.begin, self.end)
        return {
            "heat_W": self._of("water_heat_W")[call],
            "without_W": self._of("water_heat_W", self.without)[call],
            "flow_L_h": flow * self.full_flow_L_h,
            "later_W": _means(more_W[self.begin :], later_steps(self.step_s)),
        }

    def _of(self, channel: str, trace: FloatArray | None = None) -> FloatArray:
        return np.asarray((self.trace if trace is None else trace)[:, COLUMN[channel]])

    def _Wh(self, power_W: FloatArray) -> float:
        return float(power_W.sum()) * self.step_s / 3600.0

    def _first(self, values: FloatArray, most: float) -> float:
        """Return when a loop has answered [s], NaN if it does not while it is called."""
        answered = values >= most if self.signal == "on" else values <= 1.0 - most
        return (int(np.argmax(answered)) + 1) * self.step_s if answered.any() else np.nan


def later_steps(step_s: float) -> int:
    """Return the steps of a mean of what comes later, which takes about `LATER_S`."""
    return max(1, round(LATER_S / step_s))


def _means(values: FloatArray, steps: int) -> FloatArray:
    """Return means over so many steps; what is left at the end is left out."""
    whole = len(values) // steps * steps
    return np.asarray(values[:whole].reshape(-1, steps).mean(axis=1))
