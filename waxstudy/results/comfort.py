"""Whether the setpoint shift brought a case to equal comfort, and what the reader is told where it did not."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import pandas as pd

LIMIT_K = 6.0  # no shift is tried beyond it
FAR_K = 2.0  # the paper's largest is 0.49 K; 2 K less than 21 C is below category II of EN 16798-1
OFF_COMFORT_H = 0.5  # from the target, from which on equal comfort counts as missed


@dataclass(frozen=True)
class Reached:
    """The shift of a case in a week, and the members' mean hours below the limit in a week at it."""

    case: str
    week: str
    shift_K: float
    hours: float

    def is_off(self, target_h: float) -> bool:
        return abs(self.hours - target_h) > OFF_COMFORT_H

    @property
    def at_limit(self) -> bool:
        return abs(self.shift_K) >= LIMIT_K

    def warning(self, target_h: float) -> str:
        """Return what a run warns of: no shift within the bounds will do, or one that is very large; "" for neither."""
        if self.at_limit and self.is_off(target_h):
            return (
                f"{self.case}, {self.week}: the comfort rule cannot be met: {target_h:g} h below the limit are out of "
                f"reach within {LIMIT_K:g} K of shift; at {self.shift_K:+g} K it has {self.hours:.1f} h, and its "
                "figures are not at equal comfort"
            )
        if abs(self.shift_K) > FAR_K:
            return (
                f"{self.case}, {self.week}: equal comfort takes a shift of {self.shift_K:+.2f} K, beyond {FAR_K:g} K: "
                "weather, size of the heating or setpoint decide on its hours rather than control"
            )
        return ""


def reached(kpis: pd.DataFrame) -> Iterator[Reached]:
    """Yield what was reached by every case in every week, in the order of the key figures."""
    for (case, week), rows in kpis.groupby(["case", "week"], sort=False):
        hours = float(rows["hours_below_per_week"].mean())
        yield Reached(str(case), str(week), float(rows["setpoint_shift_K"].iloc[0]), hours)


def comfort_warnings(kpis: pd.DataFrame, target_h: float) -> list[str]:
    """Return the warnings of all cases, empty where the rule is met everywhere by a moderate shift."""
    return [text for each in reached(kpis) if (text := each.warning(target_h))]
