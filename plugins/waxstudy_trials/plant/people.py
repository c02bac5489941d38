"""The people of a house: gains that are no day as they are assumed to be every day."""

from __future__ import annotations

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy_trials.as_built import EVERY_DAY
from waxstudy_trials.plant.weather import DAY_PARTS, PART_S, Weather


def lived_in(weather: Weather, seed: int) -> Weather:
    """Return the weather with the gains of people whose days differ, by what they are assumed to be every day."""
    random = np.random.default_rng([seed, 1])
    days = len(weather.gains_W) // DAY_PARTS
    found = weather.gains_W.reshape(days, DAY_PARTS)
    lived = [_day(each, random) for each in found]
    return weather._replace(gains_W=np.concatenate(lived))


def _day(gains_W: FloatArray, random: np.random.Generator) -> FloatArray:
    factor, later_h = (EVERY_DAY[name].drawn(random) for name in ("gains", "gains_later_h"))
    return factor * later(gains_W, later_h)


def later(gains_W: FloatArray, hours: float) -> FloatArray:
    """Return gains by so much later, to a quarter of an hour; what comes after the end is at the beginning."""
    return np.roll(gains_W, round(hours * 3600.0 / PART_S))
