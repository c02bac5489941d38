"""How an opening went between two samples: what leaves an end, or reaches one, does so within an interval."""

from __future__ import annotations

import numpy as np

from waxstudy.plugin import FloatArray

CELL_S = 15.0  # of the path between samples, somewhat more where an interval is no multiple


def cells(interval_s: float) -> int:
    """Return into how many cells an interval is cut."""
    return max(1, round(interval_s / CELL_S))


def path(opening: FloatArray, interval_s: float) -> FloatArray:
    """Return an opening (n,) at the ends of all cells (n * cells,), straight but for where it leaves or reaches 0 or 1.

    There the motor is taken to move as fast as in the next, or the last, interval, and to stand still for the rest. A
    move from end to end that takes no whole interval is taken to be as fast as the fastest of the record.
    """
    parts, at = cells(interval_s), np.arange(len(opening), dtype=float)
    move = np.diff(opening)
    is_end = (opening <= 0.0) | (opening >= 1.0)
    after, before = np.append(move[1:], 0.0), np.insert(move[:-1], 0, 0.0)
    leaves, reaches = is_end[:-1] & ~is_end[1:], ~is_end[:-1] & is_end[1:]
    lasting = np.where((move * after < 0.0) | (move * before < 0.0), 0.0, move)  # a lost sample moves and comes back
    fastest = np.where(move > 0.0, lasting.max(initial=0.0), lasting.min(initial=0.0))
    in_two = leaves & np.append(reaches[1:], False) & (move * after > 0.0)
    after, before = np.where(in_two, fastest, after), np.where(np.insert(in_two[:-1], 0, False), fastest, before)
    late, early = leaves & _is_faster(after, move), reaches & _is_faster(before, move)
    with np.errstate(divide="ignore", invalid="ignore"):
        corners = np.concatenate((at[1:][late] - (move / after)[late], at[:-1][early] + (move / before)[early]))
    values = np.concatenate((opening[:-1][late], opening[1:][early]))
    order = np.argsort(times := np.concatenate((at, corners)), kind="stable")
    fine = (np.arange(len(opening) * parts) + 1.0) / parts - 1.0
    return np.asarray(np.interp(fine, times[order], np.concatenate((opening, values))[order]))


def _is_faster(other: FloatArray, move: FloatArray) -> np.ndarray:
    """Return where another interval's move has the same direction and is the larger one."""
    return np.asarray((np.sign(other) == np.sign(move)) & (np.abs(other) > np.abs(move)))
