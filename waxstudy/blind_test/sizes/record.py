"""A record as a stage meets it: what drives it, and what it is judged by."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.signal import savgol_filter

from waxstudy.plugin import Belief, FloatArray, Inputs

if TYPE_CHECKING:
    import pandas as pd

    from waxstudy.dataset.read import Dataset

SMOOTH_S = 1500.0  # of the parabola through noisy temperatures: whoever reads them takes their noise out
SMALL, AROUND = 0.08, 31  # an opening that may be noise; samples around one that tell whether it rests
LEVELS = ("control_output", "heating_signal")
AIR = ("air_temperature_C", "sensor_temperature_C", "operative_temperature_C")  # that tells it best, first


@dataclass(frozen=True)
class Record:
    """Channels (n,) at equal intervals from midnight on, nothing missing; temperatures of a noisy one are smoothed."""

    interval_s: float
    values: Mapping[str, FloatArray]
    assumed: tuple[str, ...] = ()
    unseen: frozenset[str] = frozenset()  # channels that are there, though who is judged has not seen them
    is_noisy: bool = False

    @classmethod
    def of(cls, table: pd.DataFrame, about: Dataset, is_noisy: bool = False) -> Record:
        """Return a table's record; what a measured one lacks is straight between its neighbours."""
        values = {str(name): _whole(table[name].to_numpy(dtype=float)) for name in table.columns}
        if about.setpoint_C is not None:
            values.setdefault("setpoint_C", np.full(len(table), about.setpoint_C))
        return cls(about.interval_s, values, about.assumed, frozenset(values) - set(about.values), is_noisy)

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    @cached_property
    def switches(self) -> frozenset[str]:
        """Channels that are only ever 0 or 1."""
        return frozenset(n for n in LEVELS if n in self.values and np.isin(self.values[n], (0.0, 1.0)).all())

    def smooth(self, values: FloatArray) -> FloatArray:
        """Return a local parabola through what is noisy, where samples are dense enough for one."""
        width = round(SMOOTH_S / self.interval_s) // 2 * 2 + 1
        return np.asarray(savgol_filter(values, width, 2)) if self.is_noisy and 5 <= width < len(values) else values

    def drive(self, channel: str) -> FloatArray:
        """Return what drives the stage behind a channel (n,)."""
        values = self.values[channel]
        if channel == "displacement" and self.is_noisy:
            return _rested(values)
        return self.smooth(values) if channel.endswith("temperature_C") else values

    @property
    def air(self) -> str:
        """The channel that tells the room's air best, "" where none does."""
        return next((name for name in AIR if name in self.values), "")

    @property
    def sensed(self) -> str:
        """The channel that tells best what the controller reads, "" where none does."""
        return "sensor_temperature_C" if "sensor_temperature_C" in self.values else self.air

    def belief(self, about: Dataset) -> Belief:
        """Return what is believed, with what drove the room where that is recorded."""
        is_driven = self.air and {"outdoor_temperature_C", "supply_temperature_C"} <= set(self.values)
        return Belief(about.nominal, about.room, self._inputs() if is_driven else None)

    def _inputs(self) -> Inputs:
        values, nothing = self.values, np.zeros(len(self))
        return Inputs(
            interval_s=self.interval_s,
            start_s=0.0,
            outdoor_C=self.drive("outdoor_temperature_C"),
            supply_C=self.drive("supply_temperature_C"),
            solar_W=values.get("solar_gain_W", nothing),
            gains_W=values.get("internal_gain_W", nothing),
            ventilation_C=values.get("ventilation_supply_temperature_C"),
            air_C=self.drive(self.air),
            flow_L_h=values.get("flow_L_h"),
            signal=values.get("heating_signal"),
            neighbour_C=values.get("neighbour_temperature_C"),
        )


def _rested(opening: FloatArray) -> FloatArray:
    """Return an opening at its ends where noise alone keeps it from them: cut off there, it often lies on them."""
    found = opening.copy()
    for end in (0.0, 1.0):
        away = np.abs(opening - end)
        resting = away[(away > 0.0) & (away < SMALL)]
        noise = np.sqrt(np.median(resting**2)) / 0.6745 if len(resting) else 0.0
        near = away < 5.0 * noise
        rests = uniform_filter1d((away == 0.0).astype(float), AROUND) >= 0.2 * uniform_filter1d(
            near.astype(float), AROUND
        )
        found[near & rests] = end
    return found


def _whole(values: FloatArray) -> FloatArray:
    at, known = np.arange(len(values)), np.isfinite(values)
    return np.interp(at, at[known], values[known])
