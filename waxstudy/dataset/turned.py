"""Channels that run against each other: a motor that is open without current, a pin that is out when it is closed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from waxstudy.dataset.notes import Notes

if TYPE_CHECKING:
    import pandas as pd

ENOUGH = 10  # samples on either side
SETTLED_S, SETTLED_SAMPLES = 1800.0, 3  # of rest, after which a motor has moved
LOW, HIGH = 0.2, 0.8  # of what a channel reaches
PAIRS = (("heating_signal", "displacement"), ("heating_signal", "flow_L_h"), ("displacement", "flow_L_h"))
MEND = "[columns] with { column = ..., scale = -1.0, offset = 1.0 } inverts a level"


def look_at_directions(values: pd.DataFrame, interval_s: float, notes: Notes) -> None:
    """Refuse a level that is low where what follows it is high, and high where that is low."""
    width = max(SETTLED_SAMPLES, round(SETTLED_S / interval_s))
    for cause, effect in PAIRS:
        if not {cause, effect} <= set(values.columns):
            continue
        rest = values[cause].rolling(width)
        after_on, after_off = (values[effect][chosen].dropna() for chosen in (rest.min() > HIGH, rest.max() < LOW))
        full = float(values[effect].quantile(0.99))
        if min(len(after_on), len(after_off)) < ENOUGH or not full > 0.0:
            continue
        if after_on.median() < LOW * full and after_off.median() > HIGH * full:
            wrong = f"{effect} is low where {cause} has long been high, and high where it has been low"
            notes.refuse(f"{cause}, {effect}", f"run against each other: {wrong}", allowed=MEND)
