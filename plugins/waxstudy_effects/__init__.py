"""Candidate effects that a model may be missing, one module per stage of the loop; registered like a stranger's."""

from __future__ import annotations

from collections.abc import Callable

from waxstudy.plugin import Component, Effect, hookimpl
from waxstudy_effects import actuator, controller, emitter, modulator, room, sensor, valve

EFFECTS: tuple[type[Effect], ...] = (
    sensor.SensorDelay,
    sensor.SensorLag,
    sensor.SensorBias,
    controller.DeadBand,
    controller.PITuning,
    controller.SetpointOffset,
    modulator.Modulation,
    modulator.PwmPeriod,
    modulator.MinPulse,
    actuator.WaxMotor,
    actuator.WithConstantTimes,
    actuator.WithVariableTimes,
    actuator.SlowActuator,
    actuator.LimitedTravel,
    valve.QuickOpening,
    valve.LowAuthority,
    valve.LetBy,
    valve.StuckOpen,
    valve.MaxFlow,
    emitter.SupplyOffset,
    emitter.PipeDelay,
    emitter.FloorCover,
    room.Infiltration,
    room.WindowOpening,
    room.SolarFactor,
    room.GainShift,
    room.ThermalMass,
    room.NeighbourHeat,
    room.ExtraHeat,
)


@hookimpl
def waxstudy_register(register: Callable[[type[Component]], None]) -> None:
    for effect in EFFECTS:
        register(effect)
