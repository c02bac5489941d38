"""What drives a room and nobody recorded: what stands in for it, and how little is known of that.

All spreads are chosen. They are wide, so that a fit may put a missing drive where the record asks for it, and what it
could explain is no finding.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from waxstudy.dataset.channels import DIFFUSE, GLOBAL, LIGHT, PANELS
from waxstudy.plugin import FloatArray, LinearRoom, Role, WeatherRecord

if TYPE_CHECKING:
    import pandas as pd

    from waxstudy.dataset.tables import Site

SUN, GAINS, SUPPLY_AIR = "solar_gain_W", "internal_gain_W", "ventilation_supply_temperature_C"
FIELDS = {SUN: "solar_W", GAINS: "gains_W"}  # of `Inputs`
ROLES = {SUN: Role.SUN, GAINS: Role.GAINS}
DAY_H = 24.0
SUN_W_M2 = 30.0  # of floor, spread of the sun around noon where nothing is known of it: a clear day in February has 80
# where no place is told: a latitude between Italy and Finland says how long the sun is up, and noon by the clock when;
# time zones put noon up to an hour early or late
LATITUDE_DEG, NOON_H, NOON_WITHIN_H = 50.0, 12.0, 1.0
ANYWHERE = (
    "It may shine at other hours and fall anywhere in the room: heat by day is found only if it is larger or sharper."
)
PROFILE_STEP_H = 1.0  # of the course of an unknown sun; with steps of 1.5 h dusk was taken for a window that closes
# where windows look to, and where the sun falls, nobody told: the room's own way, on all surfaces, or into the air
SUN_FIELDS = {"": "solar_W", ", to surfaces": "gains_W", ", to air": "extra_W"}
MOST_SUNS = 14  # stretches of days that have a sun of their own; of a longer record each is several days
CLEAR_SHARE, CLEAR_SPREAD = 0.4, 0.35  # of a clear sky's sun, usual and its spread from day to day
# by what the sun was recorded -> log spread of a factor for all days, and of each day's own: horizon and curtains in
# each, the share of direct light that was not recorded, of panels yield, snow and shadows (docs/import-stand-ins.md)
RECORDED = {GLOBAL: (0.2, 0.15), DIFFUSE: (0.12, 0.08), PANELS: (0.3, 0.2)}
SUN_VARIES = 0.03  # spread of the logarithm of that factor from one record of a room to another
ASSUMED = {GAINS: 0.15, SUN: 0.12}  # spread of the logarithm of a factor where nobody measured what is told
GAINS_FACTOR = 0.7  # spread of the logarithm of a factor on the room's own schedule
GAINS_W_M2, GAINS_STEP_H = 4.0, 1.0  # of floor, spread of what comes besides at some hours of every day
# the same from one record of a room to another, as `gain-shift` has it: 12 %, and 0.4 h of a step of 5 W/m²
GAINS_FACTOR_VARIES, GAINS_VARIES_W_M2 = 0.12, 2.0


@dataclass(frozen=True)
class Shape:
    """A course of heat (n,) [W] of which nobody knows how strong it was; `sd` is the spread of its strength."""

    name: str
    heat_W: FloatArray
    sd: float
    is_once: bool = False  # some days' own, else every day's
    varies: float | None = None  # from one record to another; None: one says nothing of another
    field: str = ""  # of `Inputs`, where it is another one than that of the drive


@dataclass(frozen=True)
class StandIn:
    """What stands in for a drive (n,) [W], what of it is unknown, and a sentence that says so."""

    values: FloatArray
    shapes: Sequence[Shape]
    factor_sd: float  # of the logarithm of a factor on its values; 0 where none is asked for
    factor_varies: float  # the same from one record to another
    sentence: str
    source: str = ""  # what its values are from


def stand_ins(
    lacking: Sequence[str],
    room: LinearRoom,
    time: pd.DatetimeIndex,
    interval_s: float,
    site: Site | None,
    recorded: Mapping[str, FloatArray] = MappingProxyType({}),
    spreads: Mapping[str, float] = MappingProxyType({}),
) -> dict[str, StandIn]:
    """Return what stands in for sun and gains that the room takes and nobody recorded; `time`: ends of intervals.

    `recorded` holds the channels that are there; `spreads` how uncertain a channel's stand-in is, where that is stated.
    """
    middle = (time - time.normalize()).total_seconds().to_numpy() / 3600.0 - interval_s / 7200.0
    hour = np.asarray(middle % DAY_H, dtype=float)
    made: Mapping[str, Callable[[], StandIn]] = {
        SUN: lambda: _sun(room, time, hour, interval_s, site, recorded, spreads.get(SUN)),
        GAINS: lambda: _gains(room, hour, spreads.get(GAINS, GAINS_FACTOR)),
    }
    return {channel: made[channel]() for channel in lacking if room.places(ROLES[channel])}


# --- sun ---


def sun_source(recorded: Collection[str], site: Site | None) -> str:
    """Return the channel that tells most of the sun, where the place is known from which it is seen; "" for none."""
    if site is None or site.longitude is None:
        return ""
    if GLOBAL in recorded:
        return DIFFUSE if DIFFUSE in recorded else GLOBAL
    return PANELS if PANELS in recorded and site.panels_peak_W else ""


def why_dark(recorded: Collection[str], site: Site | None) -> str:
    """Return why light that was recorded tells nothing of the sun, "" where it does or there is none."""
    seen = [name for name in (GLOBAL, PANELS, DIFFUSE) if name in recorded]
    if not seen or SUN in recorded or sun_source(recorded, site):
        return ""
    if seen == [DIFFUSE]:
        return f"{DIFFUSE} is not used: the sun in the room follows from it only beside {GLOBAL}"
    lacks = "latitude and longitude" if site is None or site.longitude is None else "panels_peak_W"
    return f"{seen[0]} is not used: the sun in the room follows from it only with {lacks} in [site]"


def _sun(
    room: LinearRoom,
    time: pd.DatetimeIndex,
    hour: FloatArray,
    interval_s: float,
    site: Site | None,
    recorded: Mapping[str, FloatArray],
    spread: float | None,
) -> StandIn:
    day = np.cumsum(np.concatenate(([False], np.diff(hour) < 0.0)))
    if site is not None and (source := sun_source(recorded, site)):
        return _recorded_sun(room, time, day, interval_s, site, recorded, source, spread)
    if site is None:
        up_h = daylight_h(time)
        shapes = [
            Shape(
                f"sun of {name}, {half}",
                room.floor_area_m2 * _hat(hour, NOON_H + side * up_h / 4.0, up_h / 2.0) * within,
                SUN_W_M2,
                is_once=True,
            )
            for name, within in _stretches(day)
            for half, side in (("morning", -1.0), ("afternoon", 1.0))
        ]
        shapes += _every_day(room, hour, np.abs(hour - NOON_H) <= up_h / 2.0 + NOON_WITHIN_H)
        sentence = (
            f"{SUN} was not recorded: each day has a sun of its own in the fit, its size free. [site] with latitude "
            f"and longitude would tell at which hours. {ANYWHERE}"
        )
        return StandIn(np.zeros(len(time)), shapes, 0.0, 0.0, sentence)
    from waxstudy.dataset.sunlight import clear_sky_W  # brings the compiler along

    clear_W = clear_sky_W(room, time, interval_s, site)
    shapes = [Shape(f"sun of {name}", clear_W * within, CLEAR_SPREAD, is_once=True) for name, within in _stretches(day)]
    shapes += _every_day(room, hour, clear_W > 0.0)
    sentence = (
        f"{SUN} was not recorded: {CLEAR_SHARE:.0%} of a clear sky's at [site] stands in for it, and each day may have "
        f"less or more in the fit. {ANYWHERE}"
    )
    return StandIn(CLEAR_SHARE * clear_W, shapes, 0.0, 0.0, sentence)


def daylight_h(time: pd.DatetimeIndex) -> float:
    """Return how long the sun is up on the middle day of a record [h], where no place is told."""
    from pvlib.solarposition import declination_spencer71

    declination = float(declination_spencer71(time[len(time) // 2].day_of_year))
    noon_to_set = np.arccos(-np.tan(np.radians(LATITUDE_DEG)) * np.tan(declination))
    return float(DAY_H * noon_to_set / np.pi)


def _every_day(room: LinearRoom, hour: FloatArray, is_up: np.ndarray) -> Iterator[Shape]:
    """Yield what the sun does every day at each hour in whose middle it is up, `is_up` (n,)."""
    fields = {where: field for where, field in SUN_FIELDS.items() if field != FIELDS[GAINS] or room.takes(Role.GAINS)}
    for at_h in np.arange(0.5, DAY_H, PROFILE_STEP_H).tolist():
        hat = _hat(hour, at_h, PROFILE_STEP_H)
        if hat[is_up].max(initial=0.0) > 0.5:
            for where, field in fields.items():
                yield Shape(f"sun around {at_h:g} h{where}", room.floor_area_m2 * hat, SUN_W_M2, field=field)


def _recorded_sun(
    room: LinearRoom,
    time: pd.DatetimeIndex,
    day: np.ndarray,
    interval_s: float,
    site: Site,
    recorded: Mapping[str, FloatArray],
    source: str,
    spread: float | None,
) -> StandIn:
    """Return what the light that was recorded gives to the room, all days and each day a little more or less of it."""
    from waxstudy.dataset.sunlight import recorded_sun_W

    heat_W = recorded_sun_W(room, time, interval_s, site, {name: recorded[name] for name in LIGHT if name in recorded})
    usual, of_day = RECORDED[source]
    factor = spread or usual
    shapes = [Shape(f"sun of {name}", heat_W * within, of_day, is_once=True) for name, within in _stretches(day)]
    told = f"{GLOBAL} and {source}" if source == DIFFUSE else source
    sentence = (
        f"{SUN} was not recorded: the sun that {told} tells at [site] stands in for it, uncertain by {factor:.0%}, and "
        f"each day by {of_day:.0%} more."
    )
    return StandIn(heat_W, shapes, factor, min(factor, SUN_VARIES), sentence, source)


def _hat(hour: FloatArray, middle_h: float, half_h: float) -> FloatArray:
    """Return a smooth hill of height 1 around an hour of the day (n,), nothing from so many hours off."""
    away_h = np.abs((hour - middle_h + 0.5 * DAY_H) % DAY_H - 0.5 * DAY_H)
    away = np.clip(away_h / half_h, 0.0, 1.0)
    return np.asarray(0.5 * (1.0 + np.cos(np.pi * away)))


def _stretches(day: np.ndarray) -> Iterator[tuple[str, np.ndarray]]:
    """Yield stretches of days with a name, and which samples lie in each (n,)."""
    length = int(np.ceil((day[-1] + 1) / MOST_SUNS))
    for first in range(0, int(day[-1]) + 1, length):
        last = min(first + length, int(day[-1]) + 1)
        name = f"day {first + 1}" if last == first + 1 else f"days {first + 1} to {last}"
        yield name, (day >= first) & (day < last)


# --- gains ---


def _gains(room: LinearRoom, hour: FloatArray, factor: float) -> StandIn:
    count = round(DAY_H / GAINS_STEP_H)
    away_h = np.abs((hour[:, None] - GAINS_STEP_H * np.arange(count) + 0.5 * DAY_H) % DAY_H - 0.5 * DAY_H)
    hats = np.clip(1.0 - away_h / GAINS_STEP_H, 0.0, None)
    shapes = [
        Shape(
            f"gains at {GAINS_STEP_H * place:g} h",
            room.floor_area_m2 * hats[:, place],
            GAINS_W_M2,
            varies=GAINS_VARIES_W_M2,
        )
        for place in range(count)
    ]
    sentence = (
        f"{GAINS} was not recorded: the believed room's own schedule stands in for it, times a factor that is free in "
        "the fit, and with heat at other hours of the day."
    )
    varies = min(factor, GAINS_FACTOR_VARIES)
    return StandIn(own_gains_W(room, hour), shapes, factor, varies, sentence, "the room's own gains")


def own_gains_W(room: LinearRoom, hour: FloatArray) -> FloatArray:
    """Return the gains that a room's own drive has at hours of the day (n,) [W]."""
    count = 288
    mild = np.full(count, 10.0)
    dark = {name: np.zeros(count) for name in room.facades}
    day = WeatherRecord(DAY_H * 3600.0 / count, "2000-01-01", mild, dark, sky_C=mild)
    own_W = room.drive(day)[0][:, room.places(Role.GAINS)].sum(axis=1)
    return np.asarray(own_W[(hour / DAY_H * count).astype(int) % count])
