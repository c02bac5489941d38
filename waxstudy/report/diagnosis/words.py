"""How a diagnosis writes figures, units and names."""

from __future__ import annotations

import math

from waxstudy.diagnosis.result import Interval

# by the end of a name, the longest first
UNITS = {
    "_m2K_W": "m²K/W",
    "_kWh_m2": "kWh/m²",
    "_percent": "%",
    "_W_K": "W/K",
    "_L_h": "L/h",
    "_L_s": "L/s",
    "_L": "L",
    "_C": "°C",
    "_K": "K",
    "_W": "W",
    "_s": "s",
    "_h": "h",
}
LEAST_CHANCE = 0.005  # what is less rounds to nothing
DIGITS = 3  # that a figure shows, zeros before it not counted
# figures of the closed loop: words, unit; those that an engineer asks for first come first
OF_LOOP = {
    "heat_percent": ("heat off by", "%"),
    "air_mae_K": ("air temperature off by", "K"),
    "cycles_per_day": ("cycles", "a day"),
    "heat_kWh_m2": ("heat", "kWh/m² a week"),
    "air_mean_C": ("mean air temperature", "°C"),
    "open_h_per_day": ("valve open", "h a day"),
    "setpoint_shift_K": ("setpoint shift for the measured mean", "K"),
}


def number(value: float, places: int | None = None) -> str:
    """
    >>> number(5.234), number(1234.5), number(0.0123), number(0.0), number(math.nan), number(1.234, 1), number(61.0)
    ('5.23', '1234', '0.0123', '0', '', '1.2', '61')
    """
    if not math.isfinite(value):
        return ""
    if value == 0.0:
        return "0"
    return f"{value:z.{decimals(value) if places is None else places}f}"


def decimals(value: float) -> int:
    """Decimals that show three digits of a figure; a count has none."""
    if not math.isfinite(value) or (value == round(value) and (value == 0.0 or abs(value) >= 10.0)):
        return 0
    return max(0, DIGITS - 1 - math.floor(math.log10(abs(value))))


def rough(value: float) -> str:
    """
    >>> rough(0.0831), rough(6.82), rough(31.4)
    ('0.083', '6.8', '31')
    """
    return number(value, max(0, decimals(value) - 1))


def signed(value: float) -> str:
    """
    >>> signed(3.21), signed(-0.012)
    ('+3.2', '-0.012')
    """
    text = rough(value)
    return f"+{text}" if text and value > 0.0 else text


def departure(deviations: float) -> str:
    """
    >>> departure(1.204), departure(-6e-23), departure(math.nan)
    ('+1.20', '+0.00', '')
    """
    return f"{deviations:+z.2f}" if math.isfinite(deviations) else ""


def times(value: float) -> str:
    """
    >>> times(4.84), times(48.4), times(math.inf)
    ('4.8', '48', 'many')
    """
    if math.isinf(value):
        return "many"
    return number(value, 1 if value < 9.95 else 0)


def percent(share: float) -> str:
    """
    >>> percent(0.923), percent(math.nan)
    ('92 %', '')
    """
    return f"{100.0 * share:z.0f} %" if math.isfinite(share) else ""


def chance(probability: float) -> str:
    """
    >>> chance(0.701), chance(0.0012), chance(0.9991), chance(math.nan)
    ('70 %', 'below 1 %', 'over 99 %', '')
    """
    if probability < LEAST_CHANCE:
        return "below 1 %"
    return "over 99 %" if probability > 1.0 - LEAST_CHANCE else percent(probability)


def hypothesis(names: str) -> str:
    """
    >>> hypothesis("none"), hypothesis("let-by+unknown")
    ('nothing amiss', 'let-by and something unknown')
    """
    told = {"none": "nothing amiss", "unknown": "something unknown"}
    return " and ".join(told.get(name, name) for name in names.split("+"))


def percent_interval(value: Interval) -> str:
    """
    >>> percent_interval(Interval(0.92, 0.88, 0.954))
    '92 % (88 to 95)'
    """
    if not math.isfinite(value.low + value.high):
        return percent(value.value)
    return f"{percent(value.value)} ({100.0 * value.low:z.0f} to {100.0 * value.high:z.0f})"


def interval(value: Interval, unit: str = "") -> str:
    """
    >>> interval(Interval(181.2, 172.0, 190.0), "s"), interval(Interval(0.05, math.nan, math.nan))
    ('181 s (172 to 190)', '0.0500')
    """
    text = with_unit(number(value.value, _places(value)), unit)
    if not math.isfinite(value.low + value.high):
        return text
    return f"{text} ({' to '.join(ends(value))})"


def ends(value: Interval) -> tuple[str, str]:
    """
    >>> ends(Interval(181.2, 172.0, 190.0))
    ('172', '190')
    >>> ends(Interval(5.7, 0.18, 176.0))
    ('0.180', '176')
    """
    places = _places(value)
    is_lost = 0.0 < abs(value.low) < 0.5 * 10.0**-places
    return number(value.low, None if is_lost else places), number(value.high, places)


def _places(value: Interval) -> int:
    """Return the decimals that show three digits of a value, or of its interval where that is wider."""
    return decimals(max(abs(value.value), abs(value.high - value.low), key=lambda x: x if math.isfinite(x) else 0.0))


def quantity(value: float, unit: str) -> str:
    return with_unit(number(value), unit)


def with_unit(text: str, unit: str) -> str:
    return f"{text} {unit_words(unit)}".strip() if text else ""


def unit_words(unit: str) -> str:
    """A figure without unit has none to write."""
    return "" if unit in ("1", "-", "–") else unit


def axis_unit(unit: str) -> str:
    return unit_words(unit) or "–"


def named(name: str) -> tuple[str, str]:
    """Return what a name with its unit at the end says, in words, and the unit.

    >>> named("flow_L_h"), named("delay_s"), named("authority")
    (('flow', 'L/h'), ('delay', 's'), ('authority', ''))
    """
    for end, unit in UNITS.items():
        if name.endswith(end) and name != end:
            return name.removesuffix(end).replace("_", " "), unit
    return name.replace("_", " "), ""


def channel_words(channel: str) -> str:
    return named(channel)[0]


def stage_words(stage: str) -> str:
    """
    >>> stage_words("actuator+valve")
    'actuator and valve'
    """
    return stage.replace("+", " and ")


def loop_words(key: str) -> tuple[str, str]:
    """Return a figure of the closed loop in words, and its unit."""
    return OF_LOOP.get(key) or named(key)


def probability(p: float) -> str:
    """
    >>> probability(0.0025), probability(0.37)
    ('0.0025', '0.37')
    """
    return f"{p:.2g}" if p >= 1e-4 else "below 0.0001"
