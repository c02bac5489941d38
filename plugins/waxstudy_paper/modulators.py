"""From a continuous controller output to the binary heating signal."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from waxstudy.plugin import Modulator, Parameters, Tunable, parameter


class PwmParameters(Parameters):
    period_s: float = parameter(
        3600.0,
        unit="s",
        gt=0.0,
        le=86400.0,
        description="Period; a decision is taken at the start of each.",
        source="Section 3.3: once per hour",
    )
    min_pulse_s: float = parameter(
        300.0,
        unit="s",
        ge=0.0,
        le=43200.0,
        description="Shortest pulse and shortest pause; a shorter one is left out.",
        source="chosen: figure 8 is not in the text; section 3.1.2 asks for 3 to 5 min of heating and cooling",
    )


@dataclass
class PwmState:
    period: float = -1e18
    pulse_s: float = 0.0


class Pwm(Modulator):
    """Hourly pulse-width modulation: heat for output times period from the period's start.

    A pulse shorter than `min_pulse_s` is left out; a pause shorter than that is heated through.
    """

    name = "pwm"
    api_version = "1.0"
    Parameters = PwmParameters
    State = PwmState
    period = "period_s"
    tuned = {"period_s": Tunable(900.0, 7200.0, is_log=True), "min_pulse_s": Tunable(0.0, 900.0)}

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        # the small part of a step keeps a period's start in its period in spite of rounding
        period = math.floor((t + 1e-6 * dt) / p.period_s)
        if period != x.period:
            x.period = period
            x.pulse_s = u * p.period_s
            if x.pulse_s < p.min_pulse_s:
                x.pulse_s = 0.0
            elif x.pulse_s > p.period_s - p.min_pulse_s:
                x.pulse_s = p.period_s
        into_period_s = t - period * p.period_s
        return 1.0 if into_period_s + 0.5 * dt < x.pulse_s else 0.0
