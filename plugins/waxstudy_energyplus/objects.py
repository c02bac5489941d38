"""Objects of an epJSON model: kind, name, fields; and the names by which the parts of the package meet."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

Object = tuple[str, str, dict[str, Any]]
Objects = Iterator[Object]

ZONE = "room"
RADIANT_FLOOR = "radiant floor"
EXCHANGE = "air exchange"

# schedules that the inputs of each minute are written to; those of surfaces are named by `sun_on` and `sun_outside`
GAINS, SUN_TO_AIR, SUN_TO_PANES, SUPPLY = "gains", "sun to air", "sun to panes", "supply"
ALWAYS, ALWAYS_WARM = "always", "always ask for heat"
ANY_NUMBER = "any number"


def sun_on(surface: str) -> str:
    return f"sun on {surface}"


def sun_outside(surface: str) -> str:
    return f"sun outside on {surface}"


def schedule(name: str, value: float = 0.0) -> Object:
    return "Schedule:Constant", name, {"schedule_type_limits_name": ANY_NUMBER, "hourly_value": value}
