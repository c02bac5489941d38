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
    Component,
    Controller,
    Facade,
    Finding,
    FloatArray,
    LinearRoom,
    Modulator,
    Port,
    PublishedRow,
    Reference,
    Refused,
    Room,
    Sensor,
    Valve,
    Weather,
    WeatherRecord,
)
from waxstudy.plugin.hook import hookimpl
from waxstudy.plugin.outside import TRACE, Advance, BackendMissing, OutsideRoom, SimulationError, Stopped
from waxstudy.plugin.parameters import Parameters, parameter
from waxstudy.plugin.ring import Ring, delayed

__all__ = [
    "API_VERSION",
    "CHAIN",
    "ERROR",
    "KINDS",
    "LEVEL",
    "ROOM_OUTPUTS",
    "TEMPERATURE",
    "TRACE",
    "Actuator",
    "Advance",
    "BackendMissing",
    "Block",
    "Component",
    "Controller",
    "Facade",
    "Finding",
    "FloatArray",
    "LinearRoom",
    "Modulator",
    "OutsideRoom",
    "Parameters",
    "Port",
    "PublishedRow",
    "Reference",
    "Refused",
    "Ring",
    "Room",
    "Sensor",
    "SimulationError",
    "Stopped",
    "Valve",
    "Weather",
    "WeatherRecord",
    "delayed",
    "hookimpl",
    "parameter",
]
