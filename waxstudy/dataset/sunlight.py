"""The sun's heat in a room, from where it is: under a clear sky, or from light or panels' power that was recorded.

All by pvlib. What was recorded counts by the hour, as the models of diffuse light do, and runs within an hour as a
clear sky's light does.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from waxstudy.dataset.channels import DIFFUSE, GLOBAL, PANELS
from waxstudy.dataset.zones import standard_ahead, zone_of
from waxstudy.plugin import Facade, FloatArray, LinearRoom, WeatherRecord
from waxstudy.plugin.glass import diffuse_through_glass, through_glass
from waxstudy.simulation.recorded import sun_W

if TYPE_CHECKING:
    import pandas as pd

    from waxstudy.dataset.tables import Site

DEG_PER_H = 15.0
ALBEDO = 0.2
LOW_SUN_DEG = 3.0  # below it light comes evenly from all sides, and an hour tells no share of a clear sky
MOST_CLEAR = 1.3  # share of a clear sky's light in an hour at most: clouds beside the sun are bright
PANELS_YIELD = 0.85  # of the peak power by irradiance: cables, inverter, dirt (IEC 61724: 0.75 to 0.9 over a year)
STANDARD_W_M2 = 1000.0  # irradiance at the peak power


@dataclass(frozen=True)
class Sky:
    """The sun at the middle of intervals (n,), and the light of a sky without clouds."""

    zenith_deg: FloatArray  # refraction included
    azimuth_deg: FloatArray
    extra_W_m2: FloatArray  # outside the atmosphere
    day_of_year: FloatArray
    global_W_m2: FloatArray
    diffuse_W_m2: FloatArray
    direct_W_m2: FloatArray
    hour: np.ndarray  # number of the hour, from 0

    @property
    def is_up(self) -> np.ndarray:
        return self.zenith_deg < 90.0 - LOW_SUN_DEG

    @property
    def stands(self) -> tuple[FloatArray, ...]:
        return self.zenith_deg, self.azimuth_deg, self.extra_W_m2, self.day_of_year

    @property
    def height(self) -> FloatArray:
        """Sine of the sun's height, nothing where it is low."""
        return np.where(self.is_up, np.cos(np.radians(self.zenith_deg)), 0.0)

    def by_hour(self, values: FloatArray, within: np.ndarray) -> FloatArray:
        """Return means over the samples of each hour that count; NaN where none does."""
        count = np.bincount(self.hour, within, minlength=self.hour[-1] + 1)
        total = np.bincount(self.hour, np.where(within, values, 0.0), minlength=len(count))
        return np.asarray(np.divide(total, count, out=np.full(len(count), np.nan), where=count > 0))


def clear_sky_W(room: LinearRoom, time: pd.DatetimeIndex, interval_s: float, site: Site) -> FloatArray:
    """Return what the sun of a clear sky gives to all nodes of a room (n,) [W], at the middle of each interval.

    The sky is the simplified Solis model (Ineichen 2008, doi:10.1016/j.solener.2007.09.002), the light from it even.
    """
    sky = _sky(time, interval_s, site)
    return _heat_W(room, sky, time, interval_s, (sky.global_W_m2, sky.diffuse_W_m2, sky.direct_W_m2), "isotropic")


def recorded_sun_W(
    room: LinearRoom, time: pd.DatetimeIndex, interval_s: float, site: Site, light: Mapping[str, FloatArray]
) -> FloatArray:
    """Return what the sun gives to all nodes of a room (n,) [W] by the light (n,) that was recorded, NaN for no sample.

    The share of diffuse light is recorded, or that of DISC (Maxwell 1987, SERI/TR-215-3087); the directions are those
    of Perez. From the plane of panels to level ground it is Perez and Erbs the other way round, and Erbs back, all as
    Driesse et al. have them (doi:10.1016/j.solener.2023.112093). Hours without a sample or with a low sun have as much
    of a clear sky's light as those beside them.
    """
    sky = _sky(time, interval_s, site)
    hours = _Hours.of(sky, light, site)
    total = hours.clear_share[sky.hour] * sky.global_W_m2
    diffuse = np.where(sky.is_up, hours.diffuse_share[sky.hour], 1.0) * total
    direct = np.divide(total - diffuse, sky.height, out=np.zeros(len(total)), where=sky.height > 0.0)
    return _heat_W(room, sky, time, interval_s, (total, diffuse, direct), "perez-driesse")


# --- hours --------------------------------------------------------------------------------------------


class _At(NamedTuple):
    """Where the sun stood in each hour that is told, on which day."""

    zenith_deg: FloatArray
    azimuth_deg: FloatArray
    extra_W_m2: FloatArray
    day_of_year: FloatArray


@dataclass(frozen=True)
class _Hours:
    """What light there was in each hour: its share of a clear sky's, and the diffuse part of it."""

    clear_share: FloatArray
    diffuse_share: FloatArray

    @classmethod
    def of(cls, sky: Sky, light: Mapping[str, FloatArray], site: Site) -> _Hours:
        recorded = light[GLOBAL if GLOBAL in light else PANELS]
        known = np.isfinite(recorded) & sky.is_up
        clear, seen = (sky.by_hour(each, known) for each in (sky.global_W_m2, recorded))
        is_told = np.isfinite(seen) & (clear > 0.0)
        at = _At(*(sky.by_hour(each, known)[is_told] for each in sky.stands))
        told = seen[is_told] if GLOBAL in light else _from_panels(seen[is_told], at, site)
        share = np.clip(told / clear[is_told], 0.0, MOST_CLEAR)
        if GLOBAL in light and DIFFUSE in light:
            under = sky.by_hour(light[DIFFUSE], known & np.isfinite(light[DIFFUSE]))[is_told]
            part = np.where(np.isfinite(under), _share(under, told), _by_disc(told, at))
        else:
            part = (_by_disc if GLOBAL in light else _by_erbs)(told, at)
        return cls(_filled(share, is_told), _filled(part, is_told))


def _filled(told: FloatArray, is_told: np.ndarray) -> FloatArray:
    places = np.flatnonzero(is_told)
    return np.asarray(np.interp(np.arange(len(is_told)), places, told)) if len(places) else np.zeros(len(is_told))


def _by_disc(total: FloatArray, at: _At) -> FloatArray:
    from pvlib.irradiance import disc

    direct = np.asarray(disc(total, at.zenith_deg, at.day_of_year)["dni"]) * np.cos(np.radians(at.zenith_deg))
    return _share(total - direct, total)


def _by_erbs(total: FloatArray, at: _At) -> FloatArray:
    from pvlib.irradiance import erbs_driesse

    diffuse = np.asarray(erbs_driesse(total, at.zenith_deg, dni_extra=at.extra_W_m2)["dhi"])
    return _share(diffuse, total)


def _share(part: FloatArray, total: FloatArray) -> FloatArray:
    return np.asarray(np.clip(np.divide(part, total, out=np.ones(len(total)), where=total > 0.0), 0.0, 1.0))


def _from_panels(power_W: FloatArray, at: _At, site: Site) -> FloatArray:
    """Return the light on level ground from the power of panels."""
    from pvlib import irradiance

    # the name of the same function before pvlib 0.15.2
    to_level = getattr(irradiance, "ghi_from_poa_driesse_2024", None) or irradiance.ghi_from_poa_driesse_2023
    assert site.panels_peak_W
    plane = STANDARD_W_M2 * np.clip(power_W, 0.0, None) / (PANELS_YIELD * site.panels_peak_W)
    lie = site.panels_tilt_deg, site.panels_azimuth_deg
    found = to_level(*lie, at.zenith_deg, at.azimuth_deg, plane, dni_extra=at.extra_W_m2, albedo=ALBEDO)
    return np.asarray(np.nan_to_num(found))


# --- sky ----------------------------------------------------------------------------------------------


def _sky(time: pd.DatetimeIndex, interval_s: float, site: Site) -> Sky:
    import pandas as pd
    from pvlib.clearsky import simplified_solis
    from pvlib.irradiance import get_extra_radiation
    from pvlib.solarposition import get_solarposition

    zone_h = _zone_h(site, time[0])
    longitude = zone_h * DEG_PER_H if site.longitude is None else site.longitude
    middle = (time - pd.Timedelta(seconds=0.5 * interval_s + 3600.0 * zone_h)).tz_localize("UTC")
    sun = get_solarposition(middle, site.latitude, longitude, site.altitude)
    clear = simplified_solis(sun["apparent_elevation"])
    hour = (middle.as_unit("s").asi8 // 3600).astype(int)
    day = middle.day_of_year.to_numpy()
    columns: list[Any] = [sun["apparent_zenith"], sun["azimuth"], get_extra_radiation(day), day]
    columns += [clear[name].fillna(0.0) for name in ("ghi", "dhi", "dni")]  # none below the horizon
    zenith, azimuth, extra, of_year, total, diffuse, direct = (np.asarray(each, dtype=float) for each in columns)
    return Sky(zenith, azimuth, extra, of_year, total, diffuse, direct, hour - hour[0])


def _heat_W(
    room: LinearRoom,
    sky: Sky,
    time: pd.DatetimeIndex,
    interval_s: float,
    light: tuple[FloatArray, FloatArray, FloatArray],
    model: str,
) -> FloatArray:
    import pandas as pd

    begins = time[0] - pd.Timedelta(seconds=interval_s)
    before = round((begins - begins.normalize()).total_seconds() / interval_s)  # weather begins at midnight
    irradiance = {
        name: np.pad(_on_facade(facade, sky, light, model), (before, 0)) for name, facade in room.facades.items()
    }
    mild = np.full(before + len(time), 10.0)
    return sun_W(room, WeatherRecord(interval_s, str(begins.date()), mild, irradiance, sky_C=mild))[before:]


def _on_facade(facade: Facade, sky: Sky, light: tuple[FloatArray, FloatArray, FloatArray], model: str) -> FloatArray:
    """Return what light, global, diffuse and direct, gives to a facade (n,), as its panes count it.

    That of a low sun is even.
    """
    from pvlib.irradiance import aoi, get_total_irradiance

    total, diffuse, direct = light
    lie = facade.tilt_deg, facade.azimuth_deg
    up = sky.is_up
    around = 0.5 * (1.0 + np.cos(np.radians(facade.tilt_deg)))
    even = diffuse_through_glass(facade.panes)
    found = np.asarray(total * (around + ALBEDO * (1.0 - around))) * even
    if not up.any():  # of no sun at all pvlib's spline makes an error
        return found
    at = sky.zenith_deg[up], sky.azimuth_deg[up], direct[up], total[up], diffuse[up]
    parts = get_total_irradiance(*lie, *at, dni_extra=sky.extra_W_m2[up], albedo=ALBEDO, model=model)
    angle_deg = np.asarray(aoi(*lie, *at[:2]))
    passed = parts["poa_direct"] * through_glass(facade.panes, angle_deg) + parts["poa_diffuse"] * even
    found[up] = np.nan_to_num(passed)
    return found


def _zone_h(site: Site, at: pd.Timestamp) -> float:
    """Return how far the record's clock, local standard time, is ahead of UTC."""
    if site.timezone is not None:
        return standard_ahead(zone_of(site.timezone), at.to_pydatetime()).total_seconds() / 3600.0
    return 0.0 if site.longitude is None else float(round(site.longitude / DEG_PER_H))
