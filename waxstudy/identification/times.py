"""Characteristic times of each cycle: where the opening moves, by its slope over 5 s (section 3.1.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from waxstudy.plugin import FloatArray

if TYPE_CHECKING:
    import pandas as pd

    from waxstudy.identification.records import Record

WINDOW_S = 5.0
MEAN_S = 1.0  # the paper's sampling
RISES_PER_5S = 0.0083  # of the stroke: 10 % a minute
FALLS_PER_5S = 0.0167
SLACK = 0.05  # closed up to here
LONGER_THAN = 0.1  # chosen: of the stroke; less is no movement but noise, or what is left of a spike
OPEN = 0.9  # chosen: open from here, since motors may creep on while heated
NEARLY = 0.8  # all of a window, but for noise
LEAST_WHOLE = 0.5  # of a record's cycles: a profile that does not open and close is left out (section 3.1.2)
TIMES = ("dead_s", "rise_s", "overheat_s", "hold_s", "fall_s", "undercool_s")

IntArray = NDArray[np.intp]


class Movements(NamedTuple):
    """Rises or falls of a record, in order: when each begins and ends [s]."""

    begins_s: FloatArray
    ends_s: FloatArray


def cycles_of(record: Record) -> pd.DataFrame:
    """Return a row per cycle, from switching on to switching on: its times [s], NaN where unknown, and `lost`.

    `lost` says why a cycle is left out, "" if it is not. `before_s` is the undercooling time of the cycle before. Each
    edge is placed where a ramp of the local slope would begin or end, for a mean over 5 s sees it early or late.
    """
    import pandas as pd

    dt, opening = record.interval_s, record.opening
    switches = np.flatnonzero(np.diff(record.on.astype(np.int8)))
    on, off = switches[record.on[switches + 1]], switches[~record.on[switches + 1]]
    off_after = np.searchsorted(off, on)
    whole = off_after < len(off)  # the last heating may not end
    on_at, off_at = on[whole], off[off_after[whole]]
    next_at = np.append(on[1:], len(opening) - 1)[: len(on_at)]
    begins, ends = np.asarray((on_at + 0.5) * dt, dtype=float), np.asarray((next_at + 0.5) * dt, dtype=float)
    is_last = np.arange(len(on_at)) == len(on) - 1
    heats_until = np.asarray((off_at + 0.5) * dt, dtype=float)
    up, down = movements(opening, dt, RISES_PER_5S), movements(-opening, dt, FALLS_PER_5S)
    rise, rise_end = within(up, begins, heats_until)
    fall, fall_end = within(down, heats_until, ends)
    frame = pd.DataFrame(
        {
            "record": record.name,
            "product": record.product,
            "exemplar": record.exemplar,
            "cycle": np.arange(1, len(on_at) + 1),
            "on_at_s": begins,
            "off_at_s": heats_until,
            "dead_s": rise - begins,
            "rise_s": rise_end - rise,
            "overheat_s": heats_until - rise_end,
            "hold_s": fall - heats_until,
            "fall_s": fall_end - fall,
            "undercool_s": np.where(is_last, np.nan, ends - fall_end),
        }
    )
    frame["lost"] = _lost(record, frame, on_at, off_at, next_at, is_last)
    if (frame["lost"] == "").mean() < LEAST_WHOLE:
        frame.loc[frame["lost"] == "", "lost"] = "most others are lost"
    knows_end = (opening[next_at] <= SLACK) & ~_touched(record, fall, fall_end)
    frame["before_s"] = frame["undercool_s"].where(knows_end).shift(1)
    return frame


def _touched(record: Record, begins_s: FloatArray, ends_s: FloatArray) -> NDArray[np.bool_]:
    """Whether a gap lies within a movement, or as near to it as its slope is looked at."""
    missing, dt = np.concatenate(([0], np.cumsum(record.missing))), record.interval_s
    first = np.floor((np.nan_to_num(begins_s) - WINDOW_S) / dt).astype(int)
    last = np.ceil((np.nan_to_num(ends_s) + WINDOW_S) / dt).astype(int) + 1
    top = len(record.missing)
    return np.asarray(missing[np.clip(last, 0, top)] > missing[np.clip(first, 0, top)])


def movements(opening: FloatArray, dt: float, least: float) -> Movements:
    """Return the rises steeper than `least` per 5 s and longer than a tenth; faster samples are averaged over 1 s."""
    from scipy.ndimage import uniform_filter1d

    if dt < MEAN_S:
        opening = uniform_filter1d(opening, round(MEAN_S / dt), mode="nearest")
    width = max(1, round(WINDOW_S / dt))
    window_s = width * dt
    slope = (opening[width:] - opening[:-width]) * (WINDOW_S / window_s)
    steep = np.concatenate(([False], slope > least, [False])).astype(np.int8)
    edges = np.flatnonzero(np.diff(steep))
    first, last = edges[::2], edges[1::2] - 1  # in `slope`
    travelled = opening[last + width] - opening[first]
    kept = (travelled > LONGER_THAN) & (last - first >= width // 2)  # longer than what is left of a spike
    first, last = first[kept], last[kept]
    begins = first * dt + window_s - window_s * _overlap(slope, first, -1, width)
    ends = last * dt + window_s * _overlap(slope, last, 1, width)
    return Movements(begins, ends)


def _overlap(slope: FloatArray, at: IntArray, outward: int, width: int) -> FloatArray:
    """Return how much of the outermost steep window `at` lies on the ramp: its slope over that further inside.

    Where nearly all of it does, the window beside it, too flat to be steep, may hold the edge: then more than 1.
    """
    top = len(slope) - 1
    inside = np.maximum(slope[np.clip(at - outward * width, 0, top)], slope[at])
    share = slope[at] / inside
    beside = np.clip(slope[np.clip(at + outward * width, 0, top)], 0.0, None) / inside
    return np.asarray(share + np.where(share > NEARLY, beside, 0.0))


def within(moves: Movements, begins_s: FloatArray, ends_s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the first begin and the last end of the movements that begin within each span, NaN without one."""
    first = np.searchsorted(moves.begins_s, begins_s - WINDOW_S)
    last = np.searchsorted(moves.begins_s, ends_s) - 1
    found = first <= last
    if not len(moves.begins_s):
        nothing = np.full(len(begins_s), np.nan)
        return nothing, nothing
    top = len(moves.begins_s) - 1
    begin = np.where(found, moves.begins_s[np.clip(first, 0, top)], np.nan)
    end = np.where(found, moves.ends_s[np.clip(last, 0, top)], np.nan)
    return begin, end


def _lost(
    record: Record,
    frame: pd.DataFrame,
    on_at: IntArray,
    off_at: IntArray,
    next_at: IntArray,
    is_last: NDArray[np.bool_],
) -> FloatArray:
    """Say why a cycle is left out: the first reason that holds."""
    opening, missing = record.opening, np.concatenate(([0], np.cumsum(record.missing)))
    times = frame[["dead_s", "rise_s", "overheat_s", "hold_s", "fall_s"]].to_numpy()
    open_, closed = opening[off_at], opening[next_at]
    reasons = [
        (missing[next_at + 1] > missing[on_at], "gap"),
        (~np.isfinite(times[:, 1]) & ~np.isfinite(times[:, 3]), "does not move"),
        ((open_ < OPEN) | ~np.isfinite(times[:, 1]), "does not open fully"),
        (is_last & ((closed > SLACK) | ~np.isfinite(times[:, 3])), "cut off by the end"),
        ((closed > SLACK) | ~np.isfinite(times[:, 3]), "does not close fully"),
        (opening[on_at] > SLACK, "not closed before"),
        (~(times > 0.0).all(axis=1) | (frame["undercool_s"].to_numpy() <= 0.0), "a time is zero"),
    ]
    return np.select([np.asarray(holds) for holds, _ in reasons], [why for _, why in reasons], default="")
