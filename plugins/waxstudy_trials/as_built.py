"""The house as it was built: in what it differs from its papers, always, in a healthy record as in a later one.

Nothing of it is an effect. Spreads are chosen, each with what it is meant to stand for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

DIGITS = 4
MOST_SD = 2.5  # what would lie farther off lies there
BASELINE_DAYS = (7, 16)
PAUSE_DAYS = (7, 60)  # between the baseline's last day and the record's first
OUTDOOR_C = (-9.0, 4.0)  # mean of the baseline's days, as of any record


@dataclass(frozen=True)
class Scatter:
    """How a number strays: as a factor exp(normal), by a normal sum, or evenly from 0 on; `spread` is sd or end."""

    way: Literal["factor", "sum", "even"]
    spread: float
    unit: str
    reason: str

    def drawn(self, random: np.random.Generator) -> float:
        place = float(np.clip(random.normal(), -MOST_SD, MOST_SD))
        value = float(random.uniform(0.0, self.spread)) if self.way == "even" else self.spread * place
        return float(f"{np.exp(value) if self.way == 'factor' else value:.{DIGITS}g}")


SCATTER: Mapping[str, Scatter] = {
    "wall_U": Scatter("factor", 0.12, "1", "gaps, moisture, studs: U in situ is 10 to 20 % off"),
    "window_U": Scatter("factor", 0.08, "1", "frame share, spacers, tolerance of panes"),
    "sun": Scatter("factor", 0.12, "1", "dirt, curtains, frames, horizon"),
    "gains": Scatter("factor", 0.25, "1", "households of one size differ by a quarter"),
    "gains_later_h": Scatter("sum", 1.0, "h", "people's hours"),
    "furniture": Scatter("factor", 0.3, "1", "what is moved in"),
    "mass": Scatter("factor", 0.08, "1", "as delivered, not as drawn"),
    "leaks": Scatter("factor", 0.5, "1", "blower-door results of one design differ by a factor of two and more"),
    "flow": Scatter("factor", 0.07, "1", "balanced by hand, in coarse steps"),
    "cover_m2K_W": Scatter("even", 0.02, "m2 K/W", "tiles, a thin carpet, a rug"),
    "exchange_m2K_W": Scatter("even", 0.04, "m2 K/W", "pipes deeper, wider or with air around them"),
    "supply_sensor_K": Scatter("sum", 0.12, "K", "a clamp-on sensor, as it was fixed"),
    "room_sensor_K": Scatter("sum", 0.1, "K", "a thermistor's tolerance, the wall behind it"),
    "wax": Scatter("factor", 0.07, "1", "tolerance of heater and mains"),
}
EVERY_DAY: Mapping[str, Scatter] = {
    "gains": Scatter("factor", 0.2, "1", "guests, cooking, a day out: no day is as another"),
    "gains_later_h": Scatter("sum", 0.5, "h", "half an hour sooner or later"),
}

AsBuilt = Mapping[str, float]


def as_built(random: np.random.Generator) -> dict[str, float]:
    """Return how one house differs from its papers."""
    return {name: scatter.drawn(random) for name, scatter in SCATTER.items()}


def earlier(random: np.random.Generator, day: int) -> dict[str, Any]:
    """Return in what the healthy record differs from one that begins on a day: its days, its weather, its people."""
    days = int(random.integers(BASELINE_DAYS[0], BASELINE_DAYS[1] + 1))
    pause = int(random.integers(PAUSE_DAYS[0], PAUSE_DAYS[1] + 1))
    return {
        "days": days,
        "day": day - pause - days,
        "seed": int(random.integers(2**31)),
        "outdoor_C": round(float(random.uniform(*OUTDOOR_C)), 1),
    }


def healthy(scene: Mapping[str, Any]) -> dict[str, Any] | None:
    """Return the scene of the baseline of a scene, None where it has none."""
    if "baseline" not in scene:
        return None
    rest = {name: value for name, value in scene.items() if name != "baseline"}
    return {**rest, **scene["baseline"], "causes": []}
