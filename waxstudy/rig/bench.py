"""One record of the bench: a motor with a pace of its own, heated as the programme says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from zlib import crc32

import numpy as np

from waxstudy.plugin import Choice, FloatArray
from waxstudy.plugin.registry import installed
from waxstudy.rig.instruments import Bench, displacement_mm, flow_L_h, voltage_V
from waxstudy.rig.programme import Trial
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.replay import replay

STEP_S = 0.5  # of the simulation; a switch lies within half of it
WARM_S = 3600.0  # heated before the record
REST_S = (900.0, 20_000.0)  # then left alone, so that nobody knows how cold the first cycle begins
LEAD_S = (60.0, 300.0)  # from the first sample to the first heating
GAP_S = 300.0  # mean length


@dataclass(frozen=True)
class Motors:
    """What stands on the bench: an actuator by name with parameters, the valve of the flow circuit, and the seed."""

    actuator: str
    values: Mapping[str, Any]
    valve: str
    bench: Bench
    seed: int

    def actuator_of(self, product: str) -> Choice:
        """Return the actuator of a product; one without products is the same for all. Raises `ValueError`."""
        component = installed().get("actuator", self.actuator)
        own = {"product": product} if "product" in component.Parameters.model_fields else {}
        return Choice.of(component, own | dict(self.values))

    def valve_of(self) -> Choice:
        return Choice.of(installed().get("valve", self.valve), {})

    def random(self, *purpose: str) -> np.random.Generator:
        """Return random numbers of their own for each purpose, whatever else is drawn."""
        return np.random.default_rng([self.seed, crc32("/".join(purpose).encode())])

    def exemplar_pace(self, trial: Trial) -> float:
        """Return the factor on all times of an exemplar."""
        draw = self.random("exemplar", trial.product, trial.exemplar)
        return float(np.exp(self.bench.exemplar_scatter * draw.normal()))

    def record_pace(self, trial: Trial) -> float:
        return float(np.exp(self.bench.record_scatter * self.random("record", trial.name).normal()))


@dataclass(frozen=True)
class Recorded:
    """What a trial gave: samples, and the true opening at them."""

    trial: Trial
    time_s: FloatArray
    signal_V: FloatArray
    value: FloatArray  # displacement [mm] or flow [L/h]
    opening: FloatArray  # true, 0..1
    pace: Mapping[str, float]  # factors on the times: exemplar's, record's


def run_trial(motors: Motors, trial: Trial) -> Recorded:
    """Return one record; raise `ValueError` or `SimulationError`."""
    bench, draw = motors.bench, motors.random("trial", trial.name)
    pace = {"exemplar": motors.exemplar_pace(trial), "record": motors.record_pace(trial)}
    interval_s = bench.interval_s if trial.measured == "displacement" else bench.flow_interval_s
    switches_s = np.cumsum(np.concatenate(([draw.uniform(*LEAD_S)], trial.lengths_s(draw))))
    past_s = np.array([-WARM_S, 0.0]) - draw.uniform(*REST_S)
    edges_s = np.concatenate((past_s, switches_s))
    time_s: FloatArray = interval_s * np.arange(1.0, int(60.0 * trial.duration_min / interval_s) + 1.0)
    scatter = np.exp(bench.cycle_scatter * draw.normal(size=len(edges_s)))
    own_s = np.concatenate(([0.0], np.cumsum(np.diff(edges_s) / (pace["exemplar"] * pace["record"] * scatter[:-1]))))
    on = (np.searchsorted(edges_s, time_s, side="right") % 2).astype(float)
    outputs = _driven(motors, trial, own_s, np.interp(time_s, edges_s, own_s))
    if trial.measured == "flow":
        value = flow_L_h(outputs["valve"], bench, draw)
    else:
        stroke_mm = bench.stroke_mm * (bench.valve_stroke if trial.has_valve else 1.0)
        value = displacement_mm(outputs["actuator"], stroke_mm, bench, draw)
    value = np.where(_lost(len(value), interval_s, bench, draw), np.nan, value)
    return Recorded(trial, time_s, voltage_V(on, bench, draw), value, outputs["actuator"], pace)


def _driven(motors: Motors, trial: Trial, switches_s: FloatArray, sampled_s: FloatArray) -> dict[str, FloatArray]:
    """Return opening and, of a flow record, mean flow at the samples; all times are the motor's own, first on at 0.

    A motor whose times are all longer by a factor is the same motor with time running slower.
    """
    blocks = {"actuator": motors.actuator_of(trial.product)}
    if trial.measured == "flow":
        blocks["valve"] = motors.valve_of()
    count = int(np.ceil(sampled_s[-1] / STEP_S)) + 1
    ends_s: FloatArray = STEP_S * np.arange(1.0, count + 1.0)
    on = (np.searchsorted(switches_s, ends_s - 0.5 * STEP_S, side="right") % 2).astype(float)
    still = np.zeros(count)
    ends, _ = replay(Chain(blocks, STEP_S), "actuator", on, still, interval_s=STEP_S, start_s=0.0, jump=still)
    opening = np.interp(sampled_s, ends_s, ends["actuator"])
    return {"actuator": opening, "valve": _means(sampled_s, ends_s, ends["valve"])}


def _means(sampled_s: FloatArray, ends_s: FloatArray, values: FloatArray) -> FloatArray:
    """Return the mean of a value over the interval before each sample."""
    total = np.concatenate(([0.0], np.cumsum(values * STEP_S)))
    at = np.interp(sampled_s, np.concatenate(([0.0], ends_s)), total)
    length_s = np.diff(sampled_s, prepend=2.0 * sampled_s[0] - sampled_s[1])
    before = np.interp(sampled_s - length_s, np.concatenate(([0.0], ends_s)), total)
    return (at - before) / length_s


def _lost(count: int, interval_s: float, bench: Bench, draw: np.random.Generator) -> np.ndarray:
    """Return which samples are lost in gaps."""
    lost = np.zeros(count, dtype=bool)
    for start in np.flatnonzero(draw.random(count) < bench.gaps_per_day * interval_s / 86_400.0):
        lost[start : start + int(draw.exponential(GAP_S) / interval_s) + 1] = True
    return lost
