"""Units at the border: as they are written, by pint, to those of the channels."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from tokenize import TokenError
from typing import TYPE_CHECKING, Any, NamedTuple

from waxstudy.dataset.channels import Quantity
from waxstudy.importing.words import WORDS

if TYPE_CHECKING:
    from pint import UnitRegistry

# as people and loggers write them, in pint's words; pint takes C for coulombs and F for farads
WRITTEN = {
    "c": "degC", "celsius": "degC", "°c": "degC", "ºc": "degC", "℃": "degC", "grad c": "degC", "deg c": "degC",
    "f": "degF", "fahrenheit": "degF", "°f": "degF", "℉": "degF", "deg f": "degF",
    "k": "kelvin", "gpm": "gallon/minute", "gph": "gallon/hour", "cfm": "foot**3/minute",
    # of water, a litre of which has a kilogram within 1 % up to 45 °C
    "kg/s": "liter/second", "kg/min": "liter/minute", "kg/h": "liter/hour", "t/h": "meter**3/hour",
    "m3": "m**3", "m³": "m**3", "l/mn": "liter/minute",
    "l/m": "liter/minute", "lpm": "liter/minute", "lph": "liter/hour", "cbm": "m**3", "cbm/h": "m**3/hour",
    "kbtu/h": "kBTU/hour", "mbh": "kBTU/hour", "btuh": "BTU/hour", "btu/hr": "BTU/hour", "btu/h": "BTU/hour",
    "w": "watt", "kw": "kilowatt", "wh": "watt_hour", "kwh": "kilowatt_hour", "mwh": "megawatt_hour", "l": "liter",
    "gal": "gallon", "v": "volt", "0-10 v": "volt", "0-10v": "volt", "0..10 v": "volt", "0...10 v": "volt",
    "vdc": "volt", "%": "percent", "percent": "percent", "prozent": "percent", "1": "1", "0/1": "1", "0-1": "1",
    "0..1": "1", "-": "1", "on/off": "1", "bool": "1", "0-255": "byte_level", "0..255": "byte_level",
    "byte": "byte_level",
}  # fmt: skip
BARE_DEGREES = ("°", "º", "grad", "deg", "degrees")  # of a temperature they tell no scale, of anything else an angle
PER = {"h": "hour", "min": "minute", "s": "second"}  # in either case: pint takes H for henries and S for siemens
PULSES = ("imp", "impulse", "impulses", "pulse", "pulses", "count", "counts", "imp.", "ticks")
STOREYS = ("EG", "OG", "UG", "DG", "KG")  # of German houses; pint takes the first for exagrams
POWER_SIGN = {"²": "2", "³": "3", "·": "*", "−": "-"}
BASE: dict[Quantity, str] = {
    "indoor": "degC", "water": "degC", "outdoor": "degC", "level": "", "flow": "liter/hour", "gain": "watt",
    "light": "watt/meter**2",
}  # fmt: skip
COUNTED: dict[Quantity, str] = {"flow": "liter", "gain": "watt_hour"}  # per hour it is the channel's unit
PLAIN = re.compile(
    r"(\d{1,9}([.]\d{1,9})?\s*)?[^\d\s]([^\d\s]|[ ²³·]|[23](?![\d*^])){0,29}|1"
)  # no powers of numbers, which never end
# what pint raises besides its own errors, by what the text is
NO_UNIT = (TokenError, AssertionError, AttributeError, ValueError, TypeError, SyntaxError, ArithmeticError)
FULL_V = 10.0  # of a signal of 0 to 10 V
FULL_BYTE = 255.0  # of a level in eight bits, as KNX counts per cent (data point type 5.001)


STATES = re.compile(r"(\d{1,9})/(\d{1,9})")  # what is off and what is on, where these are two numbers


class CountsPulses(ValueError):
    """What is written are pulses, and nobody says what one of them is."""


class Conversion(NamedTuple):
    """value in the channel's unit = scale times what is written, plus offset; of a counter: its increase."""

    scale: float
    offset: float
    is_counter: bool


@cache
def _registry() -> UnitRegistry[Any]:
    from pint import UnitRegistry

    registry: UnitRegistry[Any] = UnitRegistry(autoconvert_offset_to_baseunit=True)
    registry.define(f"byte_level = 1 / {FULL_BYTE}")
    return registry


def conversion(unit: str, quantity: Quantity) -> Conversion | None:
    """Return how a unit becomes that of a quantity, None where it measures something else.

    Raises `ValueError` for what is no unit.

    >>> conversion("m3/h", "flow"), conversion("kWh", "level"), conversion("1/2", "level")[:2]
    (Conversion(scale=1000.0, offset=0.0, is_counter=False), None, (1.0, -1.0))
    """
    if states := STATES.fullmatch(unit.strip()):
        return _of_states(float(states[1]), float(states[2])) if quantity == "level" else None
    one = _quantity(unit)
    if quantity == "level":
        return _level(one)
    for base, is_counter in ((BASE[quantity], False), (COUNTED.get(quantity, ""), True)):
        if base and one.is_compatible_with(base):
            return _affine(one, base, is_counter)
    return None


def _of_states(off: float, on: float) -> Conversion:
    if on == off:
        raise ValueError(f"'{off:g}/{on:g}' has one number for off and on")
    return Conversion(1.0 / (on - off), -off / (on - off) + 0.0, False)


def _affine(one: Any, base: str, is_counter: bool) -> Conversion:
    quantity = _registry().Quantity
    low, high = (float(quantity(one.magnitude * each, one.units).to(base).magnitude) for each in (0.0, 1.0))
    return Conversion(round(high - low, 12), round(low, 10), is_counter)


def _level(one: Any) -> Conversion | None:
    if one.is_compatible_with("volt"):
        return Conversion(float(one.to("volt").magnitude) / FULL_V, 0.0, False)
    return Conversion(float(one.to("").magnitude), 0.0, False) if one.dimensionless else None


def plain_unit(written: str) -> str:
    """Return one way of writing for units that are written in several.

    >>> plain_unit("°C"), plain_unit("celsius"), plain_unit("L/h")
    ('degC', 'degC', 'l/h')
    """
    return WRITTEN.get(written.strip().lower(), written.strip().lower())


@cache
def _quantity(unit: str) -> Any:
    from pint.errors import PintError

    text = unit.strip()
    if text.lower() in PULSES:
        raise CountsPulses(f"'{unit}' are pulses, and nobody knows what one of them is")
    are_states = "/" in text and all(part.strip() in WORDS for part in text.lower().split("/"))  # as off/on
    text = "1" if are_states else WRITTEN.get(text.lower(), text)
    if not PLAIN.fullmatch(text):
        raise ValueError(f"'{unit}' is no unit that is known")
    for sign, plain in POWER_SIGN.items():
        text = text.replace(sign, plain)
    text = re.sub(r"([A-Za-z])([23])\b", r"\1**\2", text)
    first, *others = text.split("/")
    first = WRITTEN.get(first.strip().lower(), first) if others else first
    per = [PER.get(part.strip().lower()) or WRITTEN.get(part.strip().lower(), part) for part in others]
    try:
        found = _registry().parse_expression("/".join([first, *per]))
    except (*NO_UNIT, PintError) as error:
        raise ValueError(f"'{unit}' is no unit that is known") from error
    return found if hasattr(found, "units") else _registry().Quantity(float(found), "")


def is_unit(written: str) -> bool:
    """Whether a word between brackets is a unit, of a channel or of anything else, and no storey of a house."""
    if written in STOREYS:
        return False
    try:
        _quantity(written)
    except ValueError:
        return written.lower() in PULSES
    return True


def fitting(unit: str, quantities: Sequence[Quantity]) -> list[Quantity]:
    """Return the quantities that a unit may measure; none for what is no unit."""
    try:
        return [each for each in quantities if conversion(unit, each) is not None]
    except ValueError:
        return []
