"""The components of the paper: its blocks, room, weather weeks and published figures, registered like a stranger's."""

from __future__ import annotations

from collections.abc import Callable

from waxstudy.plugin import Component, hookimpl
from waxstudy_paper import actuators, controllers, modulators, sensors, valves
from waxstudy_paper.published import Paper
from waxstudy_paper.room import NzebRoom, SurfacesRoom
from waxstudy_paper.weather import Epw, TallinnWeek

COMPONENTS: tuple[type[Component], ...] = (
    sensors.IdealSensor,
    sensors.DelaySensor,
    sensors.LagSensor,
    controllers.OnOff,
    controllers.PI,
    modulators.Pwm,
    modulators.Standby,
    actuators.IdealActuator,
    actuators.ConstantTimes,
    actuators.VariableTimes,
    valves.LinearValve,
    valves.QuickOpeningValve,
    NzebRoom,
    SurfacesRoom,
    TallinnWeek,
    Epw,
    Paper,
)


@hookimpl
def waxstudy_register(register: Callable[[type[Component]], None]) -> None:
    for component in COMPONENTS:
        register(component)
