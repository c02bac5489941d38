"""Measuring a reality: sampling, noise, resolution, range and gaps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from zlib import crc32

import numpy as np
import pandas as pd

from waxstudy.dataset.channels import CHANNELS, Channel
from waxstudy.plugin import FloatArray
from waxstudy.study.model import is_multiple
from waxstudy.synthetic.simulate import Reality, RealityError

GAP_S = 1800.0  # mean length of a gap
DECIMALS = 6  # of a channel without a resolution


@dataclass(frozen=True)
class Instruments:
    """What is measured, how often and how well; what is not named is as in the channel table."""

    interval_s: float = 60.0
    without: Sequence[str] = ()
    noise: Mapping[str, float] = field(default_factory=dict)
    resolution: Mapping[str, float] = field(default_factory=dict)
    missing: float = 0.0  # share of the samples, at most a half
    seed: int = 1

    def chosen(self, sources: Mapping[str, FloatArray]) -> list[Channel]:
        """Return the channels to write: all whose source is told, but those left out."""
        return [each for each in CHANNELS.values() if each.source in sources and each.name not in self.without]

    def noise_of(self, channel: Channel) -> float:
        return self.noise.get(channel.name, channel.noise)

    def random(self, purpose: str) -> np.random.Generator:
        """Return random numbers of their own for each purpose, whatever else is drawn."""
        return np.random.default_rng([self.seed, crc32(purpose.encode())])


def measure(reality: Reality, instruments: Instruments) -> pd.DataFrame:
    """Return the rows of data.csv; raise `RealityError`."""
    return rows(reality.week.channels, reality.week.step_s, reality.first_day, instruments)


def rows(sources: Mapping[str, FloatArray], step_s: float, first_day: str, instruments: Instruments) -> pd.DataFrame:
    """Return what instruments show of `Channel.source` -> values at the end of every step; raise `RealityError`."""
    interval_s = instruments.interval_s
    if not is_multiple(interval_s, of=step_s):
        raise RealityError(f"an interval of {interval_s:g} s is no multiple of the study's step_s = {step_s:g}")
    length = round(interval_s / step_s)
    count = len(sources["air_C"]) // length
    if count < 2:
        raise RealityError(f"the record is shorter than two intervals of {interval_s:g} s")
    lost = gaps(count, interval_s, instruments.missing, instruments.random("gaps"))
    columns: dict[str, object] = {"time": _stamps(first_day, interval_s, count)}
    for channel in instruments.chosen(sources):
        values = sampled(channel, sources[channel.source], length)
        values = _read(channel, values, instruments)
        columns[channel.name] = values if channel.is_assumed else np.where(lost, np.nan, values)
    return pd.DataFrame(columns)


def sampled(channel: Channel, values: FloatArray, length: int) -> FloatArray:
    """Return a channel over intervals of `length` steps: its mean, or its last value."""
    rows = values[: len(values) // length * length].reshape(-1, length)
    return np.asarray(rows.mean(axis=1) if channel.is_mean else rows[:, -1])


def _read(channel: Channel, values: FloatArray, instruments: Instruments) -> FloatArray:
    """Return what the instrument shows: with noise, within its range, in steps of its resolution."""
    random = instruments.random(channel.name)
    noise, step = instruments.noise_of(channel), instruments.resolution.get(channel.name, channel.resolution)
    if noise > 0.0:
        seen = np.clip(values + random.normal(0.0, noise, len(values)), channel.low, channel.high)
        values = np.where(channel.is_quiet_at_zero & (values == 0.0), values, seen)
    if step > 0.0:
        values = np.round(values / step) * step
    return np.round(values, DECIMALS) + 0.0  # no negative zero


def gaps(count: int, interval_s: float, share: float, random: np.random.Generator) -> np.ndarray:
    """Return which samples are lost: exactly `share` of them, in gaps of half an hour on average."""
    lost = np.zeros(count, dtype=bool)
    wanted = round(share * count)
    mean = max(1.0, GAP_S / interval_s)
    while (left := wanted - int(lost.sum())) > 0:
        first = int(random.integers(count))
        lost[first : first + min(left, int(random.geometric(1.0 / mean)))] = True
    return lost


def _stamps(first_day: str, interval_s: float, count: int) -> list[str]:
    start = datetime.fromisoformat(first_day)
    return [(start + timedelta(seconds=interval_s * (n + 1))).isoformat() for n in range(count)]
