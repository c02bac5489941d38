"""When a cause acts: of those that come and go, the hours since the record began."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy_effects.controller import ALL_DAY_H, lasting_h
from waxstudy_trials.family import Channels

HOUR_S, DAY_H = 3600.0, 24.0
SUNNY = 0.1  # of the most sun of the record, from which on it counts

Values = Mapping[str, float]
Spans = list[tuple[float, float]]
# values, channels, hours since the record began at the middle of each step -> in which steps it acts
Acts = Callable[[Values, Channels, FloatArray], np.ndarray]


def daily(*hours: tuple[float, float]) -> Acts:
    """Return what acts from one hour of the day to another, the next day's where that is earlier."""

    def acts(values: Values, channels: Channels, hour: FloatArray) -> np.ndarray:
        return _between(hour, *hours)

    return acts


def _between(hour: FloatArray, *hours: tuple[float, float]) -> np.ndarray:
    found = [(hour - begin) % DAY_H < (end - begin) % DAY_H for begin, end in hours]
    return np.asarray(np.any(found, axis=0))


def _window(values: Values, channels: Channels, hour: FloatArray) -> np.ndarray:
    begin = values["from_h"]
    return _between(hour, (begin, values["to_h"] if "to_h" in values else begin + values["hours"]))


def _aimed(values: Values, channels: Channels, hour: FloatArray) -> np.ndarray:
    length_h = lasting_h(values["from_h"], values["to_h"])
    return np.asarray((hour - values["from_h"]) % DAY_H < (length_h if length_h < ALL_DAY_H else DAY_H))


def _paused(values: Values, channels: Channels, hour: FloatArray) -> np.ndarray:
    return np.asarray(hour % 2.0 < values["pause_s"] / HOUR_S)


def _lit(values: Values, channels: Channels, hour: FloatArray) -> np.ndarray:
    return np.asarray(_between(hour, (18.0, 22.0)) & (channels["outdoor_C"] < -2.0))


def _frost(values: Values, channels: Channels, hour: FloatArray) -> np.ndarray:
    return np.asarray(channels["outdoor_C"] < -4.0)


def _sunny(values: Values, channels: Channels, hour: FloatArray) -> np.ndarray:
    if "peak_K" in values:
        return _between(hour, (13.0, 17.0))
    sun_W = channels["solar_gain_W"]
    return np.asarray(sun_W > SUNNY * sun_W.max())


def _second_half(values: Values, channels: Channels, hour: FloatArray) -> np.ndarray:
    return np.asarray(hour >= 0.5 * (hour[0] + hour[-1]))


ACTS: Mapping[str, Acts] = {
    "window-opening": _window,
    "setpoint-offset": _aimed,
    "weak-at-night": daily((17.0, 23.0)),
    "pump-pauses": _paused,
    "stove": _lit,
    "open-door": daily((12.0, 13.5), (17.5, 19.0)),
    "cold-ventilation": _frost,
    "sunlit-sensor": _sunny,
    "air-lock": _second_half,
}


def when(name: str, values: Values, channels: Channels, step_s: float) -> Spans | None:
    """Return from when to when a cause acts [h since the record began], None where it is always there."""
    if name not in ACTS:
        return None
    hour = np.asarray((np.arange(len(channels["outdoor_C"])) + 0.5) * step_s / HOUR_S, dtype=float)
    acts = ACTS[name](values, channels, hour)
    edges = np.flatnonzero(np.diff(acts, prepend=False, append=False))
    edges_h = np.round(edges * step_s / HOUR_S, 3).tolist()
    return list(zip(edges_h[::2], edges_h[1::2], strict=True))


def whens(causes: Sequence[Mapping[str, Any]], channels: Channels, step_s: float) -> list[Spans | None]:
    """Return the same of every cause of a scene."""
    return [when(each["name"], each["values"], channels, step_s) for each in causes]
