"""The loop left to itself, as believed and with the effects found: its figures beside those of the record.

Nothing counts of the time at which the record shows nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from waxstudy.diagnosis.model.room_response import built
from waxstudy.diagnosis.observations.record import DAY_S, Record
from waxstudy.diagnosis.result import BeforeAfter
from waxstudy.plugin import Belief, FloatArray, SimulationError
from waxstudy.simulation import kernel
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.engine import START, Loop
from waxstudy.simulation.modes import drive
from waxstudy.simulation.recorded import recorded_room, weather_of

STEP_S = 10.0
JOULES_PER_KWH = 3.6e6
OPEN = 0.05  # of full flow
RANGE = (0.01, 0.999)  # quantiles of a flow between which the valve takes it
SHIFT_K, NEAR_K = 2.0, 0.001  # how far a setpoint shift is looked for, and how finely


@dataclass(frozen=True)
class FreeRun:
    """A simulated or recorded loop: air temperature, flow and heat of the water (n,), at one interval; NaN unknown."""

    interval_s: float
    air_C: FloatArray
    flow: FloatArray  # of full flow
    heat_W: FloatArray | None

    def heat_kWh_m2(self, area_m2: float) -> float:
        if self.heat_W is None:
            return float("nan")
        return float(np.nanmean(self.heat_W)) * 7 * DAY_S / JOULES_PER_KWH / area_m2

    @property
    def has_flow(self) -> bool:
        return bool(np.isfinite(self.flow).any())

    @property
    def open_h(self) -> float:
        """Hours a day with the valve open."""
        return 24.0 * float(np.mean(self._known_flow > OPEN)) if self.has_flow else float("nan")

    @property
    def cycles(self) -> float:
        """Starts of flow a day, of whatever flows when the valve is open."""
        if not self.has_flow:
            return float("nan")
        least, most = (float(np.quantile(self._known_flow, share)) for share in RANGE)
        known, on = np.isfinite(self.flow), self.flow > max(OPEN, 0.5 * (least + most))
        starts = on[1:] & ~on[:-1] & known[:-1]  # NaN is not above, and nobody saw what came before
        return float(np.sum(starts)) / (float(np.sum(known)) * self.interval_s / DAY_S)

    @property
    def _known_flow(self) -> FloatArray:
        return self.flow[np.isfinite(self.flow)]

    def while_seen(self, other: FreeRun) -> FreeRun:
        """Return what of this run, channel by channel, falls into the time that another of the same length knows."""
        place = (np.arange(len(self.air_C)) * self.interval_s // other.interval_s).astype(int)

        def of(own: FloatArray, others: FloatArray) -> FloatArray:
            return own if np.isnan(others).all() else np.where(np.isnan(others[place]), np.nan, own)

        heat_W = self.heat_W if self.heat_W is None or other.heat_W is None else of(self.heat_W, other.heat_W)
        return replace(self, air_C=of(self.air_C, other.air_C), flow=of(self.flow, other.flow), heat_W=heat_W)


def closed_loop(record: Record, before: Belief, after: Belief) -> Mapping[str, BeforeAfter]:
    """Return figures of the record and of the loop as believed and with its effects; nothing where it cannot run.

    Heat is per week and floor area. The air's error is that of its distribution, the mean distance of the sorted
    temperatures: a cycle that slips is no error. The shift of the setpoint is the one with which the loop would have
    the record's mean air temperature.
    """
    setpoint_C = float(np.nanmedian(record.filled("setpoint_C")))
    try:
        seen = recorded(record, before, after.inputs.supply_C - record.inputs.supply_C if after.inputs else 0.0)
        runs = [free_run(belief, setpoint_C).while_seen(seen) for belief in (before, after)]
        shifts = [_shift_K(seen, belief, setpoint_C) for belief in (before, after)]
    except (SimulationError, ValueError):
        return {}
    area_m2 = built(before.room).floor_area_m2 if before.room else float("nan")
    rows = {
        "heat_kWh_m2": [run.heat_kWh_m2(area_m2) for run in (seen, *runs)],
        "air_mean_C": [float(np.nanmean(run.air_C)) for run in (seen, *runs)],
        "air_mae_K": [0.0, *(distance(seen.air_C, run.air_C) for run in runs)],
        "cycles_per_day": [run.cycles for run in (seen, *runs)],
        "open_h_per_day": [run.open_h for run in (seen, *runs)],
        "setpoint_shift_K": [0.0, *shifts],
    }
    heat = rows["heat_kWh_m2"]
    rows["heat_percent"] = [0.0, *(100.0 * (value / heat[0] - 1.0) if heat[0] else float("nan") for value in heat[1:])]
    return {name: BeforeAfter(*values) for name, values in rows.items() if np.isfinite(values).all()}


def distance(one: FloatArray, other: FloatArray) -> float:
    """Return the mean distance of two distributions (first Wasserstein distance)."""
    from scipy.stats import wasserstein_distance

    return float(wasserstein_distance(one[np.isfinite(one)], other[np.isfinite(other)]))


def recorded(record: Record, belief: Belief, warmer_K: FloatArray | float = 0.0) -> FreeRun:
    """Return the record's own figures; heat by a supply that was so much warmer (n,) than was measured."""
    full = built(belief.room).full_flow_L_h if belief.room else float("nan")
    air_C = record.values[record.air_channel]
    if not record.has("flow_L_h"):
        return FreeRun(record.interval_s, air_C, np.full(len(record), np.nan), None)
    flow = record.values["flow_L_h"]
    heat_W = None
    if belief.room and record.has("return_temperature_C") and record.has("supply_temperature_C"):
        drop_K = warmer_K + record.values["supply_temperature_C"] - record.values["return_temperature_C"]
        heat_W = np.where(flow <= 0.0, 0.0, flow / 3600.0 * built(belief.room).water_J_L_K * drop_K)
    return FreeRun(record.interval_s, air_C, flow / full, heat_W)


def free_run(belief: Belief, setpoint_C: float) -> FreeRun:
    """Return the loop left to itself under the recorded inputs; raise `SimulationError`."""
    loop = loop_of(belief)
    (week,) = loop.weeks(setpoint_C, [START], trace=True)
    column = {name: week.trace[:, place] for place, name in enumerate(kernel.TRACE)}
    return FreeRun(loop.driven.step_s, column["air_C"], column["flow_fraction"], column["water_heat_W"])


def loop_of(belief: Belief) -> Loop:
    """Return the closed loop of a belief under its recorded inputs."""
    assert belief.room
    assert belief.inputs
    inputs = belief.inputs
    step_s = inputs.interval_s / max(1, round(inputs.interval_s / STEP_S))
    driven = drive(recorded_room(built(belief.room), inputs), weather_of(inputs), step_s)
    return Loop(Chain(belief.blocks, step_s), driven, limit_C=-99.0)


def _shift_K(seen: FreeRun, belief: Belief, setpoint_C: float) -> float:
    """Return the setpoint shift with which the loop has the record's mean air temperature; NaN beyond 2 K."""
    from scipy.optimize import brentq

    wanted_C = float(np.nanmean(seen.air_C))

    @cache  # the ends are asked for twice, and each is a whole run
    def off_K(shift_K: float) -> float:
        return float(np.nanmean(free_run(belief, setpoint_C + shift_K).while_seen(seen).air_C)) - wanted_C

    if off_K(-SHIFT_K) * off_K(SHIFT_K) > 0.0:
        return float("nan")
    return float(brentq(off_K, -SHIFT_K, SHIFT_K, xtol=NEAR_K))
