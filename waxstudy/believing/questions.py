"""What an owner is asked: each with a default, and where that comes from."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any

from waxstudy.believing import typical
from waxstudy.plugin.registry import hint

SIDES = ("south", "west", "north", "east")
PRODUCTS = ("A", "B")
UNASKED = "none"

Values = Mapping[str, Any]  # answers so far, by key


@dataclass(frozen=True)
class Proposal:
    """A default, as it would be typed, and its source."""

    text: str
    source: str


@dataclass(frozen=True)
class Question:
    key: str
    text: str
    read: Callable[[str], Any]  # raises ValueError: what is allowed
    propose: Callable[[Values], Proposal]
    choices: Sequence[str] = ()
    table: str = "building"  # that the answer goes to


def number(low: float, high: float, unit: str) -> Callable[[str], float]:
    def read(text: str) -> float:
        try:
            value = float(text.replace(",", "."))
        except ValueError:
            value = float("nan")
        if not low <= value <= high:
            raise ValueError(f"give a number from {low:g} to {high:g} {unit}".rstrip())
        return value

    return read


def year(text: str) -> int:
    if not text.isdigit() or not typical.FIRST <= int(text) <= typical.LAST:
        raise ValueError(f"give a year from {typical.FIRST} to {typical.LAST}")
    return int(text)


def choice(of: Sequence[str]) -> Callable[[str], str]:
    def read(text: str) -> str:
        if text not in of:
            raise ValueError(f"give one of {', '.join(of)}{hint(text, of)}")
        return text

    return read


def by_side(text: str) -> dict[str, float | None]:
    """Return figures by side, None where only the side is told.

    >>> by_side("south 4.0, west")
    {'south': 4.0, 'west': None}
    """
    if text == UNASKED:
        return {}
    found: dict[str, float | None] = {}
    for part in text.split(","):
        side, _, figure = part.strip().partition(" ")
        if side not in SIDES:
            raise ValueError(f"'{side}' is no side{hint(side, SIDES)}: write 'south 4.0, west 3.5', or '{UNASKED}'")
        found[side] = number(0.1, 50.0, f"behind {side}")(figure) if figure.strip() else None
    return found


def areas(text: str) -> dict[str, float]:
    found = by_side(text)
    if bare := [side for side, area in found.items() if area is None]:
        raise ValueError(f"give square metres behind {', '.join(bare)}")
    return {side: area for side, area in found.items() if area is not None}


def place(text: str) -> tuple[float, float] | None:
    if text == UNASKED:
        return None
    parts = text.split(",")
    if len(parts) != 2:
        raise ValueError(f"write it as '59.44, 24.75' (degrees north, degrees east), or '{UNASKED}'")
    return number(-90, 90, "degrees north")(parts[0]), number(-180, 180, "degrees east")(parts[1])


def panels(text: str) -> tuple[float, float, float] | None:
    if text == UNASKED:
        return None
    parts = text.split(",")
    if len(parts) != 3:
        raise ValueError(f"write it as '5000, 35, 180' (W, degrees from level, degrees from north), or '{UNASKED}'")
    kinds = (number(1, 1e7, "W"), number(0, 90, "degrees from level"), number(0, 360, "degrees from north"))
    peak_W, tilt_deg, azimuth_deg = (read(part) for read, part in zip(kinds, parts, strict=True))
    return peak_W, tilt_deg, azimuth_deg


def motor(text: str) -> str:
    if text not in PRODUCTS and not text.endswith(".toml"):
        raise ValueError(f"give {' or '.join(PRODUCTS)}, or the file that `waxstudy fit actuator` has written")
    return text


def usual(text: str, source: str) -> Callable[[Values], Proposal]:
    return lambda values: Proposal(text, source)


def _windows(values: Values) -> Proposal:
    source = "an eighth of the floor, which German building codes ask for at least"
    if not values["outer_walls"]:
        return Proposal(UNASKED, "no outer wall")
    side, length_m = next(iter(values["outer_walls"].items()))
    fits_m2 = typical.WINDOW_WIDTH * typical.WINDOW_HEIGHT_m * (length_m or sqrt(values["floor_area_m2"]))
    return Proposal(f"{side} {min(fits_m2, typical.WINDOW_SHARE * values['floor_area_m2']):.1f}", source)


def _of_year(name: str) -> Callable[[Values], Proposal]:
    def propose(values: Values) -> Proposal:
        era = typical.era_of(values["year"])
        return Proposal(f"{getattr(era, name):g}", f"typical of {values['year']}: {era.source}")

    return propose


def _ventilation(values: Values) -> Proposal:
    is_new = values["year"] > typical.ERAS[-3].until
    return Proposal("balanced" if is_new else "windows", "chosen: usual since 2009, rare before")


def _flow(values: Values) -> Proposal:
    flow = typical.FLOW_L_h_m2 * values["floor_area_m2"]
    return Proposal(f"{flow:.0f}", "60 W/m2 at 5 K between supply and return, EN 1264-3")


U = "in W/(m2 K)"
QUESTIONS = (
    Question("floor_area_m2", "How large is the floor of the room, in m2", number(2, 500, "m2"),
             usual("16", "chosen: a usual living room or large bedroom")),
    Question("height_m", "How high is the room, in m", number(1.8, 8, "m"),
             usual("2.6", "chosen: usual, and that of room nzeb")),
    Question("outer_walls", "Which walls are outer walls, with their lengths in m (as 'south 4.0, west 3.5')", by_side,
             usual("south, west", "chosen: a corner room of a square plan")),
    Question("windows", "How many m2 of windows are on each side (as 'south 2.0, west 1.0')", areas, _windows),
    Question("year", "In which year was the house built, or its walls last insulated", year,
             usual("2005", "chosen: floors are heated in most new houses since about 2000")),
    Question("wall_U", f"U-value of the outer walls, {U}", number(0.05, 5, U), _of_year("wall_U")),
    Question("window_U", f"U-value of the windows, {U}", number(0.4, 6, U), _of_year("window_U")),
    Question("below", "What lies below the floor", choice(tuple(typical.BELOW)),
             usual("ground", "chosen: floors are heated on ground floors first"), tuple(typical.BELOW)),
    Question("floor_U", f"U-value of the floor, {U}", number(0.05, 5, U), _of_year("floor_U")),
    Question("above", "What lies above the ceiling", choice(("warm room", "outdoors")),
             usual("warm room", "chosen: another storey"), ("warm room", "outdoors")),
    Question("walls", "Of what are the walls: light (timber, boards) or heavy (masonry, concrete)",
             choice(("light", "heavy")), usual("heavy", "chosen: most houses"), ("light", "heavy")),
    Question("screed_mm", "How many mm of screed lie above the pipes", number(15, 200, "mm"),
             usual("45", "DIN 18560-2, least above pipes in a heated screed")),
    Question("pipe_spacing_mm", "How far are the pipes apart, in mm", number(60, 400, "mm"),
             usual("150", "EN 1264-3, usual for 35 degrees of supply")),
    Question("covering", "What covers the floor", choice(tuple(typical.COVERINGS)),
             usual("tiles", "chosen"), tuple(typical.COVERINGS)),
    Question("ventilation", "How is the room aired: balanced (fans with heat recovery) or windows",
             choice(("balanced", "windows")), _ventilation, ("balanced", "windows")),
    Question("full_flow_L_h", "How much water flows with the valve open, in L/h (60 times the L/min of the manifold)",
             number(5, 5000, "L/h"), _flow),
    Question("thermostat", "How does the thermostat work: on-off, or PI with pulses", choice(("on-off", "pi")),
             usual("on-off", "chosen: most room thermostats"), ("on-off", "pi"), "nominal"),
    Question("dead_band_K", "How many K lie between its switching on and off", number(0.05, 5, "K"),
             usual("0.5", "EN 15500 and most data sheets: 0.3 to 1"), table="nominal"),
    Question("motor", "Which motor moves the valve: wax of product A or B (docs/fit.md), or FILE.toml of one", motor,
             usual("B", "Parts et al., table 2: the product of their loop"), table="nominal"),
    Question("valve", "What curve has the valve", choice(("quick-opening", "linear")),
             usual("quick-opening", "Parts et al.: usual on manifolds"), ("quick-opening", "linear"), "nominal"),
    Question("setpoint_C", "At which temperature is the thermostat set, in degrees Celsius", number(5, 40, "C"),
             usual("21", "EN 16798-1, category I"), table="nominal"),
    Question("place", "Where is the house, as 'latitude, longitude' (59.44, 24.75)", place,
             usual(UNASKED, "each day then has a sun of its own in the fit"), table="site"),
    Question("panels", "What do the panels give at most, in W, and how do they lie and face (as '5000, 35, 180': W, "
             "degrees from level, degrees from north by east)", panels,
             usual(UNASKED, "their power then tells nothing of the sun"), table="site"),
)  # fmt: skip
NO_GUESS = ("place", "panels")  # to say nothing of these changes nothing
KEYS = tuple(question.key for question in QUESTIONS)
