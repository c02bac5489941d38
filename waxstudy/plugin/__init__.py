"""What a plugin author imports: contracts, parameters, the hook marker, and the delay ring.

A plugin is a module with a function `waxstudy_register(register)` marked `@hookimpl`, named in the entry-point
group `waxstudy`; it calls `register(ComponentClass)` for each component it offers.
"""

from waxstudy.plugin.contracts import (
    API_VERSION,
    CHAIN,
    ERROR,
    KINDS,
    LEVEL,
    ROOM_OUTPUTS,
    TEMPERATURE,
    Actuator,
    Block,
    Choice,
    Component,
    Controller,
    Facade,
    Finding,
    FinishedRun,
    FloatArray,
    LinearRoom,
    Modulator,
    NoState,
    Port,
    PublishedRow,
    Reference,
    Refused,
    Room,
    Sensor,
    Uncertainty,
    Valve,
    Weather,
    WeatherRecord,
)
from waxstudy.plugin.effect import STAGES, Belief, Effect, Inputs, Prior
from waxstudy.plugin.hook import hookimpl
from waxstudy.plugin.hours import clock, open_share
from waxstudy.plugin.model_error import ModelError
from waxstudy.plugin.outside import TRACE, Advance, BackendMissing, OutsideRoom, SimulationError, Stopped
from waxstudy.plugin.parameters import Parameters, changed, parameter
from waxstudy.plugin.ring import Ring, delayed
from waxstudy.plugin.roles import Role, RoomInput

__all__ = [
    "API_VERSION",
    "CHAIN",
    "ERROR",
    "KINDS",
    "LEVEL",
    "ROOM_OUTPUTS",
    "STAGES",
    "TEMPERATURE",
    "TRACE",
    "Actuator",
    "Advance",
    "BackendMissing",
    "Belief",
    "Block",
    "Choice",
    "Component",
    "Controller",
    "Effect",
    "Facade",
    "Finding",
    "FinishedRun",
    "FloatArray",
    "Inputs",
    "LinearRoom",
    "ModelError",
    "Modulator",
    "NoState",
    "OutsideRoom",
    "Parameters",
    "Port",
    "Prior",
    "PublishedRow",
    "Reference",
    "Refused",
    "Ring",
    "Role",
    "Room",
    "RoomInput",
    "Sensor",
    "SimulationError",
    "Stopped",
    "Uncertainty",
    "Valve",
    "Weather",
    "WeatherRecord",
    "changed",
    "clock",
    "delayed",
    "hookimpl",
    "open_share",
    "parameter",
]
