"""The sun's position and what reaches a facade, both by pvlib."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from waxstudy.plugin import Facade, FloatArray, Parameters, parameter
from waxstudy.plugin.glass import diffuse_through_glass, through_glass

if TYPE_CHECKING:
    import pandas as pd

# Below this height an hourly mean no longer tells where its light came from, and the ratio of facade to
# horizontal diverges; buildings and trees hide such a sun anyway.
LOW_SUN_DEG = 3.0


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
