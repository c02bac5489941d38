"""Samples that no instrument should show: codes for missing, impossible values, spikes, what is stuck or clipped."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from waxstudy.dataset.channels import CHANNELS, Quantity
from waxstudy.dataset.columns import CODE, CODES, CODES_ABOVE
from waxstudy.dataset.notes import Notes
from waxstudy.dataset.plausible import LEVEL_NOISE
from waxstudy.plugin import FloatArray

if TYPE_CHECKING:
    import pandas as pd

    Values = pd.DataFrame

# what no such temperature is [C]
BOUNDS: dict[Quantity, tuple[float, float]] = {
    "indoor": (-30.0, 60.0),
    "water": (-20.0, 110.0),
    "outdoor": (-60.0, 60.0),
}
FEW = 0.05  # share of impossible samples that may be faults; more of them are another quantity
# a single sample that differs from both of its neighbours by more is a fault [K]; water may rush for a minute
SPIKES_K: dict[Quantity, float] = {"indoor": 4.0, "outdoor": 10.0, "water": 25.0}
# a single sample so many times what all but a few reach, and as large, is one too; an oven may run for one sample
PEAKS: dict[Quantity, tuple[float, float]] = {"flow": (1.5, 0.0), "gain": (20.0, 5000.0)}
FAR_ABOVE = 10.0  # times all other flows or gains, from which a code above them is one
USUALLY = 20  # samples that reach half of what is usual
RARE, RAREST = 1e-3, 3  # samples that may be faults: share, and at least
HOUR_S = 3600.0
STUCK_H, STUCK_COARSE_H = 6.0, 24.0
COARSE_K = 0.2  # a resolution with which a temperature may stand still for hours
CLIPPED_SHARE, CLIPPED_COUNT, CLIPPED_FACTOR = 0.01, 20, 5.0
NAMED = 3  # channels that a sentence lists
DISTINCT = 20  # values from which a channel counts as continuous


def without_faults(values: Values, times: pd.DatetimeIndex, notes: Notes) -> Values:
    """Return the rows with codes, impossible values and spikes set to missing; the user is told how many."""
    cleaned = values.copy()
    usual_s = float(np.median(np.diff(times.as_unit("ns").asi8))) / 1e9
    for name in values.columns:
        quantity = CHANNELS[name].quantity
        _discard(cleaned, name, _codes(cleaned[name].to_numpy(), quantity), CODE, notes)
        if quantity in PEAKS:
            _without_peaks(cleaned, name, *PEAKS[quantity], notes)
        elif quantity == "level":
            _without_strays(cleaned, name, notes)
        else:
            _without_wild_temperatures(cleaned, name, usual_s, notes)
    return cleaned


def _codes(x: FloatArray, quantity: Quantity) -> np.ndarray:
    if quantity not in PEAKS:
        return np.isin(x, (*CODES, *CODES_ABOVE))
    others = x[np.isfinite(x) & ~np.isin(x, CODES_ABOVE)]
    is_far_above = len(others) > 0 and min(CODES_ABOVE) > FAR_ABOVE * float(np.max(others))
    return np.isin(x, (*CODES, *CODES_ABOVE) if is_far_above else CODES)


def _without_wild_temperatures(values: Values, name: str, usual_s: float, notes: Notes) -> None:
    """Set to missing what is impossible, if it is little, and single samples that jump away and back."""
    quantity = CHANNELS[name].quantity
    low, high = BOUNDS[quantity]
    outside = ((values[name] < low) | (values[name] > high)).to_numpy()
    if outside.sum() <= FEW * values[name].count():
        _discard(values, name, outside, f"outside {low:g} to {high:g} C, which is impossible", notes)
        limit_K = SPIKES_K[quantity] * (1.0 + usual_s / HOUR_S)
        spikes = _spikes(values[name].to_numpy(), limit_K)
        _discard(values, name, spikes, f"more than {limit_K:.3g} K off both neighbours", notes)


def _without_peaks(values: Values, name: str, times: float, least: float, notes: Notes) -> None:
    """Set to missing what stands alone, far above all but a few samples."""
    x = values[name].to_numpy()
    known = np.sort(x[np.isfinite(x)])
    few = max(RAREST, round(RARE * len(known)))
    usual = float(known[-1 - few]) if len(known) > few else 0.0
    if usual <= 0.0 or np.count_nonzero(known > 0.5 * usual) < USUALLY:
        return
    peaks = _spikes(x, 0.5 * times * usual) & (x > max(times * usual, least))
    _discard(values, name, peaks, f"more than {times:g} times the usual {usual:.3g}, and alone", notes)


def _without_strays(values: Values, name: str, notes: Notes) -> None:
    """Set to missing the few samples of a level that no level can have."""
    x = values[name].to_numpy()
    strays = (x < -LEVEL_NOISE) | (x > 1.0 + LEVEL_NOISE)
    if strays.sum() <= max(RAREST, RARE * len(x)):
        _discard(values, name, strays, "beyond 0 to 1, which is impossible", notes)


def _spikes(x: FloatArray, limit: float) -> np.ndarray:
    """Return single samples that jump away and back."""
    found = np.zeros(len(x), dtype=bool)
    if len(x) > 2:
        before, after = x[1:-1] - x[:-2], x[1:-1] - x[2:]
        with np.errstate(invalid="ignore"):
            away = (np.minimum(np.abs(before), np.abs(after)) > limit) & (np.sign(before) == np.sign(after))
        found[1:-1] = away
    return found


def _discard(values: Values, name: str, bad: np.ndarray, what: str, notes: Notes) -> None:
    notes.lost(name, values[name].to_numpy()[bad], what)
    values.loc[bad, name] = np.nan


def look_at_samples(values: Values, interval_s: float, notes: Notes) -> None:
    """Warn of gaps, of channels that are constant, stuck or clipped; nothing is changed."""
    _tell_gaps(values, interval_s, notes)
    for name in values.columns:
        channel, x = CHANNELS[name], values[name]
        if channel.is_assumed or name == "setpoint_C":
            continue
        if x.nunique() == 1:
            notes.warn(f"{name} is {x.dropna().iloc[0]:g} throughout")
        elif channel.quantity in BOUNDS:
            _tell_stuck(name, values, interval_s, notes)
            _tell_clipped(name, x, notes)


def _tell_gaps(values: Values, interval_s: float, notes: Notes) -> None:
    """Say what is missing, once for all channels that miss the same."""
    said: dict[tuple[int, int, int], list[str]] = {}
    for name in values.columns:
        lost = values[name].isna().to_numpy()
        if lost.any():
            first, length = _longest(lost)
            said.setdefault((int(lost.sum()), first, length), []).append(name)
    for (count, first, length), names in said.items():
        who = ", ".join(names) if len(names) <= NAMED else f"{len(names)} of {len(values.columns)} channels"
        share = 100.0 * count / len(values)
        notes.warn(
            f"{who}: {_percent(share)} of the samples are missing, at most {_duration(length * interval_s)} at once "
            f"(ending {values.index[first + length - 1]})"
        )


def _tell_stuck(name: str, values: Values, interval_s: float, notes: Notes) -> None:
    """Warn where a temperature stands still while another one moves."""
    x = values[name].to_numpy()
    distinct = np.unique(x[np.isfinite(x)])
    limit_h = STUCK_COARSE_H if np.min(np.diff(distinct)) >= COARSE_K else STUCK_H
    first, length = _longest(np.diff(x) == 0.0)
    if length * interval_s <= limit_h * HOUR_S:
        return
    during = values.iloc[first : first + length + 1]
    others = [other for other in values.columns if other != name and CHANNELS[other].quantity in BOUNDS]
    if any(during[other].nunique() > DISTINCT // 4 for other in others):
        place = f"from {during.index[0]} for {_duration(length * interval_s)}"
        notes.warn(f"{name} is stuck at {x[first]:g} {place} while other temperatures move")


def _tell_clipped(name: str, x: pd.Series, notes: Notes) -> None:
    """Warn where many samples lie exactly on the extreme, and few just short of it."""
    counts = x.value_counts().sort_index()
    if len(counts) < DISTINCT:
        return
    for place, near in ((0, counts.iloc[1:4]), (-1, counts.iloc[-4:-1])):
        count = int(counts.iloc[place])
        if count >= max(CLIPPED_COUNT, CLIPPED_SHARE * x.count(), CLIPPED_FACTOR * near.mean()):
            share = 100.0 * count / x.count()
            notes.warn(
                f"{name} is clipped: {_percent(share)} of its samples are exactly {counts.index[place]:g}, its extreme"
            )


def _percent(share: float) -> str:
    """Return a share in per cent with two figures that count: 100 %, 12 %, 0.031 %."""
    return f"{share:.0f} %" if share >= 10.0 else f"{share:.2g} %"


def _longest(mask: np.ndarray) -> tuple[int, int]:
    """Return start and length of the longest run of true."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], mask, [False])).astype(int)))
    starts, ends = edges[::2], edges[1::2]
    if not len(starts):
        return 0, 0
    place = int(np.argmax(ends - starts))
    return int(starts[place]), int(ends[place] - starts[place])


def _duration(seconds: float) -> str:
    return f"{seconds / HOUR_S:.3g} h" if seconds >= HOUR_S else f"{seconds / 60.0:.3g} min"
