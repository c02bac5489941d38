"""The checks of a record, in one list: what is looked for, in the order in which it is told (docs/checks.md).

A check is a function that yields what it finds. Its docstring says what it sees, its decorator whether it refuses or
warns and what mends it; the limits that decide stand above, with their reasons.
"""

from waxstudy.dataset.checks import causes, samples, swapped, units
from waxstudy.dataset.checks.check import Check, Record, run

__all__ = ["AS_LOGGED", "CHECKS", "DEAD", "ON_GRID", "SAMPLES", "Check", "Record", "run"]

# of rows as they were logged: first their samples, and of what is left the units
SAMPLES = (samples.code, samples.impossible_sample, samples.spike, samples.failed, samples.peak, samples.stray)
AS_LOGGED = (units.temperature, units.level, units.gain, units.light, units.flow)
DEAD = (causes.dead_meter, samples.still)  # of rows on the grid, and before what is missing is told
ON_GRID = (
    samples.gaps,
    samples.constant,
    samples.stuck,
    samples.clipped,
    swapped.room_and_outdoors,
    swapped.room_and_setpoint,
    swapped.room_and_supply,
    swapped.ventilation_and_outdoors,
    swapped.supply_and_return,
    swapped.output_and_signal,
    swapped.output_without_signal,
    swapped.signal_and_opening,
    swapped.sensor_and_air,
    swapped.air_and_another,
    swapped.sun_at_night,
    swapped.light_at_night,
    causes.turned,
    causes.clock_offset,
    causes.early_sensor,
)
CHECKS: tuple[Check, ...] = (*SAMPLES, *AS_LOGGED, *DEAD, *ON_GRID)
