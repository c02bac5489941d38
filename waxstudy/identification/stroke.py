"""The heating signal as on and off, and the displacement over its stroke (section 3.1.3)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from waxstudy.dataset.notes import Notes
from waxstudy.plugin import FloatArray

FEWEST_SWITCHES = 2
LEAST_OVER_NOISE = 10.0  # stroke over noise
MIDDLE = (0.25, 0.75)  # of its range: a signal that switches is hardly ever there, a ramp is
MOST_BETWEEN = 0.02  # share of a signal's samples in the middle
HELD = 3  # samples that a level of the signal must last for at least once
FOLLOWS = 0.2  # of the range: openings at switching off and at switching on differ by at least this
SPIKE = 0.09  # of the range: more than the tip of a motor that turns round, less than counts as a movement

FEWEST_DAYS = 3
NEIGHBOURS = 0.05  # of the range: closed positions of days near each other differ by less
LEAST_DRIFT = 0.01  # of the range

BoolArray = NDArray[np.bool_]


class Stroke(NamedTuple):
    """An opening 0..1, and the length that it was normalised by."""

    opening: FloatArray
    length: float


def switched(signal: FloatArray, values: FloatArray, wanted: str, notes: Notes) -> BoolArray | None:
    """Return where the signal is on: above the middle of its range, 0.5 of a normalised one.

    `values` are what is `wanted` beside the signal: swapped columns are told.
    """
    if len(np.unique(values)) == 2:
        notes.refuse(wanted, "takes two values only, as a signal does: are the two columns swapped?")
        return None
    low, high = float(signal.min()), float(signal.max())
    if high - low <= 0.0:
        notes.refuse("signal", f"is {low:g} throughout: without a switch there is no cycle")
        return None
    share = (signal - low) / (high - low)
    between = float(np.mean((share > MIDDLE[0]) & (share < MIDDLE[1])))
    if between > MOST_BETWEEN:
        wrong = "it does not switch between two levels; is it another column?"
        notes.refuse("signal", f"{100.0 * between:.2g} % of its samples lie between on and off: {wrong}")
        return None
    on = share > 0.5
    if int(np.count_nonzero(np.diff(on))) < FEWEST_SWITCHES:
        notes.refuse("signal", "switches less than twice: there is no cycle")
        return None
    return np.asarray(on)


def without_outliers(signal: FloatArray, notes: Notes) -> FloatArray:
    """Return a signal without its outliers, NaN in their place: the levels on and off are held for longer.

    The samples nearer to one end of the range than to the other are no level if no `HELD` of them follow each other.
    """
    kept = np.where(np.isfinite(signal), signal, np.nan)
    while True:
        middle = 0.5 * (np.nanmin(kept) + np.nanmax(kept))
        sides = kept > middle, kept < middle
        short = [side for side in sides if 0 < _longest(side) < HELD]
        if len(short) != 1:
            break
        kept[short[0]] = np.nan
    rows = np.flatnonzero(np.isfinite(signal) & np.isnan(kept))
    if len(rows):
        few = "1 sample is" if len(rows) == 1 else f"{len(rows)} samples are"
        first = f"the first {signal[rows[0]]:g} in line {notes.line_of(int(rows[0]) + 2)}"
        notes.warn(f"signal: {few} neither on nor off ({first}): taken as missing")
    return kept


def _longest(holds: BoolArray) -> int:
    """Return how many follow each other at most."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], holds, [False])).astype(np.int8)))
    return int((edges[1::2] - edges[::2]).max(initial=0))


def normalised(values: FloatArray, on: BoolArray, interval_s: float, notes: Notes) -> Stroke | None:
    """Return |displacement - closed| / stroke; which end is closed is told by the signal.

    Closed and open position are the medians of what lies within 2 % of the extremes, so that noise does not lengthen
    the stroke. The paper takes the cold, closed position as the largest reading; here either end may be closed.
    """
    clean = without_spikes(values, interval_s, notes)
    low, high = np.quantile(clean, (0.001, 0.999))
    noise = 1.4826 * float(np.median(np.abs(np.diff(values, 2)))) / np.sqrt(6.0)
    if high - low <= LEAST_OVER_NOISE * noise or high == low:
        notes.refuse("displacement", f"has no stroke: it stays within {low:.4g} and {high:.4g}, as noise does")
        return None
    edges = np.flatnonzero(np.diff(on.astype(np.int8)))
    rises = on[edges + 1]
    heated, cooled = clean[edges[~rises]], clean[edges[rises]]
    opens = float(np.median(heated) - np.median(cooled)) if len(heated) and len(cooled) else 0.0
    if abs(opens) < FOLLOWS * (high - low):
        notes.refuse("displacement", "does not follow the signal: it is where it was, heated or not; right columns?")
        return None
    _tell_stuck(clean, on, interval_s, notes)
    clean = _without_drift(clean, opens > 0.0, interval_s, notes)
    low, high = np.quantile(clean, (0.001, 0.999))
    ends = _end(clean, low, high, is_low=True), _end(clean, low, high, is_low=False)
    closed, opened = ends if opens > 0.0 else ends[::-1]
    return Stroke((clean - closed) / (opened - closed), abs(opened - closed))


def _end(values: FloatArray, low: float, high: float, is_low: bool) -> float:
    """Return the median of what lies within 2 % of an extreme."""
    margin = 0.02 * (high - low)
    return float(np.median(values[values < low + margin] if is_low else values[values > high - margin]))


def _without_drift(clean: FloatArray, closed_is_low: bool, interval_s: float, notes: Notes) -> FloatArray:
    """Return values whose closed position stays, in records of several days: a sensor's zero wanders (ours).

    It is found day by day and runs straight between; a day whose end is none of its neighbours' did not close.
    """
    per_day = round(86_400.0 / interval_s)
    days = len(clean) // per_day
    if days < FEWEST_DAYS:
        return clean
    parts = np.array_split(clean, days)
    low, high = np.quantile(clean, (0.001, 0.999))
    extremes = [np.quantile(part, (0.001, 0.999)) for part in parts]
    ends = np.array([_end(part, low, high, closed_is_low) for part, (low, high) in zip(parts, extremes, strict=True)])
    nearby = np.array([np.median(ends[max(0, day - 2) : day + 3]) for day in range(days)])
    closes = np.abs(ends - nearby) < NEIGHBOURS * (high - low)
    middles = (np.arange(days) + 0.5) * len(clean) / days
    zero = np.interp(np.arange(len(clean)), middles[closes], ends[closes])
    if np.ptp(zero) < LEAST_DRIFT * (high - low):
        return clean
    notes.warn(f"displacement: the closed position drifts by {np.ptp(zero):.3g} over the record: taken out")
    return np.asarray(clean - (zero - zero[0]))


def without_spikes(values: FloatArray, interval_s: float, notes: Notes) -> FloatArray:
    """Return values with single samples, or two, that jump away and back replaced by the median around them."""
    from scipy.ndimage import median_filter

    low, high = np.quantile(values, (0.01, 0.99))
    middle = median_filter(values, 5 if interval_s <= 2.0 else 3, mode="nearest")
    bad = np.abs(values - middle) > SPIKE * (high - low)
    count = int(bad.sum())
    if not count or high == low:
        return values
    what = "1 sample is a spike: replaced by its" if count == 1 else f"{count} samples are spikes: replaced by their"
    notes.warn(f"{what} neighbours")
    return np.where(bad, middle, values)


def _tell_stuck(clean: FloatArray, on: BoolArray, interval_s: float, notes: Notes) -> None:
    """Warn of a sensor that shows one value for long, over switches."""
    moves = np.flatnonzero(np.diff(clean) != 0.0)
    edges = np.concatenate(([-1], moves, [len(clean) - 1]))
    place = int(np.argmax(np.diff(edges)))
    first, last = int(edges[place]) + 1, int(edges[place + 1])
    switches = int(np.count_nonzero(np.diff(on[first : last + 1])))
    if switches >= 3:
        hours = (last - first) * interval_s / 3600.0
        from_h = first * interval_s / 3600.0
        notes.warn(
            f"the sensor is stuck at {clean[first]:g} from {from_h:.3g} h for {hours:.3g} h, over {switches} switches"
        )
