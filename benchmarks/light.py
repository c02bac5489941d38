"""What light or panels tell of the sun in a room: `python -m benchmarks.light WEATHER.epw`.

The sun that the room of table5.toml has in three weeks of January, February and March, by the weather file, beside what
follows from the file's light on level ground, from that and its diffuse part, and from the power of panels.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd
from pvlib.iotools import read_epw

from benchmarks.self_consistency_records import study
from waxstudy.dataset.channels import DIFFUSE, GLOBAL, PANELS
from waxstudy.dataset.sunlight import PANELS_YIELD, STANDARD_W_M2, recorded_sun_W
from waxstudy.dataset.tables import Site
from waxstudy.diagnosis.model.room_response import built
from waxstudy.plugin import Choice, Facade, FloatArray, Weather
from waxstudy.plugin.registry import installed
from waxstudy.simulation.recorded import sun_W

STARTS, DAYS, PEAK_W = ("01-05", "02-05", "03-05"), 21, 5000.0
PER_H = 4  # samples
LEVEL, PLANE = Facade(180.0, tilt_deg=0.0), Facade(180.0, tilt_deg=35.0)


def by_day(values: FloatArray) -> FloatArray:
    return np.asarray(values.reshape(DAYS, -1).mean(axis=1))


def main(path: str) -> None:
    data, place = read_epw(path)
    zone = f"Etc/GMT{-round(place['TZ']):+d}"
    site = Site(latitude=place["latitude"], longitude=place["longitude"], timezone=zone, panels_peak_W=PEAK_W)
    room = built(study().room)
    epw = installed().components["weather", "epw"].component
    assert issubclass(epw, Weather)
    print(f"{'from':8}{'recorded':20}{'sun W':>8}{'told W':>8}{'ratio':>8}{'days differ by':>16}")
    for start in STARTS:
        chosen = Choice.of(epw, {"path": str(Path(path).resolve()), "start": start, "days": DAYS})
        weather = epw.load(chosen.parameters, {**room.facades, "level": LEVEL, "plane": PLANE})
        month, day = map(int, start.split("-"))
        first = int(np.flatnonzero((data["month"] == month) & (data["day"] == day))[0])
        diffuse = data["dhi"].to_numpy(dtype=float)[first : first + 24 * DAYS]
        level, plane = (weather.irradiance_W_m2[name] for name in ("level", "plane"))
        power_W = PANELS_YIELD * PEAK_W / STANDARD_W_M2 * plane
        time = pd.date_range(f"2001-{start}", periods=24 * DAYS * PER_H, freq="15min") + pd.Timedelta("15min")
        sun = np.repeat(sun_W(room, weather), PER_H)
        for name, light in (
            ("light", {GLOBAL: level}),
            ("light, its diffuse part", {GLOBAL: level, DIFFUSE: diffuse}),
            ("panels", {PANELS: power_W}),
        ):
            samples = {channel: np.repeat(values, PER_H) for channel, values in light.items()}
            told = recorded_sun_W(room, time, 3600.0 / PER_H, site, samples)
            spread = float(np.std(np.log(by_day(told) / by_day(sun))))
            print(f"{start:8}{name:24}{sun.mean():4.0f}{told.mean():8.0f}{told.mean() / sun.mean():8.2f}{spread:16.2f}")


if __name__ == "__main__":
    main(sys.argv[1])
