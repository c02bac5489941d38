"""From a continuous controller output to the binary heating signal."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

from pydantic import model_validator

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


def pulse_width(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Return the heating signal of one step; a decision is taken at the first step of each period."""
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


class Pwm(Modulator):
    """Pulse-width modulation: heat for output times period from the period's start.

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
        return pulse_width(p, x, u, t, dt)


class StandbyParameters(PwmParameters):
    signal: Literal["continuous", "switched"] = parameter(
        "continuous",
        unit="",
        description="What the controller gives: a share to be modulated as `pwm` does, or heating wherever above 0.5.",
        source="chosen: continuous PI needs the modulation, an On/Off controller switches itself",
    )
    first_pulse_s: float = parameter(
        900.0,
        unit="s",
        ge=0.0,
        le=43200.0,
        description="First standby pulse, from the end of heating; until then the valve closes undisturbed.",
        source="chosen: hold and fall time after long heating are under 7 min in Table 2",
    )
    pulse_period_s: float = parameter(
        300.0,
        unit="s",
        ge=60.0,
        le=7200.0,
        description="From the start of one standby pulse to the next.",
        source="chosen: docs/enthalpy-standby.md, often and short costs less",
    )
    pulse_s: float = parameter(
        40.0,
        unit="s",
        ge=0.0,
        le=3600.0,
        description="Length of a standby pulse; 0 is no standby.",
        source="chosen: docs/standby.md, product B opens within 300 s",
    )

    @model_validator(mode="after")
    def _rests(self) -> StandbyParameters:
        if self.pulse_s >= self.pulse_period_s:
            raise ValueError(f"pulse_s = {self.pulse_s} must be less than pulse_period_s = {self.pulse_period_s}")
        return self


@dataclass
class StandbyState(PwmState):
    off_s: float = 0.0  # since heating ended, standby pulses not counted
    next_pulse_s: float = 0.0  # on the same clock
    owed_s: float = 0.0  # of pulses that have begun; what a step rounds off is left for the next pulse


SWITCHED = 1  # index of the choice in `signal`


class Standby(Modulator):
    """Short pulses while nothing is heated, that keep the wax warm so that the valve opens sooner (section 4.1).

    Heating is that of `pwm`, or of a controller that switches itself; it always goes first, and ends the standby.
    Mean duty is kept at any step. Whether pulses open the valve depends on actuator and ambient: see docs/standby.md.
    """

    name = "standby"
    api_version = "1.0"
    Parameters = StandbyParameters
    State = StandbyState
    examples = {"continuous": {}, "switched": {"signal": "switched"}}

    @classmethod
    def start(cls, p: Any, dt: float) -> StandbyState:
        return StandbyState(next_pulse_s=p.first_pulse_s)

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        heating = u if p.signal == SWITCHED else pulse_width(p, x, u, t, dt)
        if heating > 0.5:
            x.off_s = x.owed_s = 0.0
            x.next_pulse_s = p.first_pulse_s
            return 1.0
        if x.off_s + 1e-6 * dt >= x.next_pulse_s:
            x.owed_s += p.pulse_s
            x.next_pulse_s += p.pulse_period_s
        x.off_s += dt
        if x.owed_s < 0.5 * dt:
            return 0.0
        x.owed_s -= dt
        return 1.0
