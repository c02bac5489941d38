"""Families of the logger: everything happens as believed, and is written down otherwise."""

from __future__ import annotations

from typing import Any

import numpy as np

from waxstudy.plugin import Belief, FloatArray, Prior
from waxstudy_trials.family import Channels, Family, one

METER = ("flow_L_h", "supply_C", "return_C")  # the heat meter's own logger


class LoggerFamily(Family):
    """A family that changes nothing but the record."""

    is_logger = True

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief


class DriftingClock(LoggerFamily):
    """The clock of the heat meter runs away from that of the room's logger."""

    name = "drifting-clock"
    stage = "valve"
    stages = ("valve", "emitter", "room", "actuator")
    Parameters = one("drift_s_d", 0.0, "s/d", "How much later a day its stamps are.", -600.0, 600.0)
    priors = {"drift_s_d": Prior(-400.0, 400.0, noticeable=10.0)}

    @classmethod
    def log(cls, p: Any, channels: Channels, step_s: float) -> dict[str, FloatArray]:
        count = len(channels["air_C"])
        at = np.arange(count)
        from_place = at - p.drift_s_d * at / 86_400.0
        places = np.clip(np.rint(from_place).astype(int), 0, count - 1)
        return {name: channels[name][places] for name in METER}


class SlowLogger(LoggerFamily):
    """The logger writes the displacement as its mean over the last minutes."""

    name = "slow-logger"
    stage = "actuator"
    stages = ("actuator", "valve")
    is_kept = True
    Parameters = one("window_s", 0.0, "s", "Length of the mean.", 0.0, 3600.0)
    priors = {"window_s": Prior(0.0, 2400.0, noticeable=60.0)}

    @classmethod
    def log(cls, p: Any, channels: Channels, step_s: float) -> dict[str, FloatArray]:
        width = max(1, round(p.window_s / step_s))
        whole = np.concatenate(([0.0], np.cumsum(channels["opening"])))
        at = np.arange(1, len(whole))
        first = np.maximum(at - width, 0)
        return {"opening": np.clip((whole[at] - whole[first]) / (at - first), 0.0, 1.0)}


class CoarseMeter(LoggerFamily):
    """The meter gives one pulse for some litres, and the logger writes pulses as flow."""

    name = "coarse-meter"
    stage = "valve"
    stages = ("valve", "actuator")
    is_kept = True
    Parameters = one("pulse_L", 0.0, "L", "Volume of a pulse.", 0.0, 20.0)
    priors = {"pulse_L": Prior(0.0, 10.0, noticeable=0.2)}

    @classmethod
    def log(cls, p: Any, channels: Channels, step_s: float) -> dict[str, FloatArray]:
        if p.pulse_L == 0.0:
            return {}
        volume_L = np.cumsum(channels["flow_L_h"]) * step_s / 3600.0
        # a pulse's volume is written over the minute in which it came
        minute = max(1, round(60.0 / step_s))
        pulses = np.floor(volume_L / p.pulse_L)
        per_step = np.diff(pulses, prepend=0.0)
        starts = np.arange(len(per_step)) // minute
        counted = np.bincount(starts, weights=per_step)[starts]
        return {"flow_L_h": counted * p.pulse_L / (minute * step_s) * 3600.0}
