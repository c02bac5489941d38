"""Room temperature controllers; their input is the control error, setpoint minus reading [K]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from waxstudy.plugin import Controller, Parameters, Tunable, parameter


class OnOffParameters(Parameters):
    dead_band_K: float = parameter(
        2.0,
        unit="K",
        ge=0.0,
        le=20.0,
        description="Full width of the dead band, half above and half below the setpoint.",
        source="Table 4, T_Db (2 K by default, 0.5 K adapted); full width is our reading",
    )


@dataclass
class OnOffState:
    on: bool = False


class OnOff(Controller):
    """Heat below the dead band, stop above it, keep on inside it."""

    name = "on-off"
    api_version = "1.0"
    Parameters = OnOffParameters
    State = OnOffState
    tuned = {"dead_band_K": Tunable(0.05, 2.0, is_log=True)}

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        if u > 0.5 * p.dead_band_K:
            x.on = True
        elif u < -0.5 * p.dead_band_K:
            x.on = False
        return 1.0 if x.on else 0.0


class PIParameters(Parameters):
    gain: float = parameter(
        0.3,
        unit="1/K",
        gt=0.0,
        le=1000.0,
        description="Proportional gain K.",
        source="Table 4 (0.3 by default, 18 adapted)",
    )
    integration_time_s: float = parameter(
        300.0,
        unit="s",
        gt=0.0,
        le=1e6,
        description="Integration time t_i.",
        source="Table 4 (300 s by default, 2300 s adapted)",
    )
    tracking_time_s: float = parameter(
        30.0,
        unit="s",
        gt=0.0,
        le=1e6,
        description="Tracking time t_t of the anti-windup.",
        source="Table 4",
    )


@dataclass
class PIState:
    integral: float = 0.0


class PI(Controller):
    """PI with tracking anti-windup: v = K e + I, y = min(1, max(0, v)), dI/dt = K e / t_i + (y - v) / t_t.

    Table 4 gives K, t_i and t_t; the equation is the usual one for these three names. The integral is stepped
    explicitly, the tracking term implicitly, so that steps longer than t_t stay stable.
    """

    name = "pi"
    api_version = "1.0"
    Parameters = PIParameters
    State = PIState
    gain, integration_time = "gain", "integration_time_s"
    # to both sides of Table 4: its gain of 18 is beyond what a loop with a wax motor can bear
    tuned = {"gain": Tunable(0.1, 30.0, is_log=True), "integration_time_s": Tunable(300.0, 30_000.0, is_log=True)}
    examples = {
        "default": {},
        "Table 4, adapted": {"gain": 18.0, "integration_time_s": 2300.0, "tracking_time_s": 30.0},
    }

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        unlimited = p.gain * u + x.integral
        output = min(1.0, max(0.0, unlimited))
        tracking = (output - unlimited) * (dt / (p.tracking_time_s + dt))  # this division need not wait for the state
        x.integral += p.gain * u * dt / p.integration_time_s + tracking
        return output
