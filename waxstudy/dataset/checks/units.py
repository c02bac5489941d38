"""Channels whose values are those of something else: another unit, another column."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import pandas as pd

from waxstudy.dataset.channels import Quantity
from waxstudy.dataset.checks.check import TEMPERATURES, Findings, Record, Refuse, Warn, check, each, quantity_of
from waxstudy.dataset.limits import (
    AGREES,
    BRIGHT_W_M2,
    DOUBTFUL,
    HIGHEST_LEVEL,
    LEAST_FLOW_L_H,
    LEVEL_NOISE,
    LOW_FLOW_L_H,
    LOW_GAIN_W,
    LOWEST_LEVEL,
    MOST,
    NEGATIVE_FLOW_SHARE,
    NEGATIVE_L_H,
    NEGATIVE_SHARE,
    NEGATIVE_W,
    NEVER_NEAR_0,
    OPEN,
    PER_CENT,
    UNUSUAL,
    USUAL_HIGH,
    VOLTS,
    WIDE_TENTHS,
    WIDEST_K,
)
from waxstudy.dataset.pulses import pulses_of


class Typical(NamedTuple):
    """Medians of a temperature that nobody doubts, and those that are impossible in degrees Celsius."""

    low: float
    high: float
    impossible_below: float
    impossible_above: float


TYPICAL: dict[Quantity, Typical] = {
    "indoor": Typical(8.0, 35.0, 0.0, 45.0),
    "water": Typical(10.0, 60.0, -5.0, 75.0),
    "outdoor": Typical(-40.0, 35.0, -60.0, 45.0),
}
TENTHS = "tenths of a degree"
# units that a temperature far too high may be in, in degrees Celsius, and what brings it there
HOT: tuple[tuple[str, Callable[[float], float], str], ...] = (
    ("kelvins", lambda t: t - 273.15, "offset = -273.15"),
    ("degrees Fahrenheit", lambda t: (t - 32.0) / 1.8, "scale = 0.5556, offset = -17.78"),
    (TENTHS, lambda t: t / 10.0, "scale = 0.1"),
    ("hundredths of a degree", lambda t: t / 100.0, "scale = 0.01"),
    ("thousandths of a degree", lambda t: t / 1000.0, "scale = 0.001"),
)
FLOW_UNITS = {"m3/h": 1000.0, "L/min": 60.0, "L/s": 3600.0}

measured = partial(check, "units", "refuses or warns", mend="right column, `scale` or `offset` in `[columns]`")


@measured(*TEMPERATURES)
def temperature(record: Record, x: pd.Series) -> Findings:
    """A temperature that lies between 0 and 1 as a signal does, or whose median is impossible in °C: below
    {TYPICAL[indoor].impossible_below:g} or above {TYPICAL[indoor].impossible_above:g} indoors,
    {TYPICAL[water].impossible_below:g} or {TYPICAL[water].impossible_above:g} of water,
    {TYPICAL[outdoor].impossible_below:g} or {TYPICAL[outdoor].impossible_above:g} outdoors. Outdoors
    10 % and 90 % quantiles over {WIDEST_K:g} K apart are impossible, too: tenths of a degree may have any median.
    A median not from {TYPICAL[indoor].low:g} to {TYPICAL[indoor].high:g} indoors, {TYPICAL[water].low:g} to
    {TYPICAL[water].high:g} of water, {TYPICAL[outdoor].low:g} to {TYPICAL[outdoor].high:g} outdoors is a warning."""
    median, quantity = float(x.median()), quantity_of(x)
    typical = TYPICAL[quantity]
    is_between = x.between(-DOUBTFUL, 1.0 + DOUBTFUL).mean() > MOST
    if is_between and x.nunique() > 1 and quantity != "outdoor":
        yield Refuse(x.name, "lies between 0 and 1, as a signal or an opening does: are columns swapped?")
    elif x.isin([0.0, 1.0]).all() and x.nunique() > 1:
        yield Refuse(x.name, "is 0 or 1, as a signal is: are columns swapped?")
    elif median > typical.impossible_above:
        fitting = _units_of_temperature(x, record.values)
        looks = f": it looks like {' or '.join(unit for unit, _ in fitting)}" if fitting else ""
        mend = _mapping(" or ".join(entries for _, entries in fitting)) if fitting else ""
        yield Refuse(x.name, f"has a median of {median:.4g} C, which is impossible{looks}", mend)
    elif median < typical.impossible_below:
        yield Refuse(x.name, f"has a median of {median:.4g} C, which is impossible: is it an outdoor temperature?")
    elif quantity == "outdoor" and (span_K := float(x.quantile(0.9) - x.quantile(0.1))) > WIDEST_K:
        wrong = f"has 10 % and 90 % quantiles that are {span_K:.0f} K apart"
        yield Refuse(x.name, f"{wrong}: it looks like {TENTHS}", _mapping("scale = 0.1"))
    elif not typical.low <= median <= typical.high:
        yield Warn(f"{x.name} has a median of {median:.4g} C, which is unusual: is it the right column, in Celsius?")


def _units_of_temperature(x: pd.Series, values: pd.DataFrame) -> list[tuple[str, str]]:
    """Return the unit that a temperature far too high looks like, and what mends it: two where tenths are likelier."""
    fitting = _fitting(x)
    tenths = [each for each in fitting if each[0] == TENTHS]
    is_coarse = bool((x == x.round()).all()) and float(x.quantile(0.9) - x.quantile(0.1)) > WIDE_TENTHS
    others = (values[name].dropna() for (name,) in TEMPERATURES if name in values and name != x.name)
    if is_coarse or any([unit for unit, _ in _fitting(each)] == [TENTHS] for each in others if len(each)):
        return [*tenths, *(each for each in fitting[:1] if each not in tenths)]
    return fitting[:1]


def _fitting(x: pd.Series) -> list[tuple[str, str]]:
    """Return the units in which a temperature that is far too high in degrees Celsius is usual, and what mends it."""
    median, typical = float(x.median()), TYPICAL[quantity_of(x)]
    if median <= typical.impossible_above:
        return []
    return [(unit, entries) for unit, celsius, entries in HOT if typical.low <= celsius(median) <= typical.high]


def _mapping(entries: str) -> str:
    return f"[columns] with {{ column = ..., {entries} }} mends it"


@measured(*each("level"))
def level(record: Record, x: pd.Series) -> Findings:
    """A level over {LEVEL_NOISE:g} beyond 0 to 1, as in per cent, volts or mm of stroke, or with an offset; over
    {DOUBTFUL:g} beyond is a warning."""
    low, high = float(x.quantile(0.001)), float(x.quantile(0.999))
    if high > PER_CENT:
        yield Refuse(x.name, f"goes up to {high:.4g}, but is a level from 0 to 1: are columns swapped?")
    elif high > HIGHEST_LEVEL:
        unit, scale = _unit_of_level(x, low, high)
        what = " or, as it is never near 0, like a temperature" if low > NEVER_NEAR_0 else ""
        wrong = f"goes up to {high:.4g}, but is a level from 0 to 1: it looks like {unit}{what}"
        yield Refuse(x.name, wrong, _mapping(f"scale = {scale:.4g}"))
    elif low < LOWEST_LEVEL:
        yield Refuse(x.name, f"goes down to {low:.3g}, but is a level from 0 to 1: are columns swapped?")
    elif high > 1.0 + LEVEL_NOISE or low < -LEVEL_NOISE:
        scale = 1.0 / (high - low)
        mend = _mapping(f"scale = {scale:.4g}, offset = {0.0 - low * scale:.4g}")
        yield Refuse(x.name, f"reaches from {low:.3g} to {high:.3g}, but is a level from 0 to 1", mend)
    elif high > 1.0 + DOUBTFUL or low < -DOUBTFUL:
        yield Warn(f"{x.name} reaches from {low:.3g} to {high:.3g}, but is a level from 0 to 1")


def _unit_of_level(x: pd.Series, low: float, high: float) -> tuple[str, float]:
    """Return the unit that a level far too high looks like, and the scale that mends it."""
    if x.nunique() == 2 and low == 0.0 and high not in USUAL_HIGH:
        return f"0 or {high:g}", 1.0 / high
    if high > VOLTS:
        return "per cent", 0.01
    return ("a stroke in mm", 1.0 / high) if x.name == "displacement" else ("0 to 10 V", 0.1)


@measured(*each("gain"))
def gain(record: Record, x: pd.Series) -> Findings:
    """A gain below {NEGATIVE_W:g} W in over {NEGATIVE_SHARE:.0%} of its samples; in fewer is a warning, and so is one
    that never exceeds {LOW_GAIN_W:g} W, as in kW."""
    low, high = float(x.min()), float(x.max())
    if (x < NEGATIVE_W).mean() > NEGATIVE_SHARE:
        yield Refuse(x.name, f"is negative in {100 * (x < 0).mean():.0f} % of its samples: are columns swapped?")
    elif low < NEGATIVE_W:
        yield Warn(f"{x.name} goes down to {low:.3g} W; a gain is not negative")
    if 0.0 < high < LOW_GAIN_W:
        yield Warn(f"{x.name} never exceeds {high:.3g} W: is it in kW? then [columns] needs scale = 1000")


@check("units", "refuses", *each("light"), mend="right column, or its `scale` in `[columns]`")
def light(record: Record, x: pd.Series) -> Findings:
    """Light over {BRIGHT_W_M2:g} W/m2 in 1 % of its samples, as in lux."""
    high = float(x.quantile(0.99))
    if high > BRIGHT_W_M2:
        yield Refuse(x.name, f"reaches {high:.4g} W/m2, which the sun never gives: is it in lux, or another column?")


@measured(*each("flow"))
def flow(record: Record, x: pd.Series) -> Findings:
    """A flow that with the valve open is below {LEAST_FLOW_L_H:g} L/h, or agrees within a factor of {AGREES:g} with the
    full flow of the room if it is in m3/h, L/min or L/s. A warning is one below {LOW_FLOW_L_H:g} L/h, one off the
    room's by a factor of {UNUSUAL:g} (of one in pulses: between them), and one below {NEGATIVE_L_H:g} L/h in over
    {NEGATIVE_FLOW_SHARE:.0%} of its samples."""
    negative = (x < NEGATIVE_L_H).mean()
    if negative > NEGATIVE_FLOW_SHARE:
        yield Warn(f"{x.name} is negative in {100 * negative:.0f} % of its samples")
    high, full_L_h = float(_with_valve_open(record.values).quantile(0.9)), record.full_flow_L_h
    if not high > 0.0:
        return
    unit = _unit_of_flow(high, full_L_h)
    if unit or high < LEAST_FLOW_L_H:
        mend = " or ".join(f"scale = {FLOW_UNITS[one]:g} if it is in {one}" for one in ([unit] if unit else FLOW_UNITS))
        known = f", the room's full flow is {full_L_h:.4g} L/h" if full_L_h else ""
        looks = f": it looks like {unit}" if unit else ""
        yield Refuse(x.name, f"is {high:.3g} with the valve open{known}{looks}", f"[columns] with {mend} mends it")
    elif high < LOW_FLOW_L_H or (full_L_h and _is_unusual(high, full_L_h, record.values)):
        yield Warn(f"{x.name} is {high:.3g} L/h with the valve open, which is unusual: is it in L/h?")


def _is_unusual(high_L_h: float, full_L_h: float, values: pd.DataFrame) -> bool:
    """Whether a flow is far from the room's; of one that was counted in pulses, that between them."""
    pulses = pulses_of(values)
    usual_L_h = pulses.usual_L_h if pulses else high_L_h
    return not full_L_h / UNUSUAL < usual_L_h < full_L_h * UNUSUAL


def _with_valve_open(values: pd.DataFrame) -> pd.Series:
    """Return the flow where a valve is seen open; all that is above 0 where no channel tells of it."""
    flow = values["flow_L_h"]
    openings = [name for name in ("displacement", "heating_signal", "control_output") if name in values]
    if openings and values[openings[0]].max() <= HIGHEST_LEVEL:
        return flow.where(values[openings[0]] > OPEN).dropna()
    return flow.where(flow > 0.0).dropna()


def _unit_of_flow(high_L_h: float, full_L_h: float | None) -> str:
    """Return the unit in which a flow would agree with the room's full flow, "" if none does."""
    if not full_L_h:
        return ""
    return next((unit for unit, scale in FLOW_UNITS.items() if 1 / AGREES < high_L_h * scale / full_L_h < AGREES), "")
