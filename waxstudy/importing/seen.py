"""What the values of an entity look like, whatever its name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from waxstudy.dataset.channels import Quantity
from waxstudy.dataset.checks.samples import power_on
from waxstudy.dataset.checks.units import TYPICAL
from waxstudy.dataset.limits import PER_CENT, VOLTS
from waxstudy.importing import units
from waxstudy.importing.following import following
from waxstudy.importing.limits import (
    COLD_C,
    DIAL_C,
    DIALS,
    FAHRENHEIT,
    FOLLOWING,
    FRACTION,
    HOTTEST_F,
    LEAST_AMOUNT,
    LEAST_HIGH,
    LEVEL,
    ROOM_C,
    STEADY_K,
    WARM_WATER_C,
)
from waxstudy.importing.names import CHANNEL_NAMES, OTHER_AIR, OTHERS, SET, TEMPERATURE, plain, says
from waxstudy.importing.rates import is_counter
from waxstudy.importing.reading import Logged
from waxstudy.plugin import FloatArray

AMOUNTS = ("flow_L_h", "control_output", "displacement")  # of which a setpoint may be, too
NO_TEMPERATURES = (*AMOUNTS, "heating_signal")
ON = (1.0, 100.0, units.FULL_BYTE)  # numbers that are on where nothing else than 0 is beside them
WRITTEN = STATED, IN_FILE, IN_NAME = ("stated", "in the file", "in its name")
IS_FAHRENHEIT = "as rooms of this source are at 50 to 95, which is degrees Fahrenheit"
WARM = "|".join((TEMPERATURE, *(words.clear for name, words in CHANNEL_NAMES.items() if name.endswith("_C"))))
ABOUT_ROOM = ("sensor_temperature_C", "air_temperature_C", "setpoint_C")


@dataclass(frozen=True)
class Seen:
    """An entity, and what its values look like."""

    logged: Logged
    low: float  # 1 %, 50 % and 99 % of the values
    median: float
    high: float
    distinct: int
    is_binary: bool
    is_counter: bool
    unit: str  # as stated, as written, or as taken from the values
    why_unit: str
    states: str = ""  # its two numbers, of which nobody knows yet which is on, as a unit: "1/2"
    following: float = 0.0  # correlation with the valve's signal

    @property
    def entity(self) -> str:
        return self.logged.entity

    @property
    def is_unit_written(self) -> bool:
        return self.why_unit in WRITTEN

    @property
    def is_two_state(self) -> bool:
        return self.is_binary or bool(self.states)

    @property
    def range_words(self) -> str:
        return f"values {self.low:.4g} to {self.high:.4g}" + (f" {self.unit}" if self.unit else "")


def seen(logged: Sequence[Logged], stated: dict[str, str]) -> list[Seen]:
    """Return entities with what they look like; a unit is stated, else written, else what names and values say."""
    found = _beside_the_valve([_looked_at(each, stated.get(each.entity, "")) for each in logged])
    is_celsius = any(_is_in_celsius(each) for each in found if each.logged.is_of_house)
    is_fahrenheit = not is_celsius and any(_is_room_in_fahrenheit(each) for each in found)
    return [_with_unit(each, is_fahrenheit) for each in found]


def _beside_the_valve(found: list[Seen]) -> list[Seen]:
    """Return entities with how they follow the signal of the valve, where there is one and no more."""
    signals = [each for each in found if each.is_binary and each.distinct == 2]
    named = [each for each in signals if says(plain(each.entity), CHANNEL_NAMES["heating_signal"].clear)] or signals
    if len(named) != 1:
        return found
    return [replace(each, following=following(each.logged, named[0].logged)) for each in found]


def _looked_at(logged: Logged, stated: str) -> Seen:
    known = logged.values[np.isfinite(logged.values)]
    # beside words that are understood a unit tells no more, and a mere degree none of which scale
    says_nothing = logged.is_words or (logged.unit.lower() in units.BARE_DEGREES and says(plain(logged.entity), WARM))
    logged = logged._replace(unit="") if says_nothing else logged
    if _may_be_C(stated or logged.unit) and (measured := known[~power_on(known)]).size:
        known = measured
    low, median, high = (float(each) for each in np.quantile(known, (0.01, 0.5, 0.99)))
    different = np.unique(known)
    why = STATED if stated else IN_FILE if logged.unit else ""
    is_binary = any(set(different) <= {0.0, on} for on in ON)
    unit = stated or logged.unit
    states = "" if is_binary else _states(different, unit)
    return Seen(logged, low, median, high, len(different), is_binary, is_counter(known), unit, why, states)


def _states(different: FloatArray, unit: str) -> str:
    """Return two whole numbers without a unit, as building automation numbers states, with a stroke between.

    0 and a large number may be a level as well, as of an output that is limited.
    """
    is_open = not unit or units.STATES.fullmatch(unit.strip()) is not None
    if len(different) != 2 or not is_open or different[0] < 0.0 or (different != np.round(different)).any():
        return ""
    if different[0] == 0.0 and different[1] > VOLTS:
        return ""
    return f"{different[0]:.0f}/{different[1]:.0f}"


def _may_be_C(unit: str) -> bool:
    return unit.strip("° ").lower() in ("", "c", "degc", "celsius")


def _is_in_celsius(each: Seen) -> bool:
    """Whether a temperature is told to be in degrees Celsius or kelvins: its source writes no others."""
    unit = each.unit or _in_name(each.entity)
    return (
        bool(units.fitting(unit, ["indoor"])) and units.plain_unit(unit).lower() != "degf" and not each.logged.is_words
    )


def _is_room_in_fahrenheit(each: Seen) -> bool:
    """Whether a room's temperature or setpoint, by a name that says so, is where only degrees Fahrenheit are."""
    name = plain(each.entity)
    is_named = any(says(name, f"{CHANNEL_NAMES[c].clear}|{CHANNEL_NAMES[c].weak}") for c in ABOUT_ROOM)
    others = "|".join((OTHER_AIR, OTHERS, *(CHANNEL_NAMES[channel].clear for channel in AMOUNTS)))
    is_told = says(name, f"{TEMPERATURE}|t|{SET}") and not says(name, others)
    within = FAHRENHEIT[0] <= each.median <= FAHRENHEIT[1] and each.high < HOTTEST_F
    has_unit = bool(each.unit or _in_name(each.entity))
    return is_named and is_told and within and not has_unit and not each.is_counter


def _with_unit(each: Seen, is_fahrenheit: bool) -> Seen:
    """Return an entity with the unit that its values have, where none is written and they leave one in doubt."""
    if each.unit or each.logged.is_words:
        return each
    name = plain(each.entity)
    if found := _in_name(each.entity):
        return replace(each, unit=found, why_unit=IN_NAME)
    if is_fahrenheit and _is_temperature(name, each):
        return replace(each, unit="degF", why_unit=IS_FAHRENHEIT)
    return each


def _is_temperature(name: str, each: Seen) -> bool:
    """Whether a name is that of a temperature, and of nothing else."""
    is_said = any(says(name, words.clear) for channel, words in CHANNEL_NAMES.items() if channel.endswith("_C"))
    is_other = any(says(name, CHANNEL_NAMES[channel].clear) for channel in NO_TEMPERATURES) or says(name, OTHERS)
    return not each.is_binary and (says(name, f"{TEMPERATURE}|t") or (is_said and not is_other))


# at a name's end: letters alone as they are written as units, as a small one may say where or which; others in any case
LETTERS = {"_C": "degC", "_F": "degF", "_W": "W", "_V": "V", "_L": "L"}
IN_NAMES = {
    "_degc": "degC", "_degf": "degF", "_l_h": "L/h", "_lh": "L/h", "_m3h": "m3/h", "_m3_h": "m3/h", "_l_min": "L/min",
    "_lmin": "L/min", "_lpm": "L/min", "_l_s": "L/s", "_kg_h": "kg/h", "_kg_s": "kg/s", "_gpm": "gpm", "_kw": "kW",
    "_kwh": "kWh", "_pct": "%", "_percent": "%", "_litres": "L", "_liters": "L", "_m3": "m3",
}  # fmt: skip


# behind a blank; no letters alone, which may name a room or the west, but as they are written as a unit
BEHIND = (
    "%", "°c", "°f", "℃", "℉", "degc", "degf", "l/h", "l/min", "l/m", "l/s", "kg/h", "m3/h", "m³/h", "lpm", "gpm", "m³",
    "kwh", "mwh", "w/m2", "w/m²",
)  # fmt: skip
AS_WRITTEN = ("kW", "Wh", "m3")


def _in_name(entity: str) -> str:
    before, _, last = entity.rpartition(" ")
    if before and (last.lower() in BEHIND or last in AS_WRITTEN):
        return last
    ends = ((entity, LETTERS), (entity.lower(), IN_NAMES))
    return next((unit for name, units_of in ends for end, unit in units_of.items() if name.endswith(end)), "")


def level_unit(each: Seen) -> str:
    """Return the unit that a level without one is in: its two states, or by how high it reaches."""
    if each.states:
        return each.states
    if each.high <= FRACTION:
        return "1"
    if each.high <= VOLTS and not each.is_binary:
        return "0-10 V"
    return "%" if each.high <= PER_CENT else "0-255" if _are_bytes(each.logged.values) else ""


def _are_bytes(values: FloatArray) -> bool:
    """Whether values are whole and go up to just the largest of a byte, as building automation counts levels."""
    known = values[np.isfinite(values)]
    return bool(np.all(known == np.round(known)) and known.max(initial=0.0) == units.FULL_BYTE)


def converted(each: Seen, quantity: Quantity) -> tuple[float, float, float] | None:
    """Return low, median and high in the unit of a quantity; None where its unit measures something else."""
    unit = each.unit or (level_unit(each) if quantity == "level" else units.BASE[quantity])
    try:
        how = units.conversion(unit, quantity)
    except ValueError:
        return None
    if how is None or (each.logged.is_words and quantity != "level"):
        return None
    low, median, high = (how.scale * value + how.offset for value in (each.low, each.median, each.high))
    return low, median, high


def is_plausible(each: Seen, quantity: Quantity) -> bool | None:
    """Whether values are those of a quantity; None where their unit measures something else."""
    if (found := converted(each, quantity)) is None:
        return None
    low, median, high = found
    if quantity in TYPICAL:
        typical = TYPICAL[quantity]
        return typical.low <= median <= typical.high and not each.is_binary and not each.is_counter
    if quantity == "level":
        return LEVEL[0] < low and high < LEVEL[1] and not (each.is_counter and each.distinct > 2)
    return low > LEAST_AMOUNT and (high > LEAST_HIGH or each.is_counter)


def by_values(each: Seen, channel: str, quantity: Quantity) -> bool:
    """Whether values alone, without a name that says anything, are like those of one channel and not of others."""
    found = converted(each, quantity)
    if found is None or not is_plausible(each, quantity):
        return False
    low, median, high = found
    is_dial = each.distinct <= DIALS
    match channel:
        case "setpoint_C":
            return is_dial and low >= DIAL_C[0] and high <= DIAL_C[1]
        case "outdoor_temperature_C":
            return median < COLD_C and high < WARM_WATER_C and high - low > STEADY_K and not is_dial
        case "sensor_temperature_C":
            is_water = each.following > FOLLOWING
            return ROOM_C[0] <= median <= ROOM_C[1] and high - low < 2.0 * STEADY_K and not is_dial and not is_water
        case "supply_temperature_C" | "return_temperature_C":
            return (high >= WARM_WATER_C or each.following > FOLLOWING) and median > COLD_C and not is_dial
        case "heating_signal":
            return each.is_binary
        case "flow_L_h":
            return each.is_unit_written
    return False
