"""Run a user's model with the chain in it."""

from __future__ import annotations

from collections.abc import Callable
from datetime import date, timedelta

from waxstudy.plugin import Advance, FloatArray, WeatherRecord
from waxstudy.simulation.engine import DAY_S, WARM_UP_DAYS
from waxstudy_energyplus.record import Simulated
from waxstudy_energyplus.run import asked
from waxstudy_energyplus.users.file import UsersModel
from waxstudy_energyplus.users.loop import Job
from waxstudy_energyplus.users.takeover import first_day, taken_over
from waxstudy_energyplus.users.zones import Unit, Zone, of_unit, surfaces


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
    job = Job(
        zone.name,
        unit.kind,
        unit.name,
        of_unit(unit),
        surfaces(model, unit),
        floor_area_m2,
        sensed,
        advance,
        step_s,
        engine_step_s,
        weather.duration_s,
        WARM_UP_DAYS,
        start_C,
        longest_silence_s,
    )
    begin = date.fromisoformat(weather.first_day)
    first = first_day(model, begin.month, begin.day) - timedelta(days=WARM_UP_DAYS)
    days = WARM_UP_DAYS + round(weather.duration_s / DAY_S)
    objects = taken_over(model, unit, first, days, round(3600.0 / engine_step_s))
    # place names may be in any encoding, and this one has a letter for every byte
    minutes, chain = asked(job, objects, weather_file.decode("latin-1"), stop, "latin-1")
    return Simulated(minutes, chain, step_s, engine_step_s).trace()
