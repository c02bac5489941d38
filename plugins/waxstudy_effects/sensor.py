"""What a real sensor does that is not believed: it answers late, slowly, or is off."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from operator import add
from typing import Any

from waxstudy.plugin import Belief, Choice, Effect, Parameters, Prior, parameter
from waxstudy_effects.wrapping import believed, wrapped
from waxstudy_paper.sensors import DelaySensor, IdealSensor

COLDEST_C, WARMEST_C = -100.0, 150.0  # of a reading


def sensor_of(belief: Belief) -> Choice:
    """Return the believed sensor; none is an ideal one."""
    return belief.blocks.get("sensor", Choice(IdealSensor, IdealSensor.Parameters()))


class SensorDelayParameters(Parameters):
    delay_s: float = parameter(
        120.0, unit="s", ge=0.0, le=7200.0, description="Dead time of the reading.", source="section 3.3: 2 min"
    )


class SensorDelay(Effect):
    """The reading is the temperature of `delay_s` ago, with the sensor `delay` in place of the believed one.

    A sampled or radio sensor that reports every n minutes is late by n / 2 on average. Neutral is the believed delay,
    0 of an ideal sensor; any other sensor would be replaced, which nothing undoes.
    """

    name = "sensor-delay"
    api_version = "1.0"
    stage = "sensor"
    replaces = True
    Parameters = SensorDelayParameters
    priors = {"delay_s": Prior(0.0, 1800.0, noticeable=15.0)}

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        if belief.has("sensor", "delay_s"):
            return {"delay_s": belief.value("sensor", "delay_s")}
        return {"delay_s": 0.0} if sensor_of(belief).component is IdealSensor else None

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        if belief.has("sensor", "delay_s"):
            return belief.changed("sensor", delay_s=p.delay_s)
        return belief.with_block("sensor", Choice.of(DelaySensor, {"delay_s": p.delay_s}))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"The controller reads the temperature of {p.delay_s:.0f} s ago."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"delay_s": delay_s} for delay_s in (60.0, 240.0, 600.0)]


class SensorLagParameters(Parameters):
    time_constant_s: float = parameter(
        0.0,
        unit="s",
        ge=0.0,
        le=7200.0,
        description="Time constant of a first-order lag after the believed sensor.",
        source="chosen: a sensor in a plastic housing has 5 to 20 min in still air",
    )


@dataclass
class Lag:
    lag_reading_C: float = 0.0
    lag_share: float = 0.0  # of the way that is gone in a step
    lag_is_started: bool = False


def lagging(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Follow the believed reading, exact for a reading held over the step."""
    reading_C = believed(p, x, u, t, dt)
    if not x.lag_is_started or p.sensor_lag_time_constant_s == 0.0:
        x.lag_is_started = True
        x.lag_reading_C = reading_C
        if p.sensor_lag_time_constant_s > 0.0:
            x.lag_share = 1.0 - math.exp(-dt / p.sensor_lag_time_constant_s)
    else:
        x.lag_reading_C += (reading_C - x.lag_reading_C) * x.lag_share
    return x.lag_reading_C


class SensorLag(Effect):
    """The reading follows the believed sensor's as a first-order lag, in series: tau dy/dt = x - y."""

    name = "sensor-lag"
    api_version = "1.0"
    stage = "sensor"
    Parameters = SensorLagParameters
    priors = {"time_constant_s": Prior(0.0, 3600.0, noticeable=20.0)}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("sensor", wrapped(sensor_of(belief), cls, p, lagging, memory=Lag, both=add))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"The sensor is sluggish: its reading follows with a time constant of {p.time_constant_s:.0f} s."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"time_constant_s": time_s} for time_s in (120.0, 900.0)]


class SensorBiasParameters(Parameters):
    bias_K: float = parameter(
        0.0,
        unit="K",
        ge=-10.0,
        le=10.0,
        description="What is added to the reading; above 0 the sensor reads too warm and the room stays too cold.",
        source="chosen: thermostats on cold or sunny walls",
    )


def biased(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Add the bias to the believed reading, within what a reading can be."""
    return min(WARMEST_C, max(COLDEST_C, believed(p, x, u, t, dt) + p.sensor_bias_bias_K))


class SensorBias(Effect):
    """The reading is the believed one plus `bias_K`."""

    name = "sensor-bias"
    api_version = "1.0"
    stage = "sensor"
    Parameters = SensorBiasParameters
    priors = {"bias_K": Prior(-3.0, 3.0, noticeable=0.05, as_built=0.2)}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("sensor", wrapped(sensor_of(belief), cls, p, biased, both=add))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"The sensor reads {abs(p.bias_K):.2f} K too {'warm' if p.bias_K > 0.0 else 'cold'}."
