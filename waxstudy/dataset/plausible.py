"""Channels whose values are those of something else: another unit, another column."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from waxstudy.dataset.channels import CHANNELS, Quantity
from waxstudy.dataset.notes import Notes

if TYPE_CHECKING:
    import pandas as pd

ENOUGH = 10  # samples from which a channel can be judged
FAHRENHEIT = "{ column = ..., scale = 0.5556, offset = -17.78 }"
KELVIN = "{ column = ..., offset = -273.15 }"


@dataclass(frozen=True)
class Typical:
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
# flow that no loop of a heated floor falls short of with its valve open, and below which it is doubtful [L/h]
LEAST_FLOW_L_H, LOW_FLOW_L_H = 5.0, 15.0
FLOW_UNITS = {"m3/h": 1000.0, "L/min": 60.0, "L/s": 3600.0}
AGREES = 1.6  # factor within which a flow in another unit agrees with the room's
OPEN = 0.8  # signal or opening from which a valve is taken for open
LOW_GAIN_W = 5.0
LEVEL_NOISE = 0.15  # beyond 0 to 1, from which it is none
USUAL_HIGH = (10.0, 100.0)  # of a level in volts and in per cent


def look_at_units(values: pd.DataFrame, full_flow_L_h: float | None, notes: Notes) -> None:
    """Refuse a channel whose values are impossible in its unit, and warn of those that are doubtful."""
    for name in values.columns:
        x = values[name].dropna()
        if len(x) < ENOUGH:
            continue
        quantity = CHANNELS[name].quantity
        if quantity in TYPICAL:
            _temperature(name, x, TYPICAL[quantity], notes)
        elif quantity == "level":
            _level(name, x, notes)
        elif quantity == "gain":
            _gain(name, x, notes)
        else:
            _flow(values, full_flow_L_h, notes)


def _temperature(name: str, x: pd.Series, typical: Typical, notes: Notes) -> None:
    median = float(x.median())
    if x.nunique() > 1 and x.between(-0.05, 1.05).mean() > 0.99 and typical is not TYPICAL["outdoor"]:
        notes.refuse(name, "lies between 0 and 1, as a signal or an opening does: are columns swapped?")
    elif x.isin([0.0, 1.0]).all() and x.nunique() > 1:
        notes.refuse(name, "is 0 or 1, as a signal is: are columns swapped?")
    elif median > typical.impossible_above:
        unit, mend = _hot(median, typical)
        notes.refuse(name, f"has a median of {median:.4g} C, which is impossible{unit}", allowed=mend)
    elif median < typical.impossible_below:
        wrong = f"has a median of {median:.4g} C, which is impossible: is it an outdoor temperature?"
        notes.refuse(name, wrong)
    elif not typical.low <= median <= typical.high:
        notes.warn(f"{name} has a median of {median:.4g} C, which is unusual: is it the right column, in Celsius?")


def _hot(median: float, typical: Typical) -> tuple[str, str]:
    """Return the unit that a temperature far too high looks like, and the mapping that mends it."""
    guesses: tuple[tuple[str, Callable[[float], float], str], ...] = (
        ("kelvins", lambda t: t - 273.15, KELVIN),
        ("degrees Fahrenheit", lambda t: (t - 32.0) / 1.8, FAHRENHEIT),
        ("tenths of a degree", lambda t: t / 10.0, "{ column = ..., scale = 0.1 }"),
        ("hundredths of a degree", lambda t: t / 100.0, "{ column = ..., scale = 0.01 }"),
        ("thousandths of a degree", lambda t: t / 1000.0, "{ column = ..., scale = 0.001 }"),
    )
    for unit, celsius, mend in guesses:
        if typical.low <= celsius(median) <= typical.high:
            return f": it looks like {unit}", f"[columns] with {mend} mends it"
    return "", ""


def _level(name: str, x: pd.Series, notes: Notes) -> None:
    low, high = float(x.quantile(0.001)), float(x.quantile(0.999))
    if high > 105.0:
        notes.refuse(name, f"goes up to {high:.4g}, but is a level from 0 to 1: are columns swapped?")
    elif high > 1.5:
        _too_high(name, x, low, high, notes)
    elif low < -0.5:
        notes.refuse(name, f"goes down to {low:.3g}, but is a level from 0 to 1: are columns swapped?")
    elif high > 1.0 + LEVEL_NOISE or low < -LEVEL_NOISE:
        scale = 1.0 / (high - low)
        mend = f"[columns] with {{ column = ..., scale = {scale:.4g}, offset = {0.0 - low * scale:.4g} }} mends it"
        notes.refuse(name, f"reaches from {low:.3g} to {high:.3g}, but is a level from 0 to 1", allowed=mend)
    elif high > 1.05 or low < -0.05:
        notes.warn(f"{name} reaches from {low:.3g} to {high:.3g}, but is a level from 0 to 1")


def _too_high(name: str, x: pd.Series, low: float, high: float, notes: Notes) -> None:
    if x.nunique() == 2 and low == 0.0 and high not in USUAL_HIGH:
        unit, scale = f"0 or {high:g}", 1.0 / high
    elif high > 10.5:
        unit, scale = "per cent", 0.01
    elif name == "displacement":
        unit, scale = "a stroke in mm", 1.0 / high
    else:
        unit, scale = "0 to 10 V", 0.1
    what = " or, as it is never near 0, like a temperature" if low > 5.0 else ""
    mend = f"[columns] with {{ column = ..., scale = {scale:.4g} }} mends it"
    notes.refuse(name, f"goes up to {high:.4g}, but is a level from 0 to 1: it looks like {unit}{what}", allowed=mend)


def _gain(name: str, x: pd.Series, notes: Notes) -> None:
    low, high = float(x.min()), float(x.max())
    if (x < -LOW_GAIN_W).mean() > 0.2:
        notes.refuse(name, f"is negative in {100 * (x < 0).mean():.0f} % of its samples: are columns swapped?")
    elif low < -LOW_GAIN_W:
        notes.warn(f"{name} goes down to {low:.3g} W; a gain is not negative")
    if 0.0 < high < LOW_GAIN_W:
        notes.warn(f"{name} never exceeds {high:.3g} W: is it in kW? then [columns] needs scale = 1000")


def _flow(values: pd.DataFrame, full_L_h: float | None, notes: Notes) -> None:
    """Judge the flow with the valve open by the room's full flow, if that is known."""
    name, x = "flow_L_h", values["flow_L_h"]
    if (x < -1.0).mean() > 0.05:
        notes.warn(f"{name} is negative in {100 * (x < -1.0).mean():.0f} % of its samples")
    high = float(_open(values).quantile(0.9))
    if not high > 0.0:
        return
    unit = _unit(high, full_L_h)
    if high < LEAST_FLOW_L_H or (unit and full_L_h):
        scales = [unit] if unit else list(FLOW_UNITS)
        mend = " or ".join(f"scale = {FLOW_UNITS[one]:g} if it is in {one}" for one in scales)
        known = f", the room's full flow is {full_L_h:.4g} L/h" if full_L_h else ""
        looks = f": it looks like {unit}" if unit else ""
        wrong = f"is {high:.3g} with the valve open{known}{looks}"
        notes.refuse(name, wrong, allowed=f"[columns] with {mend} mends it")
    elif high < LOW_FLOW_L_H or (full_L_h and not full_L_h / 4.0 < high < full_L_h * 4.0):
        notes.warn(f"{name} is {high:.3g} L/h with the valve open, which is unusual: is it in L/h?")


def _open(values: pd.DataFrame) -> pd.Series:
    """Return the flow where a valve is seen open; all that is above 0 where no channel tells of it."""
    flow = values["flow_L_h"]
    told = [name for name in ("displacement", "heating_signal", "control_output") if name in values]
    if told and values[told[0]].max() <= 1.5:
        return flow.where(values[told[0]] > OPEN).dropna()
    return flow.where(flow > 0.0).dropna()


def _unit(high: float, full_L_h: float | None) -> str:
    """Return the unit in which a flow would agree with the room's full flow, "" if none does."""
    if not full_L_h:
        return ""
    return next((unit for unit, scale in FLOW_UNITS.items() if 1 / AGREES < high * scale / full_L_h < AGREES), "")
