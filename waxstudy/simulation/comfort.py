"""Equal comfort: the setpoint at which a case is as comfortable as the study asks of all."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy.simulation import shift
from waxstudy.simulation.engine import Loop, Start
from waxstudy.simulation.outside import OutsideLoop
from waxstudy.study.model import Comfort

WEEK_H = 168.0
CLOSE_K = 0.02  # how near the few members' shift is to that of all

Loops = Sequence[Loop | OutsideLoop]


def equal_comfort(comfort: Comfort, loops: Loops, starts: Sequence[Start], stop: np.ndarray) -> shift.Shift:
    """Return the setpoint shift at which the members of a case are as comfortable as asked, on their mean."""

    def hours_at(of: Loops, starts: Sequence[Start], shift_K: float) -> FloatArray:
        return np.concatenate([each_hours(each, starts, shift_K) for each in of])

    def each_hours(loop: Loop | OutsideLoop, starts: Sequence[Start], shift_K: float) -> FloatArray:
        weeks = loop.weeks(comfort.setpoint_C + shift_K, starts, stop=stop)
        return np.array([week.hours_below for week in weeks]) * WEEK_H * 3600.0 / loop.driven.counted_s

    target_h = comfort.hours_below_per_week
    # a few members, or the room that stands in, find the neighbourhood at a fraction of the cost
    quick, few = _quick(loops, starts)
    found = near = shift.solve(partial(hours_at, quick, few), target_h)
    if quick is not loops or len(few) < len(starts):
        found = shift.solve(partial(hours_at, loops, starts), target_h, near.shift_K, CLOSE_K)
    return found


def _quick(loops: Loops, starts: Sequence[Start]) -> tuple[Loops, Sequence[Start]]:
    stand_ins = [loop.stand_in for loop in loops if isinstance(loop, OutsideLoop)]
    return (stand_ins, starts) if stand_ins else (loops, starts[: -(-len(starts) // 4)])
