"""What a case is tuned for: figures at equal comfort, each seen as a share of what the case has as it stands."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd

WITHIN_H = 1.0  # from the hours that the study asks for: four times what the search for the shift leaves


@dataclass(frozen=True)
class Objective:
    """A figure that is to be small."""

    column: str
    unit: str
    form: str
    words: str


OBJECTIVES = {
    "tracking": Objective("mae_K", "K", ".3f", "mean absolute error of the air temperature"),
    "comfort": Objective(
        "hours_below_at_equal_heat", "h", ".1f", "hours a week below the limit with the heat of the case as it stands"
    ),
    "switches": Objective("switches_per_day", "1/day", ".1f", "times a day that the signal switches on"),
    "travel": Objective("strokes_per_day", "1/day", ".1f", "full strokes of the valve a day"),
}


class NoObjective(ValueError):
    """A case has nothing of what it is to be tuned for."""


@dataclass(frozen=True)
class Goal:
    """Objectives with their weights."""

    weights: Mapping[str, float]

    @property
    def words(self) -> str:
        """What is tuned for, in words."""
        if len(self.weights) == 1:
            return next(iter(self.weights))
        return ", ".join(f"{name} x {weight:g}" for name, weight in self.weights.items())

    def refuse(self, start: pd.DataFrame) -> None:
        """Raise `NoObjective` where the case as it stands has nothing of an objective."""
        for name in self.weights:
            values = means(start, name)
            if not all(math.isfinite(value) and value > 0.0 for value in values):
                why = "it is not known" if any(map(math.isnan, values)) else "it is 0"
                hint = "; a continuous signal has no switches, but its valve has travel" if name == "switches" else ""
                raise NoObjective(f"objective {name}: of the case as it stands {why}{hint}")

    def score(self, figures: pd.DataFrame, start: pd.DataFrame) -> float:
        """Return the weighted mean of the objectives, as shares of the start's, over the weeks; the start has 1."""
        shares = {
            name: sum(now / before for now, before in zip(means(figures, name), means(start, name), strict=True))
            for name in self.weights
        }
        weeks = figures["week"].nunique()
        return sum(self.weights[name] * share / weeks for name, share in shares.items()) / sum(self.weights.values())


def means(figures: pd.DataFrame, objective: str) -> list[float]:
    """Return an objective's mean over the members, week by week."""
    return [float(value) for value in figures.groupby("week", sort=True)[OBJECTIVES[objective].column].mean()]


def misses_comfort(figures: pd.DataFrame, target_h: float) -> str:
    """Return what keeps figures from being at equal comfort, "" if nothing does."""
    hours = figures.groupby("week")["hours_below_per_week"].mean()
    off = (hours - target_h).abs()
    if (off <= WITHIN_H).all():
        return ""
    worst = str(off.idxmax())
    return f"not at equal comfort: {hours[worst]:.1f} h below the limit in {worst}, not {target_h:g}"
