"""The linear ramp: the simplest actuator model, as open thermostat firmware moves a valve by its stroke time."""

from dataclasses import dataclass

from waxstudy.plugin import Actuator, Parameters, hookimpl, parameter


class Stroke(Parameters):
    stroke_time_s: float = parameter(180.0, unit="s", gt=0, le=3600, description="Full stroke.", source="3.1, maker A")


@dataclass
class Piston:
    opening: float = 0.0


class LinearRamp(Actuator):
    """Opens and closes at constant speed: dh/dt = 1 / time if on, -1 / time if off, 0 <= h <= 1. Not in the paper."""

    name, api_version, Parameters, State = "linear-ramp", "1.0", Stroke, Piston

    @staticmethod
    def step(p, x, u, t, dt):
        x.opening = min(1.0, max(0.0, x.opening + (dt if u > 0.5 else -dt) / p.stroke_time_s))
        return x.opening


@hookimpl
def waxstudy_register(register):
    register(LinearRamp)
