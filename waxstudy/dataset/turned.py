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
MEND = "take 1 minus what it is: scale = -1.0, offset = 1.0 in [columns], of a column that has neither"


def look_at_directions(values: pd.DataFrame, interval_s: float, notes: Notes) -> None:
    """Refuse a level that is low where what follows it is high, and high where that is low."""
    against = [pair for pair in PAIRS if set(pair) <= set(values.columns) and _are_against(*pair, values, interval_s)]
    if not against:
        return
    # what runs against both others is turned; of two alone it is the signal, of a motor that is open without current
    names = [name for pair in against for name in pair]
    turned = max(dict.fromkeys(names), key=names.count)
    cause, effect = against[0]
    wrong = f"is turned: {effect} is low where {cause} has long been high, and high where it has been low"
    notes.refuse(turned, wrong, allowed=MEND)


def _are_against(cause: str, effect: str, values: pd.DataFrame, interval_s: float) -> bool:
    rest = values[cause].rolling(max(SETTLED_SAMPLES, round(SETTLED_S / interval_s)))
    after_on, after_off = (values[effect][chosen].dropna() for chosen in (rest.min() > HIGH, rest.max() < LOW))
    full = float(values[effect].quantile(0.99))
    if min(len(after_on), len(after_off)) < ENOUGH or not full > 0.0:
        return False
    return bool(after_on.median() < LOW * full and after_off.median() > HIGH * full)
