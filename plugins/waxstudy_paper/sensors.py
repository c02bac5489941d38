"""Room temperature sensors."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from waxstudy.plugin import Parameters, Ring, Sensor, delayed, parameter


class IdealSensor(Sensor):
    """The reading is the temperature itself."""

    name = "ideal"
    api_version = "1.0"

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return u


class DelayParameters(Parameters):
    delay_s: float = parameter(
        120.0,
        unit="s",
        ge=0.0,
        le=7200.0,
        description="Dead time of the reading.",
        source="Section 3.3, t_D = 2 min",
    )


@dataclass
class DelayState:
    readings: Ring = field(default_factory=lambda: Ring(0))


class DelaySensor(Sensor):
    """The reading is the temperature of `delay_s` ago, rounded to whole steps."""

    name = "delay"
    api_version = "1.0"
    Parameters = DelayParameters
    State = DelayState

    @classmethod
    def start(cls, p: Any, dt: float) -> DelayState:
        return DelayState(Ring(round(p.delay_s / dt)))

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return delayed(x.readings, u)


class LagParameters(Parameters):
    time_constant_s: float = parameter(
        120.0,
        unit="s",
        ge=0.0,
        le=7200.0,
        description="Time constant of the first-order lag.",
        source="chosen: as long as the delay of section 3.3, for comparison; the paper has no lag",
    )


@dataclass
class LagState:
    reading_C: float = 0.0
    started: bool = False


class LagSensor(Sensor):
    """The reading follows the temperature as a first-order lag, exact for an input held over the step."""

    name = "lag"
    api_version = "1.0"
    Parameters = LagParameters
    State = LagState

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        if not x.started or p.time_constant_s == 0.0:
            x.started = True
            x.reading_C = u
        else:
            x.reading_C += (u - x.reading_C) * (1.0 - math.exp(-dt / p.time_constant_s))
        return x.reading_C
