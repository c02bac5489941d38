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
    TRACE,
    Actuator,
    Advance,
    Block,
    Component,
    Controller,
    Facade,
    Finding,
    FloatArray,
    LinearRoom,
    Modulator,
    OutsideRoom,
    Port,
    PublishedRow,
    Reference,
    Room,
    Sensor,
    Valve,
    Weather,
    WeatherRecord,
)
from waxstudy.plugin.effect import STAGES, Belief, Effect, Inputs, Prior, Uncertainty
from waxstudy.plugin.hook import hookimpl
from waxstudy.plugin.parameters import Parameters, parameter
from waxstudy.plugin.registry import BackendMissing
from waxstudy.plugin.ring import Ring, delayed

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
    "Component",
    "Controller",
    "Effect",
    "Facade",
    "Finding",
    "FloatArray",
    "Inputs",
    "LinearRoom",
    "Modulator",
    "OutsideRoom",
    "Parameters",
    "Port",
    "Prior",
    "PublishedRow",
    "Reference",
    "Ring",
    "Room",
    "Sensor",
    "Uncertainty",
    "Valve",
    "Weather",
    "WeatherRecord",
    "delayed",
    "hookimpl",
    "parameter",
]
