"""The sun's heat under a clear sky, from where a room is: by pvlib, on the facades of the believed room."""

from __future__ import annotations

from datetime import datetime, timedelta
from typing import TYPE_CHECKING
from zoneinfo import ZoneInfo

import numpy as np

from waxstudy.plugin import FloatArray, LinearRoom, WeatherRecord
from waxstudy.simulation.recorded import sun_W

if TYPE_CHECKING:
    import pandas as pd

    from waxstudy.dataset.tables import Site

DEG_PER_H = 15.0
ALBEDO = 0.2


def clear_sky_W(room: LinearRoom, time: pd.DatetimeIndex, interval_s: float, site: Site) -> FloatArray:
    """Return what the sun of a clear sky gives to all nodes of a room (n,) [W], at the middle of each interval.

    The sky is the simplified Solis model (Ineichen 2008, doi:10.1016/j.solener.2007.09.002), the light from it even.
    """
    import pandas as pd
    from pvlib.clearsky import simplified_solis
    from pvlib.irradiance import get_total_irradiance
    from pvlib.solarposition import get_solarposition

    zone_h = _zone_h(site)
    longitude = zone_h * DEG_PER_H if site.longitude is None else site.longitude
    middle = (time - pd.Timedelta(seconds=0.5 * interval_s + 3600.0 * zone_h)).tz_localize("UTC")
    sun = get_solarposition(middle, site.latitude, longitude, site.altitude)
    sky = simplified_solis(sun["apparent_elevation"])
    light = sun["apparent_zenith"], sun["azimuth"], sky["dni"], sky["ghi"], sky["dhi"]
    on = {
        name: get_total_irradiance(facade.tilt_deg, facade.azimuth_deg, *light, albedo=ALBEDO)["poa_global"]
        for name, facade in room.facades.items()
    }
    irradiance = {name: values.fillna(0.0).to_numpy() for name, values in on.items()}  # none below the horizon
    mild = np.full(len(time), 10.0)
    return sun_W(room, WeatherRecord(interval_s, str(time[0].date()), mild, irradiance, sky_C=mild))


def _zone_h(site: Site) -> float:
    """Return how far the record's clock, local standard time, is ahead of UTC."""
    if site.timezone is not None:
        there = datetime(2001, 1, 1, tzinfo=ZoneInfo(site.timezone))
        return ((there.utcoffset() or timedelta()) - (there.dst() or timedelta())).total_seconds() / 3600.0
    return 0.0 if site.longitude is None else float(round(site.longitude / DEG_PER_H))
