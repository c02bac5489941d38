"""Actuators: heating signal to normalised opening.

Both real actuators share one trapezoid in continuous form: after a switch the opening pauses where it is (dead time
or hold time) and then ramps from there. `variable-times` can also run Table 2 to the letter.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

from pydantic import model_validator

from waxstudy.plugin import Actuator, Parameters, parameter

# Table 2: t = a exp(-t_in / tau) + b (dead, rise) and a (1 - exp(-t_in / tau)) + b (hold). Its b of 219(13) +- 13 s
# and 142(22) +- 21 s: B takes plus, A minus, as the text's 4 min of dead time and both full activation times say.
_COMMON = {"dead_a_s": -192.0, "dead_tau_s": 780.0, "rise_a_s": -30.0, "rise_tau_s": 1140.0}
PRODUCTS: Mapping[str, Mapping[str, float]] = {
    "A": _COMMON
    | {
        "dead_b_s": 206.0,
        "rise_b_s": 121.0,
        "hold_a_s": 195.0,
        "hold_b_s": 30.0,
        "hold_tau_s": 240.0,
        "fall_s": 180.0,
    },
    "B": _COMMON
    | {
        "dead_b_s": 232.0,
        "rise_b_s": 163.0,
        "hold_a_s": 82.0,
        "hold_b_s": 58.0,
        "hold_tau_s": 600.0,
        "fall_s": 123.0,
    },
}


def fill_from_product(data: Any, table: Mapping[str, Mapping[str, float]]) -> Any:
    """Complete a raw parameter table from its product (B if nothing at all is given)."""
    if not isinstance(data, dict):
        return data
    given = {key: value for key, value in data.items() if key in table["B"]}
    if "product" not in data and not given:
        return {"product": "B", **table["B"], **data}
    missing = [key for key in table["B"] if key not in given]
    product = data.get("product")
    if product is None and missing:
        raise ValueError(f"give `product` or all times; missing: {', '.join(missing)}")
    # an unknown product is reported by its own field; completing the rest keeps it the only problem
    return {**table.get(str(product), table["B"]), **data}


class IdealActuator(Actuator):
    """The opening is the signal."""

    name = "ideal"
    api_version = "1.0"

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return u


@dataclass
class Trapezoid:
    """State of the continuous form; it starts closed after a long pause, so that the first dead time is a long one.

    `undercooling_s` and `overheating_s` are equivalent times: an aborted pulse or pause moves them to where the
    remaining dead or hold time says the wax is.
    """

    opening: float = 0.0
    on: bool = False
    phase_s: float = 0.0  # since the last switch
    pause_s: float = 0.0  # from the last switch to the start of the ramp
    undercooling_s: float = 1e6
    overheating_s: float = 0.0


def switch_on(p: Any, x: Any) -> None:
    """Start the dead time; a hold that was running keeps what is left of it as overheating."""
    x.on = True
    if x.opening >= 1.0:
        left = x.pause_s - x.phase_s
        x.overheating_s = 0.0
        if p.hold_a_s > 0.0 and p.hold_b_s < left < p.hold_a_s + p.hold_b_s:
            x.overheating_s = -p.hold_tau_s * math.log(1.0 - (left - p.hold_b_s) / p.hold_a_s)
    cold_s = x.undercooling_s if x.opening <= 0.0 else 0.0
    x.pause_s = p.dead_a_s * math.exp(-cold_s / p.dead_tau_s) + p.dead_b_s
    x.undercooling_s = cold_s
    x.phase_s = 0.0


def switch_off(p: Any, x: Any) -> None:
    """Start the hold time; a dead time that was running keeps what is left of it as undercooling."""
    x.on = False
    if x.opening <= 0.0:
        left = x.pause_s - x.phase_s
        x.undercooling_s = 0.0
        if p.dead_a_s < 0.0 and p.dead_a_s + p.dead_b_s < left < p.dead_b_s:
            x.undercooling_s = -p.dead_tau_s * math.log((left - p.dead_b_s) / p.dead_a_s)
    hot_s = x.overheating_s if x.opening >= 1.0 else 0.0
    x.pause_s = p.hold_a_s * (1.0 - math.exp(-hot_s / p.hold_tau_s)) + p.hold_b_s
    x.overheating_s = hot_s
    x.phase_s = 0.0


def trapezoid(p: Any, x: Any, u: float, dt: float) -> float:
    """Advance the continuous form by one step; exact for a signal held over the step.

    On: pause for dead(t_uc), then rise by 1/rise(t_uc) per second; overheating counts once fully open.
    Off: pause for hold(t_oh), then fall by 1/fall per second; undercooling counts once closed.
    """
    if (u > 0.5) != x.on:
        if u > 0.5:
            switch_on(p, x)
        else:
            switch_off(p, x)
    x.phase_s += dt
    moving_s = min(dt, x.phase_s - x.pause_s)
    if x.on:
        if x.opening >= 1.0:
            x.overheating_s += dt
        elif moving_s > 0.0:
            rise_s = p.rise_a_s * math.exp(-x.undercooling_s / p.rise_tau_s) + p.rise_b_s
            beyond = x.opening + moving_s / rise_s - 1.0
            x.opening = min(1.0, 1.0 + beyond)
            x.overheating_s = max(0.0, beyond * rise_s)
    elif x.opening <= 0.0:
        x.undercooling_s += dt
    elif moving_s > 0.0:
        below = x.opening - moving_s / p.fall_s
        x.opening = max(0.0, below)
        x.undercooling_s = max(0.0, -below * p.fall_s)
    return x.opening


class VariableTimesParameters(Parameters):
    product: Literal["A", "B"] | None = parameter(
        None,
        unit="",
        description="Product whose coefficients apply where none is given; B if nothing is given.",
        source="Table 2; product B is the one in the simulations (section 3.1.5)",
    )
    form: Literal["continuous", "literal"] = parameter(
        "continuous",
        unit="",
        description="Continuous form, or Table 2 to the letter with its jumps on aborted signals.",
        source="chosen: Table 2 jumps when a ramp is interrupted",
    )
    dead_a_s: float = parameter(
        unit="s", ge=-3600.0, le=0.0, description="Dead time, coefficient a.", source="Table 2: -192(3)"
    )
    dead_b_s: float = parameter(
        unit="s",
        ge=0.0,
        le=3600.0,
        description="Dead time after long cooling, b.",
        source="Table 2: 219(13) +- 13",
    )
    dead_tau_s: float = parameter(
        unit="s", gt=0.0, le=36000.0, description="Dead time, time constant.", source="Table 2: 780, R2 0.885"
    )
    rise_a_s: float = parameter(
        unit="s", ge=-3600.0, le=0.0, description="Rise time, coefficient a.", source="Table 2: -30(3)"
    )
    rise_b_s: float = parameter(
        unit="s",
        gt=0.0,
        le=3600.0,
        description="Rise time after long cooling, b.",
        source="Table 2: 142(22) +- 21",
    )
    rise_tau_s: float = parameter(
        unit="s", gt=0.0, le=36000.0, description="Rise time, time constant.", source="Table 2: 1140"
    )
    hold_a_s: float = parameter(
        unit="s", ge=0.0, le=3600.0, description="Hold time, coefficient a.", source="Table 2: A 195(6), B 82(3)"
    )
    hold_b_s: float = parameter(
        unit="s",
        ge=0.0,
        le=3600.0,
        description="Hold time without overheating, b.",
        source="Table 2: A 30(5), B 58(2)",
    )
    hold_tau_s: float = parameter(
        unit="s", gt=0.0, le=36000.0, description="Hold time, time constant.", source="Table 2: A 240, B 600"
    )
    fall_s: float = parameter(unit="s", gt=0.0, le=3600.0, description="Fall time.", source="Table 2: A 180, B 123")

    @model_validator(mode="before")
    @classmethod
    def _complete(cls, data: Any) -> Any:
        return fill_from_product(data, PRODUCTS)

    @model_validator(mode="after")
    def _positive(self) -> VariableTimesParameters:
        if self.dead_a_s + self.dead_b_s < 0.0 or self.rise_a_s + self.rise_b_s <= 0.0:
            raise ValueError("dead_a_s + dead_b_s must not be negative and rise_a_s + rise_b_s must be positive")
        return self


@dataclass
class VariableTimesState(Trapezoid):
    """The continuous form's state and, for Table 2 to the letter, its integrators."""

    last_on_s: float = 0.0  # t_ls1
    last_off_s: float = 0.0  # t_ls0
    rise: float = 0.0  # k_rise
    fall: float = 0.0  # k_fall
    switched_off: bool = False  # t_DAT is available


LITERAL = 1  # index of the choice in `form`


def table_2(p: Any, x: Any, u: float, dt: float) -> float:
    """Advance Table 2 to the letter by one step; it jumps where a signal ends before its ramp does.

    The delayed signal s_D is the signal of the step before (5 s at the paper's step). The ramps are reset when
    they start rather than "every 3 min", and the fall ramp is 1 minus its integral, as Figure 3 needs.
    """
    on = u > 0.5
    if on and not x.on:
        x.last_on_s = x.overheating_s = x.rise = 0.0
    if x.on and not on:
        x.last_off_s = x.undercooling_s = x.fall = 0.0
        x.switched_off = True
    x.on = on
    dead_s = p.dead_a_s * math.exp(-x.undercooling_s / p.dead_tau_s) + p.dead_b_s
    rise_s = p.rise_a_s * math.exp(-x.undercooling_s / p.rise_tau_s) + p.rise_b_s
    hold_s = p.hold_a_s * (1.0 - math.exp(-x.overheating_s / p.hold_tau_s)) + p.hold_b_s
    if on:
        x.last_on_s += dt
        if x.last_on_s <= dead_s:
            return 0.0
        if x.last_on_s <= dead_s + rise_s:
            x.rise = min(1.0, x.rise + dt / rise_s)
            return x.rise
        x.overheating_s += dt
        return 1.0
    if not x.switched_off:
        return 0.0
    x.last_off_s += dt
    if x.last_off_s <= hold_s:
        return 1.0
    if x.last_off_s <= hold_s + p.fall_s:
        x.fall = min(1.0, x.fall + dt / p.fall_s)
        return 1.0 - x.fall
    x.undercooling_s += dt
    return 0.0


class VariableTimes(Actuator):
    """The paper's empirical wax actuator: characteristic times that depend on the past (Table 2, equations 1 and 2).

    Published fit: MAE of the displacement 0.011 to 0.098 over 18 records, mean 0.040 (Table A1). In the continuous
    form the first cycle starts after a long pause (Table 2 starts at t_uc = 0, which is too quick).
    """

    name = "variable-times"
    api_version = "1.0"
    # Table A1: MAE times half a cycle is 18 to 77 s in its profiles of equal cycles
    stray_s = 77.0
    Parameters = VariableTimesParameters
    State = VariableTimesState
    examples = {"product A": {"product": "A"}, "product B": {"product": "B"}}

    @classmethod
    def start(cls, p: Any, dt: float) -> VariableTimesState:
        return VariableTimesState(undercooling_s=0.0) if p.form == LITERAL else VariableTimesState()

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        if p.form == LITERAL:
            return table_2(p, x, u, dt)
        return trapezoid(p, x, u, dt)


def steady_times(product: str, on_s: float = 900.0, off_s: float = 900.0) -> dict[str, float]:
    """Return the characteristic times [s] that Table 2 reaches in a steady on-off profile, rounded to a second.

    >>> steady_times("B")
    {'dead_time_s': 150.0, 'rise_time_s': 146.0, 'hold_time_s': 110.0, 'fall_time_s': 123.0}
    """
    p = PRODUCTS[product]
    cold_s = off_s
    for _ in range(50):
        dead = p["dead_a_s"] * math.exp(-cold_s / p["dead_tau_s"]) + p["dead_b_s"]
        rise = p["rise_a_s"] * math.exp(-cold_s / p["rise_tau_s"]) + p["rise_b_s"]
        hot_s = max(0.0, on_s - dead - rise)
        hold = p["hold_a_s"] * (1.0 - math.exp(-hot_s / p["hold_tau_s"])) + p["hold_b_s"]
        cold_s = max(0.0, off_s - hold - p["fall_s"])
    times = {"dead_time_s": dead, "rise_time_s": rise, "hold_time_s": hold, "fall_time_s": p["fall_s"]}
    return {name: float(round(value)) for name, value in times.items()}


_STEADY = "chosen: Table 2 in the steady 15-15 min profile; the constants of Kull et al. (2021) are not in the paper"


class ConstantTimesParameters(Parameters):
    product: Literal["A", "B"] | None = parameter(
        None,
        unit="",
        description="Product whose times apply where none is given; B if nothing is given.",
        source=_STEADY,
    )
    dead_time_s: float = parameter(
        unit="s", ge=0.0, le=3600.0, description="From signal on to the first movement.", source=_STEADY
    )
    rise_time_s: float = parameter(
        unit="s", gt=0.0, le=3600.0, description="From first movement to fully open.", source=_STEADY
    )
    hold_time_s: float = parameter(
        unit="s", ge=0.0, le=3600.0, description="From signal off to the first movement.", source=_STEADY
    )
    fall_time_s: float = parameter(
        unit="s", gt=0.0, le=3600.0, description="From first movement to closed.", source=_STEADY
    )

    @model_validator(mode="before")
    @classmethod
    def _complete(cls, data: Any) -> Any:
        return fill_from_product(data, {product: steady_times(product) for product in PRODUCTS})


@dataclass
class ConstantTimesState:
    opening: float = 0.0
    on: bool = False
    phase_s: float = 0.0


class ConstantTimes(Actuator):
    """The characteristic model with constant times (Figure 3; Kull, Thalfeldt and Kurnitski 2021).

    After a switch the opening pauses where it is and then ramps from there.
    """

    name = "constant-times"
    api_version = "1.0"
    stray_s = 77.0  # at least that of the model with more detail
    Parameters = ConstantTimesParameters
    State = ConstantTimesState
    examples = {"product A": {"product": "A"}, "product B": {"product": "B"}}

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        if (u > 0.5) != x.on:
            x.on = u > 0.5
            x.phase_s = 0.0
        x.phase_s += dt
        if x.on:
            moving_s = max(0.0, min(dt, x.phase_s - p.dead_time_s))
            x.opening = min(1.0, x.opening + moving_s / p.rise_time_s)
        else:
            moving_s = max(0.0, min(dt, x.phase_s - p.hold_time_s))
            x.opening = max(0.0, x.opening - moving_s / p.fall_time_s)
        return x.opening
