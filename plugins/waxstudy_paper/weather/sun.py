"""The sun's position and what reaches a facade, both by pvlib."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from waxstudy.plugin import Facade, FloatArray, Parameters, parameter

if TYPE_CHECKING:
    import pandas as pd

# Below this height an hourly mean no longer tells where its light came from, and the ratio of facade to
# horizontal diverges; buildings and trees hide such a sun anyway.
LOW_SUN_DEG = 3.0

GLASS_REFRACTION = 1.526
PANE_ABSORPTION = 0.09  # exponent of 3 mm of clear float glass at normal incidence


class SunParameters(Parameters):
    """What every weather with a sun needs to know of the facades' surroundings."""

    albedo: float = parameter(
        0.2,
        unit="1",
        description="reflectance of the ground in front of the facades; 0.6 to 0.8 with snow",
        source="chosen: the usual value without snow; the paper does not speak of snow, and a file's is not used",
        ge=0.0,
        le=1.0,
    )


@dataclass(frozen=True)
class Sun:
    """The sun at some instants: position (refraction included) and irradiance outside the atmosphere."""

    zenith_deg: FloatArray
    azimuth_deg: FloatArray  # from north, clockwise
    extraterrestrial_W_m2: FloatArray  # on a surface that faces the sun


@dataclass(frozen=True)
class Sky:
    """Irradiance at the ground: direct on a surface that faces the sun, diffuse and global on a horizontal one."""

    direct_normal_W_m2: FloatArray
    diffuse_horizontal_W_m2: FloatArray
    global_horizontal_W_m2: FloatArray


def sun_at(times: pd.DatetimeIndex, latitude_deg: float, longitude_deg: float) -> Sun:
    """Return the sun at `times` (with time zone) by NREL's solar position algorithm (Reda and Andreas 2004)."""
    from pvlib import irradiance, solarposition

    position = solarposition.get_solarposition(times, latitude_deg, longitude_deg)
    return Sun(
        zenith_deg=position["apparent_zenith"].to_numpy(),
        azimuth_deg=position["azimuth"].to_numpy(),
        extraterrestrial_W_m2=irradiance.get_extra_radiation(times.day_of_year.to_numpy()),
    )


def clear_sky(sun: Sun, linke_turbidity: float) -> Sky:
    """Return the cloudless sky at sea level by Ineichen and Perez (2002); dark while the sun is down."""
    from pvlib import atmosphere, clearsky

    direct, diffuse, total = np.zeros((3, len(sun.zenith_deg)))
    up = sun.zenith_deg < 90.0
    zenith_deg = sun.zenith_deg[up]
    sky = clearsky.ineichen(
        zenith_deg,
        atmosphere.get_relative_airmass(zenith_deg),
        linke_turbidity,
        dni_extra=sun.extraterrestrial_W_m2[up],
    )
    direct[up], diffuse[up], total[up] = sky["dni"], sky["dhi"], sky["ghi"]
    return Sky(direct, diffuse, total)


def overcast_sky(clear: Sky, transmittance: float) -> Sky:
    """Return a closed cloud cover: `transmittance` of the clear sky's global irradiance, all of it diffuse."""
    total = transmittance * clear.global_horizontal_W_m2
    return Sky(np.zeros_like(total), total, total)


def on_facade(facade: Facade, sun: Sun, sky: Sky, albedo: float) -> FloatArray:
    """Return the global irradiance on a facade [W/m2]: direct, diffuse from the sky, reflected by the ground.

    I = M(theta) I_dn max(cos(theta), 0) + M_d (I_sky + albedo I_gh (1 - cos(tilt)) / 2)

    I_sky is the anisotropic sky of Perez et al. (1990) in the form of Driesse et al. (2024), whose coefficients
    run on smoothly from one sky to the next. While the sun is lower than `LOW_SUN_DEG`, the global horizontal
    irradiance is taken to come evenly from the whole sky. M is `through_glass` for the facade's panes, M_d its
    mean over the hemisphere, both 1 without panes.
    """
    from pvlib import irradiance

    cos_tilt = np.cos(np.radians(facade.tilt_deg))
    ground = albedo * sky.global_horizontal_W_m2 * (1.0 - cos_tilt) / 2.0
    diffuse = diffuse_through_glass(facade.panes)
    total: FloatArray = (sky.global_horizontal_W_m2 * (1.0 + cos_tilt) / 2.0 + ground) * diffuse
    up = sun.zenith_deg < 90.0 - LOW_SUN_DEG
    parts = irradiance.get_total_irradiance(
        facade.tilt_deg,
        facade.azimuth_deg,
        sun.zenith_deg[up],
        sun.azimuth_deg[up],
        dni=sky.direct_normal_W_m2[up],
        ghi=sky.global_horizontal_W_m2[up],
        dhi=sky.diffuse_horizontal_W_m2[up],
        dni_extra=sun.extraterrestrial_W_m2[up],
        albedo=albedo,
        model="perez-driesse",
    )
    if facade.panes == 0:
        total[up] = parts["poa_global"]
        return total
    angle_deg = irradiance.aoi(facade.tilt_deg, facade.azimuth_deg, sun.zenith_deg[up], sun.azimuth_deg[up])
    total[up] = parts["poa_direct"] * through_glass(facade.panes, angle_deg) + parts["poa_diffuse"] * diffuse
    return total


def through_glass(panes: int, angle_deg: FloatArray) -> FloatArray:
    """Return what panes of clear glass let through at an angle of incidence, relative to normal incidence.

    tau = exp(-0.09 N / cos(theta')) mean((1 - r) / (1 + (2 N - 1) r))   over both polarisations

    with the reflectances r of a surface by Fresnel and theta' the angle in the glass (n = 1.526). It is used for g
    as a whole. Source: Duffie and Beckman, Solar Engineering of Thermal Processes, chapter 5. 0 behind the glass.
    """
    if panes == 0:
        return np.ones_like(angle_deg)
    angle = np.radians(np.clip(angle_deg, 0.01, 89.99))
    relative: FloatArray = _transmittance(panes, angle) / _transmittance(panes, np.radians(0.01))
    return np.where(np.asarray(angle_deg) < 90.0, relative, 0.0)


def _transmittance(panes: int, angle: FloatArray | float) -> FloatArray:
    inside = np.arcsin(np.sin(angle) / GLASS_REFRACTION)
    across = (np.sin(inside - angle) / np.sin(inside + angle)) ** 2
    along = (np.tan(inside - angle) / np.tan(inside + angle)) ** 2
    passed = sum((1.0 - r) / (1.0 + (2 * panes - 1) * r) for r in (across, along)) / 2.0
    return np.asarray(passed * np.exp(-PANE_ABSORPTION * panes / np.cos(inside)))


def diffuse_through_glass(panes: int) -> float:
    """Return the mean of `through_glass` over light that comes evenly from the hemisphere."""
    angle_deg = np.arange(0.5, 90.0)
    weight = np.sin(2.0 * np.radians(angle_deg))
    return float(np.average(through_glass(panes, angle_deg), weights=weight))
