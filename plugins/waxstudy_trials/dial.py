"""A dial that stands elsewhere than anybody knows: between two hours, or every day at another place."""

from __future__ import annotations

import math

from waxstudy_trials.put import Range, effect, family

DAY_S = 86_400.0
GOLDEN_RAD = 2.4  # the golden angle: no day is as another, and none that comes round


def turn_of(time_s: float) -> float:
    """Return where the dial stands on a day, from -1 to 1."""
    return math.sin(GOLDEN_RAD * (math.floor(time_s / DAY_S) + 0.5))


SETPOINT_OFFSET = effect(
    "setpoint-offset",
    "controller",
    lambda numbers, v: {"aim_K": v["offset_K"], "aim_from_h": v["from_h"], "aim_to_h": v["to_h"]},
    offset_K=Range(0.05, 2.5, is_signed=True),
    from_h=Range(19.0, 24.0, is_even=True),
    to_h=Range(4.0, 9.0, is_even=True),
)
RESTLESS_DIAL = family(
    "restless-dial",
    ("controller", "sensor"),
    lambda numbers, v: {"turned_K": v["spread_K"]},
    True,
    spread_K=Range(0.1, 3.0),
)
