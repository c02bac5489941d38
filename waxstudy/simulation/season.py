"""Which days of a weather are heating days: given, or found from the outdoor temperature."""

from __future__ import annotations

import numpy as np

from waxstudy.plugin import FloatArray, WeatherRecord
from waxstudy.results.kpis import BoolArray
from waxstudy.study.model import Season

DAY_S = 86400.0
KEPT = 0.8  # of the running mean from one day to the next: EN 16798-1, annex B
BEFORE_DAYS = 7  # whose mean stands in for the days before the record


def heating(weather: WeatherRecord, season: Season) -> BoolArray:
    """Return whether each interval (n,) lies in a heating day; raise `ValueError` if none does."""
    of_day = round(DAY_S / weather.interval_s)
    days = _given(weather, season) if season.first_day else running_mean_C(weather) < season.limit_C
    if not days.any():
        raise ValueError(_why_none(weather, season))
    return np.repeat(days, of_day)[: len(weather.outdoor_C)]


def running_mean_C(weather: WeatherRecord) -> FloatArray:
    """Return the exponentially weighted mean outdoor temperature of the days before each day (days,)."""
    of_day = round(DAY_S / weather.interval_s)
    starts = range(0, len(weather.outdoor_C), of_day)
    daily_C = np.array([weather.outdoor_C[first : first + of_day].mean() for first in starts])
    means = [float(daily_C[:BEFORE_DAYS].mean())]
    for day_C in daily_C[:-1]:
        means.append(KEPT * means[-1] + (1.0 - KEPT) * float(day_C))
    return np.array(means)


def _given(weather: WeatherRecord, season: Season) -> BoolArray:
    """Whether each day lies from the first to the last one; a season may pass the turn of the year."""
    first, last = str(season.first_day), str(season.last_day)
    count = int(np.ceil(weather.duration_s / DAY_S))
    names = np.array([str(day)[5:] for day in np.datetime64(weather.first_day) + np.arange(count)])
    after, before = names >= first, names <= last
    return np.asarray(after & before if first <= last else after | before)


def _why_none(weather: WeatherRecord, season: Season) -> str:
    if season.first_day:
        days = f"{weather.duration_s / DAY_S:g} days from {weather.first_day[5:]}"
        return f"no heating day: its {days} do not reach {season.first_day} to {season.last_day}"
    coldest_C = float(running_mean_C(weather).min())
    return f"no heating day: the running mean outdoor temperature is {coldest_C:.1f} C at the least, not below limit_C"
