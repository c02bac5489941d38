"""Samples of one channel: what no instrument can have meant, what is missing, and values that stand still."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd

from waxstudy.dataset.channels import CHANNELS
from waxstudy.dataset.checks.check import TEMPERATURES, Discard, Findings, Record, Warn, check, each, quantity_of
from waxstudy.dataset.columns import CODE
from waxstudy.dataset.limits import (
    ABOVE_K,
    BOILING_C,
    BOUNDS,
    CLIPPED_COUNT,
    CLIPPED_FACTOR,
    CLIPPED_SHARE,
    COARSE_K,
    CODES,
    CODES_ABOVE,
    CONTINUOUS,
    FAILED_SHARE,
    FAR_ABOVE,
    FAR_JUMP,
    FEW_IMPOSSIBLE,
    LEVEL_NOISE,
    MOVING,
    NEAR_ZERO_K,
    PEAKS,
    POWER_ON_C,
    RARE,
    RAREST,
    SPIKES_K,
    STILL_COARSE_H,
    STILL_H,
    STUCK_COARSE_H,
    STUCK_H,
    USUALLY,
)
from waxstudy.dataset.resolution import step
from waxstudy.plugin import FloatArray

HOUR_S = 3600.0  # between samples, in which a temperature may change by as much again
NAMED = 3  # channels that a sentence lists
STEADY = ("ventilation_supply_temperature_C",)  # what a controller may hold

WATER = ("supply_temperature_C", "return_temperature_C")  # what may be switched
MEASURED = [(name,) for name, channel in CHANNELS.items() if not channel.is_assumed]
MOVING_ONES = [names for names in TEMPERATURES if names in MEASURED and names[0] not in STEADY]
MEASURED_TEMPERATURES = [names for names in TEMPERATURES if names in MEASURED]
faulty = partial(check, "samples", "discards", fewest=0, mend="leave it out of the file, or leave it as it is")
INSTRUMENT = "look at the instrument; leave the channel out"
moving = partial(check, "course", "warns", fewest=0, mend=INSTRUMENT)


@faulty(*each())
def code(record: Record, channel: pd.Series) -> Findings:
    """A code that loggers write for a missing sample, such as -999 or 9999; of a temperature also {POWER_ON_C:g} °C,
    if nothing else is within {ABOVE_K:g} K below it, and indoors 0 °C, if nothing else is within {NEAR_ZERO_K:g} K.
    Flows and gains may be as large: there a positive code is one if it is over {FAR_ABOVE:g} times all else."""
    x = channel.to_numpy()
    others = x[np.isfinite(x) & ~np.isin(x, CODES_ABOVE)]
    is_far_above = len(others) > 0 and min(CODES_ABOVE) > FAR_ABOVE * float(np.max(others))
    is_code = quantity_of(channel) not in PEAKS or is_far_above
    yield Discard(channel.name, np.isin(x, (*CODES, *CODES_ABOVE) if is_code else CODES), CODE)
    if quantity_of(channel) in BOUNDS:
        yield Discard(channel.name, power_on(x), "what a 1-Wire thermometer shows until it has measured")
    if quantity_of(channel) == "indoor" and (channel.name,) in MEASURED:  # a setpoint of 0 is off
        yield Discard(channel.name, dropped(x), "0 C far from all else, as of a bus that failed")


def power_on(temperature_C: FloatArray) -> np.ndarray:
    """Return where a 1-Wire thermometer had not measured yet (n,): at 85 °C, with nothing else near that."""
    said = temperature_C == POWER_ON_C
    is_hot = np.isfinite(temperature_C) & (temperature_C > POWER_ON_C - ABOVE_K) & (temperature_C < BOILING_C) & ~said
    return np.asarray(said & ~is_hot.any())


def dropped(temperature_C: FloatArray) -> np.ndarray:
    """Return where a temperature was lost as 0 °C (n,), with nothing else near that."""
    zero = temperature_C == 0.0
    is_near = np.isfinite(temperature_C) & (np.abs(temperature_C) < NEAR_ZERO_K) & ~zero
    others = np.isfinite(temperature_C) & ~zero
    return zero if others.any() and not is_near.any() else np.zeros(len(zero), dtype=bool)


@faulty(*TEMPERATURES)
def impossible_sample(record: Record, channel: pd.Series) -> Findings:
    """A temperature outside {BOUNDS[indoor][0]:g} to {BOUNDS[indoor][1]:g} °C (water {BOUNDS[water][0]:g} to
    {BOUNDS[water][1]:g}, outdoors {BOUNDS[outdoor][0]:g} to {BOUNDS[outdoor][1]:g}), in at most {FEW_IMPOSSIBLE:.0%}
    of the samples: more of them are another quantity."""
    low, high = BOUNDS[quantity_of(channel)]
    outside = _outside(channel)
    if outside is not None:
        yield Discard(channel.name, outside, f"outside {low:g} to {high:g} C, which is impossible")


def _outside(channel: pd.Series) -> np.ndarray | None:
    """Return which samples of a temperature are impossible; None if they are too many."""
    low, high = BOUNDS[quantity_of(channel)]
    outside = ((channel < low) | (channel > high)).to_numpy()
    return outside if outside.sum() <= FEW_IMPOSSIBLE * channel.count() else None


@faulty(*TEMPERATURES)
def spike(record: Record, channel: pd.Series) -> Findings:
    """A single sample of a temperature that jumps away from both neighbours and back by over {SPIKES_K[indoor]:g} K
    (outdoors {SPIKES_K[outdoor]:g}, water {SPIKES_K[water]:g}; twice as much if samples are an hour apart)."""
    limit_K = SPIKES_K[quantity_of(channel)] * (1.0 + record.interval_s / HOUR_S)
    if _outside(channel) is not None:
        spikes = _jumps(channel.to_numpy(), limit_K)
        yield Discard(channel.name, spikes, f"more than {limit_K:.3g} K off both neighbours")


@faulty(*(names for names in MEASURED_TEMPERATURES if not (set(names) & {*STEADY, *WATER})))
def failed(record: Record, channel: pd.Series) -> Findings:
    """A temperature, but of water or supply air, which may be switched, that jumps to one exact value, stays there and
    jumps back, each time by over {SPIKES_K[indoor]:g} K (outdoors {SPIKES_K[outdoor]:g}; twice as much in an hour) and
    {FAR_JUMP:g} times as far as it ever moves else; in at most {FAILED_SHARE:.0%} of its samples."""
    limit_K = SPIKES_K[quantity_of(channel)]
    lost = _left(channel.to_numpy(), limit_K, record.interval_s)
    yield Discard(channel.name, lost, f"of one value, over {limit_K:g} K off what is before and after")


def _left(x: FloatArray, limit: float, interval_s: float) -> np.ndarray:
    """Return samples of values that are jumped to and from, over gaps by more than in a sample."""
    places = np.flatnonzero(np.isfinite(x))
    known, found = x[places], np.zeros(len(x), dtype=bool)
    moves = np.diff(known)
    is_far = np.abs(moves) > limit * (1.0 + np.diff(places) * interval_s / HOUR_S)
    visited = {known[first] for first, end in _visits(moves, is_far)}
    is_there = np.isin(known, [value for value in visited if (known == value).sum() <= FAILED_SHARE * len(known)])
    rest = np.abs(moves[~is_there[1:] & ~is_there[:-1]])
    if len(np.unique(known[~is_there])) >= CONTINUOUS:
        for first, end in _visits(moves, is_far & (np.abs(moves) > FAR_JUMP * rest.max(initial=0.0))):
            found[places[first:end]] |= is_there[first]
    return found


def _visits(moves: FloatArray, is_far: np.ndarray) -> list[tuple[int, int]]:
    """Return first sample and end of each run of one value between far moves of opposite sense."""
    runs = [(first, first + length + 1) for first, length in _runs(moves == 0.0)]
    inner = [(first, end) for first, end in runs if first > 0 and end <= len(moves)]
    far = np.where(is_far, np.sign(moves), 0.0)
    return [(first, end) for first, end in inner if far[first - 1] * far[end - 1] < 0.0]


def _jumps(x: FloatArray, limit: float) -> np.ndarray:
    """Return single samples that jump away and back."""
    found = np.zeros(len(x), dtype=bool)
    before, after = x[1:-1] - x[:-2], x[1:-1] - x[2:]
    with np.errstate(invalid="ignore"):
        found[1:-1] = (np.minimum(np.abs(before), np.abs(after)) > limit) & (np.sign(before) == np.sign(after))
    return found


@faulty(*each("flow", "gain"))
def peak(record: Record, channel: pd.Series) -> Findings:
    """A single sample of flow over {PEAKS[flow][0]:g} times what all but a few reach, or of a gain over
    {PEAKS[gain][0]:g} times and {PEAKS[gain][1]:g} W."""
    times, least = PEAKS[quantity_of(channel)]
    x = channel.to_numpy()
    known = np.sort(x[np.isfinite(x)])
    few = max(RAREST, round(RARE * len(known)))
    usual = float(known[-1 - few]) if len(known) > few else 0.0
    if usual > 0.0 and np.count_nonzero(known > 0.5 * usual) >= USUALLY:
        peaks = _jumps(x, 0.5 * times * usual) & (x > max(times * usual, least))
        yield Discard(channel.name, peaks, f"more than {times:g} times the usual {usual:.3g}, and alone")


@faulty(*each("level"))
def stray(record: Record, channel: pd.Series) -> Findings:
    """A level over {LEVEL_NOISE:g} beyond 0 to 1, in at most {RAREST} samples or {RARE:.1%} of them."""
    strays = ((channel < -LEVEL_NOISE) | (channel > 1.0 + LEVEL_NOISE)).to_numpy()
    if strays.sum() <= max(RAREST, RARE * channel.count()):
        yield Discard(channel.name, strays, "beyond 0 to 1, which is impossible")


@check("dead", "discards", *MOVING_ONES, fewest=0, mend=INSTRUMENT)
def still(record: Record, channel: pd.Series) -> Findings:
    """A temperature that stands still for over {STILL_H:g} h while another one moves; of room and water only with a
    resolution below {COARSE_K:g} K, outdoors with such a one for {STILL_COARSE_H:g} h. One that never changes may be
    meant so, as in a chamber."""
    x, resolution_K = channel.to_numpy(), _resolution(channel)
    is_coarse = resolution_K >= COARSE_K
    if not resolution_K or (is_coarse and channel.name != "outdoor_temperature_C"):
        return
    dead, longest_s = np.zeros(len(x), dtype=bool), 0.0
    for first, length in _runs(np.diff(x) == 0.0):
        lasting_s = length * record.interval_s
        is_long = lasting_s > HOUR_S * (STILL_COARSE_H if is_coarse else STILL_H)
        if is_long and _others_move(record.values, str(channel.name), first, length):
            dead[first + 1 : first + length + 1] = True
            longest_s = max(longest_s, lasting_s)
    yield Discard(channel.name, dead, f"of one value for up to {_duration(longest_s)} while other temperatures move")


@check("gaps", "warns", (), fewest=0, mend="none is needed: what is missing is not guessed")
def gaps(record: Record) -> Findings:
    """Samples that are missing, told once for all channels that miss the same."""
    values = record.values
    said: dict[tuple[int, int, int], list[str]] = {}
    for name in values.columns:
        lost = values[name].isna().to_numpy()
        if lost.any():
            said.setdefault((int(lost.sum()), *_longest(lost)), []).append(name)
    for (count, first, length), names in said.items():
        who = ", ".join(names) if len(names) <= NAMED else f"{len(names)} of {len(values.columns)} channels"
        are = f"{_percent(count, len(values))} of the samples are missing"
        lasting, end = _duration(length * record.interval_s), values.index[first + length - 1]
        yield Warn(f"{who}: {are}, at most {lasting} at once (ending {end})")


@moving(*MEASURED)
def constant(record: Record, channel: pd.Series) -> Findings:
    """A measured channel that never changes."""
    if channel.nunique() == 1:
        yield Warn(f"{channel.name} is {channel.dropna().iloc[0]:g} throughout")


@moving(*MEASURED_TEMPERATURES)
def stuck(record: Record, channel: pd.Series) -> Findings:
    """A temperature that stands still for over {STUCK_H:g} h ({STUCK_COARSE_H:g} h if its resolution is {COARSE_K:g} K
    or more) while another one moves."""
    x, values, resolution_K = channel.to_numpy(), record.values, _resolution(channel)
    first, length = _longest(np.diff(x) == 0.0)
    lasting_s = length * record.interval_s
    if not resolution_K or lasting_s <= HOUR_S * (STUCK_COARSE_H if resolution_K >= COARSE_K else STUCK_H):
        return
    if _others_move(values, str(channel.name), first, length):
        place = f"from {values.index[first]} for {_duration(lasting_s)}"
        yield Warn(f"{channel.name} is stuck at {x[first]:g} {place} while other temperatures move")


@moving(*MEASURED_TEMPERATURES)
def clipped(record: Record, channel: pd.Series) -> Findings:
    """A temperature with {CLIPPED_SHARE:.0%} of its samples, at least {CLIPPED_COUNT}, exactly at an extreme, and
    {CLIPPED_FACTOR:g} times as many as at the next values."""
    counts, known = channel.value_counts().sort_index(), int(channel.count())
    for place, near in ((0, slice(1, 4)), (-1, slice(-4, -1))) if len(counts) >= CONTINUOUS else ():
        count = int(counts.iloc[place])
        if count >= max(CLIPPED_COUNT, CLIPPED_SHARE * known, CLIPPED_FACTOR * counts.iloc[near].mean()):
            are = f"{_percent(count, known)} of its samples are exactly {counts.index[place]:g}"
            yield Warn(f"{channel.name} is clipped: {are}, its extreme")


def _resolution(channel: pd.Series) -> float:
    """Return the smallest distance of two values of a channel, 0 where it never changes."""
    return round(step(channel.dropna().to_numpy(dtype=float), fewest=2), 6)  # 21.2 - 21 is no 0.2 in binary


def _others_move(values: pd.DataFrame, name: str, first: int, length: int) -> bool:
    """Whether another temperature moves between the first sample and so many later."""
    during = values.iloc[first : first + length + 1]
    return any(during[other].nunique() > MOVING for (other,) in TEMPERATURES if other in values and other != name)


def _percent(count: int, of: int) -> str:
    """Return a share in per cent with two figures that count: 100 %, 12 %, 0.031 %."""
    percent = 100.0 * count / of
    return f"{percent:.0f} %" if percent >= 10.0 else f"{percent:.2g} %"


def _runs(mask: np.ndarray) -> list[tuple[int, int]]:
    """Return start and length of each run of true."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False])).astype(int)))
    return list(zip(edges[::2].tolist(), (edges[1::2] - edges[::2]).tolist(), strict=True))


def _longest(mask: np.ndarray) -> tuple[int, int]:
    """Return start and length of the longest run of true."""
    return max(_runs(mask), key=lambda run: run[1], default=(0, 0))


def _duration(seconds: float) -> str:
    return f"{seconds / HOUR_S:.3g} h" if seconds >= HOUR_S else f"{seconds / 60.0:.3g} min"
