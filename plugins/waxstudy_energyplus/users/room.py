"""The room `energyplus-model`: its parameters, what stands in for it, and its simulation."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from waxstudy.plugin import (
    Advance,
    FloatArray,
    LinearRoom,
    OutsideRoom,
    Parameters,
    Refused,
    WeatherRecord,
    parameter,
)
from waxstudy.plugin.files import DATA_BYTES, read_file, why
from waxstudy.study.model import is_multiple
from waxstudy_energyplus.installation import installed_version
from waxstudy_energyplus.library import LONGEST_SILENCE_S
from waxstudy_energyplus.users.file import UsersModel, read_model
from waxstudy_energyplus.users.takeover import steps_per_hour
from waxstudy_energyplus.users.zones import Unit, Zone, unit_of, zones
from waxstudy_paper.room import NzebRoom
from waxstudy_paper.room.scaled import scaled

_GIVEN = "given by the user"
# the model's own control temperature -> what the sensor is exposed to; the air for all others
SENSED = {
    "MEANAIRTEMPERATURE": "air_C",
    "MEANRADIANTTEMPERATURE": "radiant_C",
    "OPERATIVETEMPERATURE": "operative_C",
}
SAID = {"air_C": "air", "radiant_C": "mean radiant temperature", "operative_C": "operative temperature"}


class ModelParameters(Parameters):
    path: str = parameter(unit="", description="The model, .idf or .epJSON, relative to the study file.", source=_GIVEN)
    zone: str = parameter(unit="", description="The zone that is the room.", source=_GIVEN)
    unit: str | None = parameter(
        None, unit="", description="What heats it with water, where there are two.", source="the only one"
    )
    steps_per_hour: int | None = parameter(
        None,
        unit="1/h",
        ge=1,
        le=60,
        description="Time steps of the engine in place of the model's own; a divisor of 60.",
        source="the model's own",
    )
    floor_area_m2: float | None = parameter(
        None, unit="m2", ge=1.0, le=100_000.0, description="Heated floor.", source="the zone's floor in the model"
    )
    longest_silence_s: float = parameter(
        LONGEST_SILENCE_S,
        unit="s",
        gt=0.0,
        le=86_400.0,
        description="Time that EnergyPlus may take between two steps, before its process is ended.",
        source="chosen: shadows of a large model take a minute or two",
    )


class EnergyPlusModelRoom(OutsideRoom):
    """A zone of a model that somebody has made in EnergyPlus 25.2: the chain drives its floor, all else is theirs.

    The paper's room, as large as the zone, stands in for it.
    """

    name = "energyplus-model"
    api_version = "1.0"
    has_own_water = True
    Parameters = ModelParameters
    examples = {}
    exemptions = {"examples": "it runs a model that the user has"}

    @classmethod
    def build(cls, p: ModelParameters) -> LinearRoom:
        _, zone, _ = _found(p)
        return scaled(NzebRoom.build(NzebRoom.Parameters()), cls._area_m2(p, zone))

    @classmethod
    def _area_m2(cls, p: ModelParameters, zone: Zone) -> float:
        if (floor_area_m2 := p.floor_area_m2 or zone.floor_area_m2) <= 0.0:
            raise Refused("room.zone", p.zone, "has no floor whose area the model tells: give floor_area_m2")
        return floor_area_m2

    @classmethod
    def contents(cls, path: Path) -> Sequence[Mapping[str, str]]:
        return [
            {
                "zone": zone.name,
                "floor m2": f"{zone.floor_area_m2:.1f}",
                "heated by": "; ".join(str(unit) for unit in zone.units),
                "stands against it": zone.against or "nothing",
                "note": zone.known,
            }
            for zone in zones(read_model(path))
        ]

    @classmethod
    def ready(cls, p: ModelParameters, weather: WeatherRecord, step_s: float) -> str:
        model, _, unit = _found(p)
        engine_step_s = _engine_step_s(p, model)
        if not is_multiple(engine_step_s, of=step_s):
            raise Refused("study.step_s", step_s, f"must divide the engine's time step of {engine_step_s:g} s")
        weather_digest = hashlib.sha256(_weather_file(weather)).hexdigest()
        said = SAID[_sensed(model, unit)]
        return (
            f"EnergyPlus {installed_version()}, {model.path.name} (sha256 {model.digest[:16]}), "
            f"{Path(weather.file).name} (sha256 {weather_digest[:16]}), {unit}, steps of {engine_step_s:g} s, "
            f"the sensor in the {said}"
        )

    @classmethod
    def simulate(
        cls,
        p: ModelParameters,
        weather: WeatherRecord,
        advance: Advance,
        *,
        setpoint_C: float,
        step_s: float,
        air_K: float,
        slab_K: float,
        stop: Callable[[], bool],
    ) -> FloatArray:
        from waxstudy_energyplus.users.run import simulate  # the engine of the fast room comes with it

        model, zone, unit = _found(p)
        return simulate(
            model,
            zone,
            unit,
            weather,
            _weather_file(weather),
            advance,
            sensed=_sensed(model, unit),
            floor_area_m2=cls._area_m2(p, zone),
            step_s=step_s,
            engine_step_s=_engine_step_s(p, model),
            start_C=setpoint_C + air_K,
            longest_silence_s=p.longest_silence_s,
            stop=stop,
        )


def _found(p: ModelParameters) -> tuple[UsersModel, Zone, Unit]:
    model = read_model(Path(p.path))
    return model, *unit_of(model, p.zone, p.unit)


def _engine_step_s(p: ModelParameters, model: UsersModel) -> float:
    per_hour = p.steps_per_hour or steps_per_hour(model)
    if 60 % per_hour:
        raise Refused("room.steps_per_hour", per_hour, "must divide 60, as 4, 6, 12, 20, 30 and 60 do")
    return 3600.0 / per_hour


def _sensed(model: UsersModel, unit: Unit) -> str:
    design = model.named(f"{unit.kind}:Design", unit.fields.get("design_object", ""))
    kind = design[1].get("temperature_control_type", "MeanAirTemperature") if design is not None else ""
    return SENSED.get(str(kind).upper(), "air_C")


def _weather_file(weather: WeatherRecord) -> bytes:
    """Return the bytes of the EPW file that a record comes from; raise `Refused` for another record."""
    if not weather.file:
        raise Refused("weather.use", "", 'must be "epw": EnergyPlus reads sun, wind and moisture from the file itself')
    try:
        return read_file(weather.file, DATA_BYTES)
    except OSError as error:
        raise Refused("weather.path", weather.file, f"cannot be read: {why(error)}") from error
