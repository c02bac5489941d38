"""One case in one week as a loop: its key figures at equal comfort, its wear, and where it works."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
import pandas as pd

from waxstudy.plugin import FloatArray
from waxstudy.results.kpis import FIGURES, Figures, MemberWeek
from waxstudy.results.run import CaseFolder
from waxstudy.results.wear import Wear
from waxstudy.simulation.comfort import WEEK_H, equal_comfort
from waxstudy.simulation.engine import Loop, Start
from waxstudy.simulation.outside import OutsideLoop
from waxstudy.simulation.run import Plan, member_week, part_intervals

HEAT = "heat_corrected_kWh_m2_week"
RAW_HEAT = "heat_kWh_m2_week"  # of rooms that do not say what heat they hold
# name -> unit; what a member has besides its key figures
UNITS = {
    **FIGURES,
    "switches_per_day": "1",
    "strokes_per_day": "1",
    "hours_below_at_equal_heat": "h",
    "conductance_W_K": "W/K",
    "drop_K": "K",
}


def loop_figures(
    plan: Plan, job: CaseFolder, loops: Sequence[Loop | OutsideLoop], heat_kWh_m2_week: float | None = None
) -> pd.DataFrame:
    """Return a row for each member at equal comfort; raise what the simulation raises.

    `hours_below_at_equal_heat` are the hours with as much heat as is given (by default what the case itself takes):
    the setpoint is moved by what the difference of heat is worth in kelvins.
    """
    driven = loops[0].driven
    shift_K = equal_comfort(plan.study.comfort, loops, plan.starts, plan.stop).shift_K
    setpoint_C = plan.study.comfort.setpoint_C + shift_K
    per_K = driven.heat_W_K * WEEK_H / 1000.0 / driven.room.floor_area_m2
    members = list(product(loops, plan.starts))
    rows = [
        {
            "case": job.case,
            "week": job.week,
            "member": number,
            "setpoint_shift_K": shift_K,
            "heat_per_K_kWh_m2_week": per_K,
            **_of_member(plan, loop, start, setpoint_C),
        }
        for number, (loop, start) in enumerate(members)
    ]
    frame = pd.DataFrame(rows)
    own = heat_of(frame)
    more_K = 0.0 if heat_kWh_m2_week is None else (heat_kWh_m2_week - own) / per_K
    return frame.assign(hours_below_at_equal_heat=_hours_below(plan, members, setpoint_C + more_K))


def heat_of(frame: pd.DataFrame) -> float:
    """Return the members' mean heat, without what their rooms hold more or less of it where that is known."""
    return float(frame[HEAT if frame[HEAT].notna().all() else RAW_HEAT].mean())


def _hours_below(plan: Plan, members: Sequence[tuple[Loop | OutsideLoop, Start]], setpoint_C: float) -> FloatArray:
    weeks = (week for loop, start in members for week in loop.weeks(setpoint_C, [start], stop=plan.stop))
    counted_s = np.array([loop.driven.counted_s for loop, _ in members])
    return np.asarray(np.array([week.hours_below for week in weeks]) * WEEK_H * 3600.0 / counted_s)


def _of_member(plan: Plan, loop: Loop | OutsideLoop, start: Start, setpoint_C: float) -> dict[str, float]:
    figures, wear, works = Figures(), Wear(), _Works(loop)
    intervals = part_intervals(loop.driven, plan.study.output.trace_interval_s)
    for number, simulated in enumerate(loop.parts(setpoint_C, start, intervals, plan.stop)):
        part = member_week(loop, simulated, setpoint_C, plan.study, number * intervals)
        for each in (figures, wear, works):
            each.add(part)
    return {**figures.key_figures(), **wear.per_day(), **works.at()}


class _Works:
    """Where a loop works: mean conductance from water to floor, and the drop of temperature that drives its heat."""

    def __init__(self, loop: Loop | OutsideLoop) -> None:
        self.room = loop.driven.room
        self.steps, self.conductance_W_K, self.heat_W = 0, 0.0, 0.0

    def add(self, part: MemberWeek) -> None:
        fraction = part.channels["flow_L_h"] / self.room.full_flow_L_h
        self.conductance_W_K += float(np.sum(self.room.floor_conductance_W_K(fraction)))
        self.heat_W += float(np.sum(part.channels["water_heat_W_m2"])) * self.room.floor_area_m2
        self.steps += len(fraction)

    def at(self) -> dict[str, float]:
        drop_K = self.heat_W / self.conductance_W_K if self.conductance_W_K > 0.0 else np.nan
        return {"conductance_W_K": self.conductance_W_K / self.steps, "drop_K": drop_K}
