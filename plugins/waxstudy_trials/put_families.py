"""Families of faults outside the library that every engine of its own equations can put in, by names of its numbers."""

from __future__ import annotations

from waxstudy_trials.dial import RESTLESS_DIAL
from waxstudy_trials.family_logger import CoarseMeter, DriftingClock, SlowLogger
from waxstudy_trials.put import Range, as_it_is, family, logger

OF_CHAIN = (
    family("sunlit-sensor", ("sensor", "controller"), as_it_is("sun_K_kW", "K_kW"), K_kW=Range(0.3, 12.0)),
    family("lockout", ("controller", "modulator"), as_it_is("lockout_s", "hold_s"), hold_s=Range(1800.0, 43_200.0)),
    RESTLESS_DIAL,
    family(
        "weak-at-night",
        ("actuator", "valve"),
        lambda numbers, v: {"evening_power": 1.0 - v["less"]},
        True,
        less=Range(0.05, 0.6),
    ),
    family("sticking-valve", ("valve", "actuator"), as_it_is("play", "play"), play=Range(0.01, 0.4)),
    family(
        "pump-pauses",
        ("valve", "emitter", "actuator"),
        as_it_is("pump_pause_s", "pause_s"),
        pause_s=Range(30.0, 2400.0),
    ),
)
OF_ROOM = (
    family("stove", ("room", "emitter"), as_it_is("stove_W", "heat_W"), heat_W=Range(10.0, 1000.0)),
    family("windy-leak", ("room", "emitter"), as_it_is("gust", "share"), True, share=Range(2.0, 120.0)),
    logger(DriftingClock, drift_s_d=Range(5.0, 300.0, is_signed=True)),
    logger(SlowLogger, window_s=Range(30.0, 2400.0)),
    logger(CoarseMeter, pulse_L=Range(0.2, 10.0)),
)
