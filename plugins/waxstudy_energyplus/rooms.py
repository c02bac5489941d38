"""The rooms `nzeb` and `surfaces` in EnergyPlus, from the same parameters; EnergyPlus itself is an extra."""

from __future__ import annotations

from collections.abc import Callable

from waxstudy.plugin import Advance, FloatArray, LinearRoom, OutsideRoom, WeatherRecord
from waxstudy_paper.room import NzebRoom, RoomDescription, SurfacesRoom
from waxstudy_paper.room.nzeb import NzebParameters


class NzebEnergyPlus(OutsideRoom):
    """The room of Table 3 in EnergyPlus 25.2 (docs/energyplus.md says what is the engine's own there)."""

    name = "nzeb-energyplus"
    api_version = "1.0"
    Parameters = NzebParameters

    @classmethod
    def build(cls, p: NzebParameters) -> LinearRoom:
        return NzebRoom.build(p)

    @classmethod
    def simulate(
        cls,
        p: NzebParameters,
        weather: WeatherRecord,
        advance: Advance,
        *,
        setpoint_C: float,
        step_s: float,
        air_K: float,
        slab_K: float,
        stop: Callable[[], bool],
    ) -> FloatArray:
        """Return the record of one run, which has a process of its own."""
        return _simulate(NzebRoom.describe(p), weather, advance, setpoint_C, step_s, (air_K, slab_K), stop)


class SurfacesEnergyPlus(OutsideRoom):
    """A room of surfaces, windows, air and one heated floor in EnergyPlus 25.2, as the study describes it."""

    name = "surfaces-energyplus"
    api_version = "1.0"
    Parameters = RoomDescription
    examples = SurfacesRoom.examples

    @classmethod
    def build(cls, p: RoomDescription) -> LinearRoom:
        return SurfacesRoom.build(p)

    @classmethod
    def simulate(
        cls,
        p: RoomDescription,
        weather: WeatherRecord,
        advance: Advance,
        *,
        setpoint_C: float,
        step_s: float,
        air_K: float,
        slab_K: float,
        stop: Callable[[], bool],
    ) -> FloatArray:
        """Return the record of one run, which has a process of its own."""
        return _simulate(p, weather, advance, setpoint_C, step_s, (air_K, slab_K), stop)


def _simulate(
    room: RoomDescription,
    weather: WeatherRecord,
    advance: Advance,
    setpoint_C: float,
    step_s: float,
    start_K: tuple[float, float],
    stop: Callable[[], bool],
) -> FloatArray:
    from waxstudy.simulation.engine import Start
    from waxstudy_energyplus.run import simulate

    start = Start(*start_K)
    run = simulate(room, weather, advance, setpoint_C=setpoint_C, step_s=step_s, start=start, stop=stop)
    return run.trace()
