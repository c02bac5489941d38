"""Short pulses in the off-time of a motor: what they do to it, and which ones serve as standby heating."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from waxstudy.plugin import FloatArray
from waxstudy_enthalpy.bench import SLACK, Rig, crossing_s, parameters
from waxstudy_enthalpy.calibration import refitted
from waxstudy_enthalpy.motor import core_temperature_C

STEP_S = 1.0
LIMIT_S = 300.0  # full activation that the reserve market allows
FIRST_S = 900.0  # the first pulse comes so long after switching off: the valve is closed
HEATED_S = 3600.0
SETTLED_S = 6 * 3600.0
LONGEST_ACTIVATION_S = 1200.0
PERIODS_MIN = (2, 5, 10, 20)
PERIOD_MIN = 5  # of the tables over pauses and ambient temperature
PAUSES_MIN = (5, 10, 15, 30, 45, 60, 90, 120)
AMBIENT_C = (15.0, 18.0, 21.0, 25.0, 30.0, 35.0)
# the second optimum of B's fit, and motors whose wax melts lower: the times allow these too
VARIANTS: Mapping[str, tuple[str, Mapping[str, float], Mapping[str, float]]] = {
    "B, second optimum": (
        "B",
        {
            "knee_C": 24.7,
            "holding_C": 88.6,
            "cup_J_K": 9.07,
            "body_J_K": 16.0,
            "wax_g": 0.570,
            "core_body_W_K": 0.0708,
            "expansion_mm": 4.25,
        },
        {},
    ),
    "A, wax from 60 C": ("A", {}, {"melting_C": 60.0, "melting_range_K": 8.1}),
    "A, wax from 50 C": ("A", {}, {"melting_C": 50.0, "melting_range_K": 6.0}),
    "B, wax from 60 C": ("B", {}, {"melting_C": 60.0, "melting_range_K": 8.1}),
    "B, wax from 50 C": ("B", {}, {"melting_C": 50.0, "melting_range_K": 6.0}),
}


@dataclass(frozen=True)
class Pattern:
    """A pulse at the start of each period, from `FIRST_S` after switching off; no pulse at all is no standby."""

    pulse_s: float
    period_s: float

    def signal(self, pause_s: float) -> FloatArray:
        """Return the heating signal of a pause."""
        into = np.arange(0.0, pause_s, STEP_S) - FIRST_S
        return np.where((into >= 0.0) & (into % self.period_s < self.pulse_s), 1.0, 0.0)


NONE = Pattern(0.0, 600.0)  # no standby


@dataclass(frozen=True)
class Standby:
    """What a pattern does to one motor once it has settled; times and power at the worst moment of the period."""

    activation_s: float  # switched on just before a pulse
    power_W: float  # mean electrical power
    margin_K: float  # core below the temperature at which the piston starts, at its warmest since the valve closed
    opening: float  # largest since the valve closed


def moving_C(p: Any) -> float:
    """Return the core's temperature at which spring and friction give way and the closed piston starts."""
    return p.melting_C + p.melting_range_K * p.compliance_mm_N * (p.preload_N + p.friction_N) / p.expansion_mm


def activation_s(rig: Rig) -> float:
    """Return the time from switching on to 99 % of the stroke; the motor is left as it is."""
    opening = rig.copy().run(np.ones(round(LONGEST_ACTIVATION_S / STEP_S)))
    return crossing_s(opening, rig.opening, 1.0 - SLACK, True, STEP_S)


def after_pause_s(p: Any, pattern: Pattern, pause_s: float) -> float:
    """Return the activation time after an hour of heating and a pause with standby."""
    rig = Rig(p, STEP_S)
    rig.run(np.ones(round(HEATED_S / STEP_S)))
    rig.run(pattern.signal(pause_s))
    return activation_s(rig)


def standby(p: Any, pattern: Pattern) -> Standby:
    """Return the settled effect of a pattern after an hour of heating; the margin includes its first pulses."""
    rig = Rig(p, STEP_S)
    rig.run(np.ones(round(HEATED_S / STEP_S)))
    rig.run(NONE.signal(FIRST_S))
    pulse, rest = (
        np.ones(round(pattern.pulse_s / STEP_S)),
        np.zeros(round((pattern.period_s - pattern.pulse_s) / STEP_S)),
    )
    warmest_J, opening, before_J = rig.core_J, 0.0, 0.0
    for _ in range(round(SETTLED_S / pattern.period_s)):
        before_J = rig.heater_J
        moved = rig.run(pulse)
        warmest_J = max(warmest_J, rig.core_J)
        opening = max(opening, float(moved.max(initial=0.0)), float(rig.run(rest).max(initial=0.0)))
    power_W = (rig.heater_J - before_J) / pattern.period_s
    return Standby(activation_s(rig), power_W, moving_C(p) - core_temperature_C(p, warmest_J), opening)


def pulse_s(period_s: float, holds: Callable[[Pattern], bool], largest: bool) -> float:
    """Return the largest or smallest whole-second pulse for which a condition holds; NaN if none."""
    low, high = (0, round(period_s))
    if not holds(Pattern(float(low if largest else high), period_s)):
        return float("nan")
    while high - low > 1:
        middle = (low + high) // 2
        if holds(Pattern(float(middle), period_s)) == largest:
            low = middle
        else:
            high = middle
    return float(low if largest else high)


def smallest(p: Any, period_s: float) -> Pattern:
    """Return the shortest pulses that keep full activation within the limit."""
    return Pattern(pulse_s(period_s, lambda q: standby(p, q).activation_s <= LIMIT_S, largest=False), period_s)


def largest(p: Any, period_s: float) -> Pattern:
    """Return the longest pulses that never move the piston."""
    return Pattern(pulse_s(period_s, lambda q: standby(p, q).opening <= 0.0, largest=True), period_s)


def motors() -> dict[str, dict[str, Any]]:
    """Return the two products and their variants by label, as parameters to complete."""
    found: dict[str, dict[str, Any]] = {f"product {product}": {"product": product} for product in "AB"}
    for label, (product, start, fixed) in VARIANTS.items():
        found[label] = refitted(product, fixed, start)
    return found


def opens_from_C(values: Mapping[str, Any], pattern: Pattern) -> float:
    """Return the ambient temperature from which a pattern moves the piston, to 0.1 K; infinity if not by 60 C."""
    low, high = 0.0, 60.0
    if standby(parameters({**values, "ambient_C": high}), pattern).opening <= 0.0:
        return float("inf")
    while high - low > 0.1:
        middle = 0.5 * (low + high)
        if standby(parameters({**values, "ambient_C": middle}), pattern).opening > 0.0:
            high = middle
        else:
            low = middle
    return high
