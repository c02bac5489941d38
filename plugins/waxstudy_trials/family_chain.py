"""Families in the control chain: what sensors, controllers, buses, actuators and valves do besides."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from waxstudy.plugin import Belief, Choice, Modulator, Parameters, Prior, parameter
from waxstudy_effects.sensor import sensor_of
from waxstudy_effects.valve import valve_of
from waxstudy_effects.wrapping import believed, wrapped
from waxstudy_trials.family import Family, one


def sunlit(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Add warmth in the afternoon, as a half sine from 13 to 17 h."""
    hour = t / 3600.0 % 24.0
    warmer_K = p.sunlit_sensor_peak_K * (1.0 - ((hour - 15.0) / 2.0) ** 2) if 13.0 < hour < 17.0 else 0.0
    return believed(p, x, u, t, dt) + warmer_K


class SunlitSensor(Family):
    """The afternoon sun falls on the thermostat."""

    name = "sunlit-sensor"
    stage = "sensor"
    stages = ("sensor", "controller")
    Parameters = one("peak_K", 0.0, "K", "How much too warm it reads at 15 h.", 0.0, 8.0)
    priors = {"peak_K": Prior(0.0, 5.0, noticeable=0.1)}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("sensor", wrapped(sensor_of(belief), cls, p, sunlit))


def wandering(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Add a bias that grows from day to day."""
    return believed(p, x, u, t, dt) + p.wandering_sensor_rate_K_d * max(0.0, t) / 86_400.0


class WanderingSensor(Family):
    """The sensor's reading drifts away, a little every day."""

    name = "wandering-sensor"
    stage = "sensor"
    stages = ("sensor", "controller")
    is_kept = True
    Parameters = one("rate_K_d", 0.0, "K/d", "Drift a day.", -0.5, 0.5)
    priors = {"rate_K_d": Prior(-0.3, 0.3, noticeable=0.01)}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("sensor", wrapped(sensor_of(belief), cls, p, wandering))


@dataclass
class Held:
    lockout_output: float = -1.0
    lockout_since_s: float = 0.0


def locked(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Keep an output for a while once it has switched between off and on."""
    wanted = believed(p, x, u, t, dt)
    x.lockout_since_s += dt
    is_switch = (wanted > 0.0) != (x.lockout_output > 0.0)
    if x.lockout_output < 0.0:
        x.lockout_output = wanted
    elif is_switch and x.lockout_since_s >= p.lockout_hold_s:
        x.lockout_output = wanted
        x.lockout_since_s = 0.0
    elif not is_switch:
        x.lockout_output = wanted
    return x.lockout_output


class Lockout(Family):
    """The controller does not switch again within some minutes of its last switch."""

    name = "lockout"
    stage = "controller"
    stages = ("controller", "modulator")
    Parameters = one("hold_s", 0.0, "s", "Least time between two switches.", 0.0, 14_400.0)
    priors = {"hold_s": Prior(0.0, 10_800.0, noticeable=300.0)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return "" if "controller" in belief.blocks else "no controller is believed"

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("controller", wrapped(belief.blocks["controller"], cls, p, locked, memory=Held))


class PollParameters(Parameters):
    poll_s: float = parameter(
        0.0, unit="s", description="Time between two looks at the output.", source="chosen", ge=0.0, le=7200.0
    )


@dataclass
class LastSeen:
    seen: float = -1.0
    since_s: float = 0.0


class Polled(Modulator):
    """The output as a bus passes it on: looked at from time to time, and held."""

    name = "polled-bus"
    api_version = "1.0"
    Parameters = PollParameters
    State = LastSeen

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        x.since_s += dt
        if x.seen < 0.0 or x.since_s >= p.poll_s:
            x.seen = u
            x.since_s = 0.0
        return x.seen


class PolledBus(Family):
    """A bus passes the controller's output on at long intervals only."""

    name = "polled-bus"
    stage = "modulator"
    stages = ("modulator", "controller", "actuator")
    is_kept = True
    Parameters = PollParameters
    priors = {"poll_s": Prior(0.0, 5400.0, noticeable=60.0)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return "there is a modulator already" if "modulator" in belief.blocks else ""

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("modulator", Choice.of(Polled, dict(p)))


def weak(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Live more slowly from 17 to 23 h."""
    hour = t / 3600.0 % 24.0
    return believed(p, x, u, t, dt / p.weak_at_night_factor if 17.0 <= hour < 23.0 else dt)


class WeakAtNight(Family):
    """Of an evening the voltage sags, and the actuator is slower than by day."""

    name = "weak-at-night"
    stage = "actuator"
    stages = ("actuator", "valve")
    is_kept = True
    Parameters = one("factor", 1.0, "1", "Factor on the actuator's times from 17 to 23 h.", 1.0, 20.0)
    priors = {"factor": Prior(1.0, 12.0, noticeable=1.3, is_log=True)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        choice = belief.blocks.get("actuator")
        is_real = choice is not None and choice.component.name != "ideal"
        return "" if is_real else "no real actuator is believed"

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("actuator", wrapped(belief.blocks["actuator"], cls, p, weak))


@dataclass
class Seat:
    sticking_valve_closed_s: float = 0.0
    sticking_valve_pushed_s: float = 0.0


def sticking(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Keep the plug on its seat for a while, after it has lain there for two hours."""
    if u <= 0.0:
        x.sticking_valve_closed_s += dt
        x.sticking_valve_pushed_s = 0.0
        return believed(p, x, u, t, dt)
    x.sticking_valve_pushed_s += dt
    if x.sticking_valve_closed_s >= 7200.0 and x.sticking_valve_pushed_s < p.sticking_valve_stuck_s:
        return believed(p, x, 0.0, t, dt)
    x.sticking_valve_closed_s = 0.0
    return believed(p, x, u, t, dt)


class StickingValve(Family):
    """After a long pause the plug sticks to its seat, and comes loose some minutes after the stem has gone."""

    name = "sticking-valve"
    stage = "valve"
    stages = ("valve", "actuator")
    Parameters = one("stuck_s", 0.0, "s", "How long it sticks, after two hours on its seat.", 0.0, 7200.0)
    priors = {"stuck_s": Prior(0.0, 5400.0, noticeable=60.0)}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("valve", wrapped(valve_of(belief), cls, p, sticking, memory=Seat))


def paused(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Let nothing flow at the beginning of every second hour."""
    flow = believed(p, x, u, t, dt)
    return 0.0 if t % 7200.0 < p.pump_pauses_pause_s else flow


class PumpPauses(Family):
    """The pump stops for some minutes every two hours."""

    name = "pump-pauses"
    stage = "valve"
    stages = ("valve", "emitter", "actuator")
    Parameters = one("pause_s", 0.0, "s", "How long it stops.", 0.0, 3600.0)
    priors = {"pause_s": Prior(0.0, 3000.0, noticeable=60.0)}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("valve", wrapped(valve_of(belief), cls, p, paused))
