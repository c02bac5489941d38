"""Weather, gains, wind and the other circuits of a plant, each second's value held over a quarter of an hour."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from waxstudy.plugin import FloatArray

PART_S = 900
DAY_PARTS = 96
LATITUDE_DEG = 59.4
SOLAR_W_M2 = 1361.0
PANES = ((180.0, 0.5), (270.0, 0.5))  # azimuth -> share of the panes
G = 0.30


class Weather(NamedTuple):
    """What drives a plant, one value per quarter of an hour (n,)."""

    outdoor_C: FloatArray
    sun_W: FloatArray  # through the panes
    gains_W: FloatArray
    wind: FloatArray  # 0 to 1
    others: FloatArray  # share of the other circuits that is open
    supply_C: FloatArray
    neighbour_C: FloatArray


def weather(random: np.random.Generator, days: int, mean_C: float, gains_W: float, window_m2: float) -> Weather:
    """Return the weather of some days from midnight on; supply by a heating curve, the gains' hours by a household."""
    count = days * DAY_PARTS
    hour = (np.arange(count) + 0.5) / DAY_PARTS * 24.0
    clear = np.clip(_wandering(random, count, 20.0) * 0.45 + 0.3, 0.0, 1.0)
    swing_K = 0.5 * (1.5 + 5.0 * clear) * np.cos(2.0 * np.pi * (hour - 14.0) / 24.0)
    outdoor_C = mean_C - 2.0 * (clear - 0.3) + 3.0 * _wandering(random, count, 36.0) + swing_K
    sun_W = G * window_m2 * _irradiance(random, hour, clear)
    supply_C = np.clip(np.interp(outdoor_C, [-22.0, 20.0], [34.0, 22.0]), 22.0, 34.0)
    others = np.clip(0.5 + 0.35 * _wandering(random, count, 1.5), 0.0, 1.0)
    wind = np.clip(0.4 + 0.5 * _wandering(random, count, 8.0), 0.0, 1.0)
    neighbour_C = 20.5 + 0.8 * _wandering(random, count, 24.0)
    return Weather(outdoor_C, sun_W, gains_W * _household(hour), wind, others, supply_C, neighbour_C)


def _wandering(random: np.random.Generator, count: int, memory_h: float) -> FloatArray:
    """Return a first-order autoregressive course of unit variance."""
    keeps = float(np.exp(-PART_S / 3600.0 / memory_h))
    steps = random.normal(0.0, np.sqrt(1.0 - keeps**2), count)
    steps[0] = random.normal()
    found = np.empty(count)
    last = 0.0
    for place, step in enumerate(steps):
        last = keeps * last + step
        found[place] = last
    return found


def _irradiance(random: np.random.Generator, hour: FloatArray, clear: FloatArray) -> FloatArray:
    """Return the mean irradiance of the panes [W/m2]: Meinel's beam through broken clouds, and diffuse light."""
    declination = np.radians(-20.0 + float(random.uniform(-2.0, 8.0)) + 0.25 * hour / 24.0)
    latitude, angle = np.radians(LATITUDE_DEG), np.radians(15.0 * (hour - 12.0))
    high = np.sin(latitude) * np.sin(declination) + np.cos(latitude) * np.cos(declination) * np.cos(angle)
    is_up = high > 0.02
    height = np.where(is_up, high, 1.0)
    beam = np.where(is_up, SOLAR_W_M2 * 0.7 ** (height**-0.678), 0.0) * clear
    azimuth = (
        np.arctan2(np.sin(angle), np.cos(angle) * np.sin(latitude) - np.tan(declination) * np.cos(latitude)) + np.pi
    )
    total = np.where(is_up, 60.0 * height**0.5, 0.0)
    for facing_deg, share in PANES:
        total = total + share * beam * np.sqrt(1.0 - high**2) * np.maximum(
            0.0, np.cos(azimuth - np.radians(facing_deg))
        )
    return np.asarray(total)


def _household(hour: FloatArray) -> FloatArray:
    """Return factors of mean 1: quiet nights, a peak in the morning, a broad one of an evening."""
    at = hour % 24.0
    shape = 0.6 + 0.7 * np.exp(-(((at - 7.5) / 1.2) ** 2)) + 1.3 * np.exp(-(((at - 19.5) / 2.5) ** 2))
    return np.asarray(shape / shape.mean())
