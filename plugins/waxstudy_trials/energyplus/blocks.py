"""The chain that drives the room in EnergyPlus, stage by stage in steps of ten seconds; equations of its own."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, Protocol

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy_trials.dial import turn_of
from waxstudy_trials.energyplus.description import House
from waxstudy_trials.plant.weather import PART_S, Weather

STEP_S = 10.0


class Stage(Protocol):
    """A stage with its state; `step` returns what it makes of what it gets, a step on."""

    def step(self, u: float, time_s: float) -> float: ...


def hour_of(time_s: float) -> float:
    return time_s / 3600.0 % 24.0


@dataclass
class Sensor:
    """The air some time ago or through a housing, with what is wrong with the reading."""

    house: House
    sun_W: FloatArray
    late: deque[float] = field(default_factory=deque)
    seen_C: float = math.nan
    housed_C: float = math.nan

    def step(self, u: float, time_s: float) -> float:
        house = self.house
        self.late.append(u)
        seen = self.late.popleft() if len(self.late) > round(house.delay_s / STEP_S) else self.late[0]
        self.seen_C = followed(self.seen_C, seen, house.lag_s)
        self.housed_C = followed(self.housed_C, self.seen_C, house.housing_s)
        part = min(int(time_s // PART_S), len(self.sun_W) - 1)
        return self.housed_C + house.bias_K + house.sun_K_kW * float(self.sun_W[part]) / 1000.0


def followed(last: float, value: float, time_constant_s: float) -> float:
    """Return a first-order lag a step on (implicit); it starts where its input is."""
    if time_constant_s <= 0.0 or math.isnan(last):
        return value
    return last + (value - last) * STEP_S / (time_constant_s + STEP_S)


@dataclass
class Controller:
    """On and off around the setpoint, or PI whose integral follows its limited output."""

    house: House
    setpoint_C: float
    output: float = 0.0
    integral: float = 0.0
    since_s: float = 1e6

    def step(self, u: float, time_s: float) -> float:
        house, hour = self.house, hour_of(time_s)
        is_elsewhere = (hour - house.aim_from_h) % 24.0 < (house.aim_to_h - house.aim_from_h) % 24.0
        aim_C = self.setpoint_C + is_elsewhere * house.aim_K + house.turned_K * turn_of(time_s)
        wanted = self._pi(aim_C - u) if house.is_pi else self._switch(aim_C - u)
        self.since_s += STEP_S
        is_switch = (wanted > 0.0) != (self.output > 0.0)
        if not is_switch or self.since_s >= house.lockout_s:
            self.since_s = 0.0 if is_switch else self.since_s
            self.output = wanted
        return self.output

    def _switch(self, error_K: float) -> float:
        if abs(error_K) <= 0.5 * self.house.band_K:
            return self.output
        return 1.0 if error_K > 0.0 else 0.0

    def _pi(self, error_K: float) -> float:
        """v = K e + I, y = v within 0..1, dI/dt = K e / t_i + (y - v) / t_t, one explicit step."""
        house = self.house
        wanted = house.gain_1_K * error_K + self.integral
        limited = min(1.0, max(0.0, wanted))
        rate_1_s = house.gain_1_K * error_K / house.integration_s + (limited - wanted) / house.tracking_s
        self.integral += rate_1_s * STEP_S
        return limited


@dataclass
class Modulator:
    """A pulse at the start of each period, as long as the output asks for; what is too short is left out."""

    house: House
    ends_s: float = 0.0
    period: int = -1

    def step(self, u: float, time_s: float) -> float:
        if not self.house.is_pi:
            return u
        whole_s, least_s = self.house.period_s, self.house.min_pulse_s
        period = int((time_s + 0.5) // whole_s)
        if period != self.period:
            pulse_s = u * whole_s
            pulse_s = 0.0 if pulse_s < least_s else whole_s if pulse_s > whole_s - least_s else pulse_s
            self.period, self.ends_s = period, period * whole_s + pulse_s
        return 1.0 if time_s + 0.5 * STEP_S < self.ends_s else 0.0


@dataclass
class Motor:
    """A wax motor of heat capacities, of another make than the data sheet's; or an ideal one."""

    house: House
    usual: Any = None
    weak: Any = None  # of an evening
    state: Any = None

    def __post_init__(self) -> None:
        if self.house.product:
            from waxstudy_enthalpy.motor import Enthalpy

            self.usual, self.weak = motor(self.house), motor(self.house, self.house.evening_power)
            self.state = Enthalpy.start(self.usual, STEP_S)

    def step(self, u: float, time_s: float) -> float:
        if self.state is None:
            return min(self.house.stop, u)
        from waxstudy_enthalpy.motor import Enthalpy

        p = self.weak if 17.0 <= hour_of(time_s) < 23.0 else self.usual
        return min(self.house.stop, float(Enthalpy.step(p, self.state, u, time_s, STEP_S)))


def motor(house: House, power: float = 1.0) -> Any:
    """Return the numbers of a motor, as plain ones: checked ones are slow to read."""
    from waxstudy_enthalpy.motor import Enthalpy

    p = SimpleNamespace(**Enthalpy.Parameters(product=house.product).model_dump())
    p.ambient_C = house.box_C
    p.inrush_W *= house.power * power
    p.holding_W *= house.power * power
    p.latent_J_g *= house.latent
    for name in ("cup_J_K", "body_J_K", "wax_g"):
        setattr(p, name, getattr(p, name) * house.inertia)
    return p


@dataclass
class Valve:
    """The flow over the full one: a plug with play and dirt, a curve, the pressure that others leave, the pump."""

    house: House
    others: FloatArray
    plug: float = 0.0

    def step(self, u: float, time_s: float) -> float:
        house = self.house
        if time_s % 7200.0 < house.pump_pause_s:
            return 0.0
        held = min(max(self.plug, u - house.play), u + house.play)
        self.plug = u if u <= 0.0 or u >= 1.0 else held
        part = min(int(time_s // PART_S), len(self.others) - 1)
        pressure = 1.0 + house.coupling * (0.5 - float(self.others[part]))
        return flow_fraction(house, max(self.plug, house.dirt)) * math.sqrt(pressure)


def flow_fraction(house: House, opening: float) -> float:
    """Return V / sqrt(V^2 (1 - N) + N), V = 1 - (1 - x)^k of the opening x above the lift."""
    x = max(0.0, (opening - house.lift) / (1.0 - house.lift))
    v = 1.0 - (1.0 - min(1.0, x)) ** house.curve
    v = house.seat_leak + (1.0 - house.seat_leak) * v
    return v / math.sqrt(v * v * (1.0 - house.authority) + house.authority)


def stages(house: House, setpoint_C: float, weather: Weather) -> dict[str, Stage]:
    """Return the chain at rest, by the library's names of its stages."""
    return {
        "sensor": Sensor(house, weather.sun_W),
        "controller": Controller(house, setpoint_C),
        "modulator": Modulator(house),
        "actuator": Motor(house),
        "valve": Valve(house, weather.others),
    }


class Chain:
    """The stages one after another, as EnergyPlus asks for them."""

    def __init__(self, house: House, setpoint_C: float, weather: Weather) -> None:
        self.stages = list(stages(house, setpoint_C, weather).values())

    def __call__(self, sensed_C: float, time_s: float, step_s: float) -> list[float]:
        """Return output, signal, opening and flow fraction."""
        u, values = sensed_C, []
        for stage in self.stages:
            u = stage.step(u, time_s)
            values.append(u)
        return values[1:]


class Played:
    """A recorded flow instead of a chain."""

    def __init__(self, flow_fraction: FloatArray) -> None:
        self.flow_fraction = flow_fraction

    def __call__(self, sensed_C: float, time_s: float, step_s: float) -> list[float]:
        return [0.0, 0.0, 0.0, float(self.flow_fraction[round(time_s / STEP_S)])]


def replayed(stage: Stage, given: FloatArray) -> FloatArray:
    """Return what a stage at rest makes of what it was given."""
    return np.array([stage.step(u, n * STEP_S) for n, u in enumerate(given.tolist())])
