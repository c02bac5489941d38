"""The rooms `nzeb` and `surfaces` in EnergyPlus, from the same parameters; EnergyPlus itself is an extra."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from waxstudy.plugin import Advance, FloatArray, LinearRoom, ModelError, OutsideRoom, Refused, Room, WeatherRecord
from waxstudy_energyplus.installation import installed_version
from waxstudy_energyplus.shell import refuse_names, refuse_windows
from waxstudy_paper.room import NzebRoom, RoomDescription, SurfacesRoom
from waxstudy_paper.room.corner import NzebParameters


class InEnergyPlus(OutsideRoom):
    """A room that one of ours describes and stands in for, simulated by EnergyPlus in a process of its own."""

    ours: ClassVar[type[Room]]

    @classmethod
    def modelled(cls, p: Any) -> RoomDescription:
        """Return what EnergyPlus is told, in the words of room `surfaces`; effects leave it alone."""
        raise NotImplementedError

    @classmethod
    def build(cls, p: Any) -> LinearRoom:
        """Return the room that stands in; raise `ValueError` for what the room in EnergyPlus cannot have."""
        room = cls.modelled(p)
        if (sky_W_m2K := room.films.sky_W_m2K) > 0.0:
            wrong = "must be 0: the room in EnergyPlus has no sky colder than the air"
            raise Refused("room.films.sky_W_m2K", sky_W_m2K, wrong)
        refuse_names(room)
        refuse_windows(room)
        return cls.ours.build(p)

    @classmethod
    def model_errors(cls, p: Any) -> Mapping[str, ModelError]:
        """Return those of the room that stands in: a diagnosis takes that one."""
        return cls.ours.model_errors(p)

    @classmethod
    def ready(cls, p: Any, weather: WeatherRecord, step_s: float) -> str:
        from waxstudy_energyplus.run import refuse_times

        refuse_times(weather, step_s)
        return f"EnergyPlus {installed_version()}"

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
        from waxstudy.simulation.engine import Start
        from waxstudy_energyplus.run import simulate

        room, start = cls.modelled(p), Start(air_K, slab_K)
        run = simulate(room, weather, advance, setpoint_C=setpoint_C, step_s=step_s, start=start, stop=stop)
        return run.trace()


class NzebEnergyPlus(InEnergyPlus):
    """The room of Table 3 in EnergyPlus 25.2 (docs/energyplus.md says what is the engine's own there)."""

    name = "nzeb-energyplus"
    api_version = "1.0"
    Parameters = NzebParameters
    ours = NzebRoom

    @classmethod
    def modelled(cls, p: NzebParameters) -> RoomDescription:
        return NzebRoom.description(p)


class SurfacesEnergyPlus(InEnergyPlus):
    """A room of surfaces, windows, air and one heated floor in EnergyPlus 25.2, as the study describes it."""

    name = "surfaces-energyplus"
    api_version = "1.0"
    Parameters = RoomDescription
    examples = SurfacesRoom.examples
    ours = SurfacesRoom

    @classmethod
    def modelled(cls, p: RoomDescription) -> RoomDescription:
        return p
