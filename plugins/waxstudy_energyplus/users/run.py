"""Run a user's model with the chain in it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from datetime import date, timedelta

import numpy as np

from waxstudy.plugin import Advance, FloatArray, WeatherRecord
from waxstudy.simulation.engine import DAY_S, WARM_UP_DAYS
from waxstudy_energyplus.installation import folder
from waxstudy_energyplus.native_code import codes_for
from waxstudy_energyplus.record import MINUTE, Simulated
from waxstudy_energyplus.run import asked
from waxstudy_energyplus.users.file import UsersModel
from waxstudy_energyplus.users.loop import UnitJob
from waxstudy_energyplus.users.takeover import AVAILABLE, first_day, taken_over
from waxstudy_energyplus.users.zones import ACTUATORS, CONSTANT, VARIABLE, Unit, Zone, of_unit, surfaces

# what the engine calls the full flow, in m3/s: of constant flow too, whatever its name says
FULL_FLOW = {
    VARIABLE: "Hydronic Low Temp Radiant Design Water Volume Flow Rate for Heating",
    CONSTANT: "Constant Flow Low Temp Radiant Design Water Mass Flow Rate",
}
OF_ZONE = {
    "air_C": "Zone Air Temperature",
    "radiant_C": "Zone Mean Radiant Temperature",
    "operative_C": "Zone Operative Temperature",
}
OF_SURFACE = {
    "floor_surface_C": "Surface Inside Face Temperature",
    "layer_C": "Surface Internal Source Location Temperature",
    "convection": "Surface Inside Face Convection Heat Gain Rate per Area",
    "radiation": "Surface Inside Face Net Surface Thermal Radiation Heat Gain Rate per Area",
    "of gains": "Surface Inside Face Internal Gains Radiation Heat Gain Rate per Area",
}
LOST = ("convection", "radiation", "of gains")  # of the surface's face, where a gain is positive


def simulate(
    model: UsersModel,
    zone: Zone,
    unit: Unit,
    weather: WeatherRecord,
    weather_file: bytes,
    advance: Advance,
    *,
    sensed: str,
    floor_area_m2: float,
    step_s: float,
    engine_step_s: float,
    start_C: float,
    longest_silence_s: float,
    stop: Callable[[], bool],
) -> FloatArray:
    """Return the record of the weather's days, after seven of warm-up; raise what `OutsideRoom.simulate` raises."""
    heated = surfaces(model, unit)
    variables = _variables(zone, unit, heated)
    job = UnitJob(
        engine=folder(),
        advance=advance,
        step_s=step_s,
        engine_step_s=engine_step_s,
        warm_up_steps=round(WARM_UP_DAYS * DAY_S / engine_step_s),
        steps=round(weather.duration_s / engine_step_s),
        variables=tuple(variables.values()),
        sensed=((list(variables).index(sensed), 1.0),),
        longest_silence_s=longest_silence_s,
        codes=codes_for(advance),
        flow=_flow(unit),
        full_flow=(FULL_FLOW[unit.kind], unit.name) if unit.kind in FULL_FLOW else None,
        wanted=("Zone Temperature Control", "Heating Setpoint", zone.name),
        start_C=start_C,
    )
    begin = date.fromisoformat(weather.first_day)
    first = first_day(model, begin.month, begin.day) - timedelta(days=WARM_UP_DAYS)
    days = WARM_UP_DAYS + round(weather.duration_s / DAY_S)
    objects = taken_over(model, unit, first, days, round(3600.0 / engine_step_s))
    # place names may be in any encoding, and this one has a letter for every byte
    rows, chain = asked(job, objects, weather_file.decode("latin-1"), stop, "latin-1")
    value = _with_surfaces(dict(zip(variables, rows.T, strict=True)), heated, floor_area_m2)
    return Simulated(np.column_stack([value[name] for name in MINUTE]), chain, step_s, engine_step_s).trace()


def _flow(unit: Unit) -> tuple[str, str, str]:
    if unit.kind in ACTUATORS:
        return ACTUATORS[unit.kind], "Water Mass Flow Rate", unit.name
    return "Schedule:Constant", "Schedule Value", AVAILABLE


def _variables(zone: Zone, unit: Unit, heated: Mapping[str, float]) -> dict[str, tuple[str, str]]:
    """Return the output variables that a run reads, with their keys."""
    of_zone = {name: (what, zone.name) for name, what in OF_ZONE.items()}
    of_surfaces = {f"{name} of {key}": (what, key) for name, what in OF_SURFACE.items() for key in heated}
    return of_zone | of_unit(unit) | of_surfaces


def _with_surfaces(
    value: dict[str, FloatArray], shares: Mapping[str, float], floor_area_m2: float
) -> dict[str, FloatArray]:
    """Add what the heated surfaces are; where there are none, what stands for it."""
    if not shares:
        floor_heat_W_m2 = value["water_heat_W"] / floor_area_m2
        stands = dict.fromkeys(("floor_surface_C", "layer_C"), value["operative_C"])
        return value | stands | {"floor_heat_W_m2": floor_heat_W_m2}
    means = {n: sum((s * value[f"{n} of {key}"] for key, s in shares.items()), start=np.zeros(())) for n in OF_SURFACE}
    return value | means | {"floor_heat_W_m2": -sum((means[name] for name in LOST), start=np.zeros(()))}
