"""The contract of a room whose own engine owns time."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, ClassVar

from waxstudy.plugin.contracts import FloatArray, Room, WeatherRecord


class BackendMissing(Exception):
    """An optional engine is not installed; the message says what to install (exit code 5)."""


class SimulationError(Exception):
    """The simulation failed; the message says what failed, when and where (exit code 6)."""


class Stopped(Exception):
    """The simulation was asked to stop."""


# sensed temperature [C], time at the start of the step [s], step [s] -> output, signal, opening, flow fraction
Advance = Callable[[float, float, float], Sequence[float]]

# columns of a simulated week, one row per step; temperatures at the end of the step, the rest over the step
TRACE = (
    "air_C",
    "operative_C",
    "floor_surface_C",
    "layer_C",
    "floor_heat_W_m2",
    "output",
    "signal",
    "opening",
    "flow_fraction",
    "water_heat_W",
)


class OutsideRoom(Room):
    """A room whose own engine owns time and calls the chain.

    Its `build` gives the linear room that stands in for it: for areas and flows, and for a first guess of the setpoint
    shift. `has_own_water` says that the engine's model, not the stand-in, tells how warm its water is.
    """

    has_own_water: ClassVar[bool] = False

    @classmethod
    def ready(cls, p: Any, weather: WeatherRecord, step_s: float) -> str:
        """Return the engine with its exact version, "EnergyPlus 25.2.0"; called for each week before any case runs.

        Raises `BackendMissing` where the engine is not installed, `ValueError` with a one-line reason for what it
        cannot take; `Refused` says whose value that is.
        """
        raise NotImplementedError

    @classmethod
    def simulate(
        cls,
        p: Any,
        weather: WeatherRecord,
        advance: Advance,
        *,
        setpoint_C: float,
        step_s: float,
        air_K: float,
        slab_K: float,
        stop: Callable[[], bool],
    ) -> FloatArray:
        """Return the record (steps, len(TRACE)), after a week of the first day's weather.

        Before that, air and walls are at `setpoint_C + air_K`, the floor 2 K + `slab_K` above the setpoint. `advance`
        can be pickled and is called once for every `step_s`, warm-up included; what it raises comes out. Ends soon
        once `stop()` is true: raises `Stopped`, or returns whatever it has, which is not kept.
        """
        raise NotImplementedError
