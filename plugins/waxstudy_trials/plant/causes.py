"""What is put into a plant: changes of its own numbers, effects of the library and families outside it.

Values carry the library's names where they mean the same there, and names of their own where they do not.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.plugin.trial import Cause
from waxstudy_trials.family import Family
from waxstudy_trials.family_logger import CoarseMeter, DriftingClock, SlowLogger
from waxstudy_trials.plant.description import Plant

Values = Mapping[str, float]
DIGITS = 5


@dataclass(frozen=True)
class Range:
    """Where a value is drawn from: log-uniform from low to high, as a factor to either side, or with either sign."""

    low: float
    high: float
    is_signed: bool = False
    is_factor: bool = False  # low and high are of how far it is from 1
    is_even: bool = False  # drawn evenly

    def drawn(self, random: np.random.Generator) -> float:
        if self.is_even:
            return _rounded(float(random.uniform(self.low, self.high)))
        size = float(np.exp(random.uniform(np.log(self.low), np.log(self.high))))
        sign = 1.0 if random.random() < 0.5 else -1.0
        if self.is_factor:
            return _rounded((1.0 + size) ** (sign if self.is_signed else 1.0))
        return _rounded(sign * size if self.is_signed else size)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


@dataclass(frozen=True)
class Put:
    """A cause with the ranges of its values and what they change; `logger` stands for a family of the logger."""

    cause: Cause
    ranges: Mapping[str, Range]
    change: Callable[[Plant, Values], dict[str, float]]
    logger: type[Family] | None = None

    def drawn(self, random: np.random.Generator) -> dict[str, float]:
        return {name: each.drawn(random) for name, each in self.ranges.items()}

    def edited(self, plant: Plant, values: Values) -> Plant:
        return plant._replace(**self.change(plant, values))


def _effect(name: str, stage: str, change: Callable[[Plant, Values], dict[str, float]], **ranges: Range) -> Put:
    return Put(Cause(name, (stage,)), ranges, change)


def _as_it_is(own: str, name: str) -> Callable[[Plant, Values], dict[str, float]]:
    """Return the change of one number of the plant to a value."""
    return lambda plant, values: {own: values[name]}


EFFECTS = (
    _effect("sensor-lag", "sensor", _as_it_is("housing_s", "time_constant_s"), time_constant_s=Range(15.0, 2400.0)),
    _effect("sensor-bias", "sensor", _as_it_is("bias_K", "bias_K"), bias_K=Range(0.02, 2.0, is_signed=True)),
    _effect(
        "dead-band",
        "controller",
        lambda plant, v: {"band_K": max(0.05, plant.band_K + v["wider_K"])},
        wider_K=Range(0.04, 1.5),
    ),
    _effect("slow-actuator", "actuator", _as_it_is("inertia", "factor"), factor=Range(0.05, 3.0, is_factor=True)),
    _effect(
        "limited-travel",
        "actuator",
        lambda plant, v: {"stop": 1.0 - v["short_of_open"]},
        short_of_open=Range(0.02, 0.8),
    ),
    _effect("let-by", "valve", _as_it_is("seat_leak", "leak"), leak=Range(0.0005, 0.08)),
    _effect("stuck-open", "valve", lambda plant, v: {"dirt": plant.lift + v["lifted"]}, lifted=Range(0.002, 0.2)),
    _effect(
        "max-flow",
        "valve",
        lambda plant, v: {"full_flow_L_h": plant.full_flow_L_h * v["factor"]},
        factor=Range(0.03, 1.2, is_signed=True, is_factor=True),
    ),
    _effect(
        "low-authority",
        "valve",
        lambda plant, v: {"authority": min(1.0, plant.authority * v["pressure"])},
        pressure=Range(0.3, 9.0, is_signed=True, is_factor=True),
    ),
    _effect("supply-offset", "emitter", _as_it_is("supply_K", "offset_K"), offset_K=Range(0.1, 6.0, is_signed=True)),
    _effect("pipe-delay", "emitter", _as_it_is("pipe_L", "volume_L"), volume_L=Range(0.3, 15.0)),
    _effect("floor-cover", "emitter", _as_it_is("cover_m2K_W", "resistance_m2K_W"), resistance_m2K_W=Range(0.004, 0.3)),
    _effect(
        "infiltration",
        "room",
        lambda plant, v: {"leak_L_s": plant.leak_L_s * v["factor"]},
        factor=Range(0.5, 30.0, is_factor=True),
    ),
    _effect(
        "window-opening",
        "room",
        lambda plant, v: {
            "window_L_s": v["flow_L_s"],
            "window_from_h": v["from_h"],
            "window_to_h": (v["from_h"] + v["hours"]) % 24.0,
        },
        flow_L_s=Range(0.5, 60.0),
        from_h=Range(0.0, 24.0, is_even=True),
        hours=Range(0.5, 3.0),
    ),
    _effect(
        "solar-factor",
        "room",
        lambda plant, v: {"sun": plant.sun * v["factor"]},
        factor=Range(0.1, 2.5, is_signed=True, is_factor=True),
    ),
    _effect("thermal-mass", "room", _as_it_is("mass", "factor"), factor=Range(0.1, 3.0, is_factor=True)),
    _effect("neighbour-heat", "room", _as_it_is("neighbour_W_K", "conductance_W_K"), conductance_W_K=Range(0.5, 30.0)),
)


def _family(
    name: str,
    stages: Sequence[str],
    change: Callable[[Plant, Values], dict[str, float]],
    is_kept: bool = False,
    **ranges: Range,
) -> Put:
    return Put(Cause(name, tuple(stages), is_family=True, is_kept=is_kept), ranges, change)


def _logger(family: type[Family], **ranges: Range) -> Put:
    return Put(family.cause(), ranges, lambda plant, values: {}, family)


FAMILIES = (
    _family("sunlit-sensor", ("sensor", "controller"), _as_it_is("sun_K_kW", "K_kW"), K_kW=Range(0.3, 12.0)),
    _family("lockout", ("controller", "modulator"), _as_it_is("lockout_s", "hold_s"), hold_s=Range(1800.0, 43_200.0)),
    _family("night-setback", ("controller", "sensor"), _as_it_is("setback_K", "drop_K"), True, drop_K=Range(0.05, 2.5)),
    _family(
        "weak-at-night",
        ("actuator", "valve"),
        lambda plant, v: {"evening_power": 1.0 - v["less"]},
        True,
        less=Range(0.05, 0.6),
    ),
    _family("sticking-valve", ("valve", "actuator"), _as_it_is("play", "play"), play=Range(0.01, 0.4)),
    _family(
        "pump-pauses",
        ("valve", "emitter", "actuator"),
        _as_it_is("pump_pause_s", "pause_s"),
        pause_s=Range(30.0, 2400.0),
    ),
    _family(
        "air-lock", ("emitter", "room"), lambda plant, v: {"air_lock": 1.0 - v["less"]}, True, less=Range(0.05, 0.9)
    ),
    _family("stove", ("room", "emitter"), _as_it_is("stove_W", "heat_W"), heat_W=Range(10.0, 1000.0)),
    _family("windy-leak", ("room", "emitter"), _as_it_is("gust", "share"), True, share=Range(2.0, 120.0)),
    _logger(DriftingClock, drift_s_d=Range(5.0, 300.0, is_signed=True)),
    _logger(SlowLogger, window_s=Range(30.0, 2400.0)),
    _logger(CoarseMeter, pulse_L=Range(0.2, 10.0)),
)
PUTS: Mapping[str, Put] = {put.cause.name: put for put in (*EFFECTS, *FAMILIES)}
