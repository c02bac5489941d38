"""The actuator `enthalpy`: a wax motor of two heat capacities and a piston with friction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from waxstudy.plugin import Actuator
from waxstudy_enthalpy.parameters import EnthalpyParameters

PROPORTIONAL = 1  # index of the choice in `input`
LONGEST_SUBSTEP_S = 5.0


@dataclass
class Motor:
    """State of the motor; the two energies count from the start."""

    core_J: float = 0.0  # enthalpy of heater, cup and wax; 0 where melting begins
    body_C: float = 0.0
    opening: float = 0.0
    heater_J: float = 0.0  # electrical energy taken up
    loss_J: float = 0.0  # heat given off to ambient
    substep_s: float = LONGEST_SUBSTEP_S


def melting_J(p: Any) -> float:
    """Return the enthalpy of the core from first to last melting [J]: latent heat, and warming over the range."""
    warming_J_K = p.cup_J_K + 0.5 * p.wax_g * (p.solid_J_gK + p.liquid_J_gK)
    return p.wax_g * p.latent_J_g + warming_J_K * p.melting_range_K


def core_temperature_C(p: Any, core_J: float) -> float:
    """Return the core's temperature: sensible heat below, linear over the melting range, sensible heat above."""
    if core_J < 0.0:
        return p.melting_C + core_J / (p.cup_J_K + p.wax_g * p.solid_J_gK)
    whole_J = melting_J(p)
    if core_J < whole_J:
        return p.melting_C + p.melting_range_K * core_J / whole_J
    liquid_J_K = p.cup_J_K + p.wax_g * p.liquid_J_gK
    return p.melting_C + p.melting_range_K + (core_J - whole_J) / liquid_J_K


def core_enthalpy_J(p: Any, core_C: float) -> float:
    """Return the core's enthalpy at a temperature (the inverse of `core_temperature_C`)."""
    above_K = core_C - p.melting_C
    if above_K < 0.0:
        return above_K * (p.cup_J_K + p.wax_g * p.solid_J_gK)
    if above_K < p.melting_range_K:
        return melting_J(p) * above_K / p.melting_range_K
    return melting_J(p) + (above_K - p.melting_range_K) * (p.cup_J_K + p.wax_g * p.liquid_J_gK)


def stored_J(p: Any, x: Any) -> float:
    """Return the heat stored in core and body, from an arbitrary zero [J]."""
    return x.core_J + p.body_J_K * x.body_C


def heater_W(p: Any, core_C: float) -> float:
    """Return the PTC heater's power: constant when cold, then falling in a line through (holding_C, holding_W)."""
    fall_W_K = (p.inrush_W - p.holding_W) / (p.holding_C - p.knee_C)
    return min(p.inrush_W, max(0.0, p.inrush_W - fall_W_K * (core_C - p.knee_C)))


def heater_share(p: Any, opening: float, u: float) -> float:
    """Return the share of its power that the heater gets: on or off, or throttled by the positioner.

    Proportional: ((1 + b) u - h) / b within 0..1 for signal u, opening h and band b, so that 1 opens fully.
    """
    if p.input == PROPORTIONAL:
        return min(1.0, max(0.0, ((1.0 + p.positioning_band) * u - opening) / p.positioning_band))
    return 1.0 if u > 0.5 else 0.0


def flows_W(p: Any, core_J: float, body_C: float, share: float) -> tuple[float, float, float]:
    """Return the heat flows from heater to core, core to body and body to ambient [W]."""
    core_C = core_temperature_C(p, core_J)
    heated_W = share * heater_W(p, core_C) if share > 0.0 else 0.0
    return heated_W, p.core_body_W_K * (core_C - body_C), p.body_ambient_W_K * (body_C - p.ambient_C)


def exchange_heat(p: Any, x: Any, share: float, h: float) -> None:
    """Advance both enthalpies by h seconds with the classical Runge-Kutta rule.

    C_core(T) dT_core/dt = heater - G (T_core - T_body);  C_body dT_body/dt = G (T_core - T_body) - K (T_body - T_amb).
    Energies are counted with the same weights, so that the balance closes to rounding. Spring work is left out.
    """
    half, body = 0.5 * h, 1.0 / p.body_J_K
    p1, q1, l1 = flows_W(p, x.core_J, x.body_C, share)
    p2, q2, l2 = flows_W(p, x.core_J + half * (p1 - q1), x.body_C + half * body * (q1 - l1), share)
    p3, q3, l3 = flows_W(p, x.core_J + half * (p2 - q2), x.body_C + half * body * (q2 - l2), share)
    p4, q4, l4 = flows_W(p, x.core_J + h * (p3 - q3), x.body_C + h * body * (q3 - l3), share)
    sixth = h / 6.0
    heated_J = sixth * (p1 + 2.0 * (p2 + p3) + p4)
    passed_J = sixth * (q1 + 2.0 * (q2 + q3) + q4)
    lost_J = sixth * (l1 + 2.0 * (l2 + l3) + l4)
    x.core_J += heated_J - passed_J
    x.body_C += body * (passed_J - lost_J)
    x.heater_J += heated_J
    x.loss_J += lost_J


def liquid_fraction(p: Any, core_J: float) -> float:
    """Return the melted fraction of the wax; it grows with the core's enthalpy."""
    return min(1.0, max(0.0, core_J / melting_J(p)))


def piston(p: Any, opening: float, liquid: float) -> float:
    """Return the opening at which spring, friction and wax are in balance, between the stops.

    Wax force F = (E f - s) / c holds the spring, F0 + k s, within friction R: a play of the wax's free travel E f,
    (E f - c (F0 + R)) / (1 + c k) <= s <= (E f - c (F0 - R)) / (1 + c k).
    """
    free_mm = p.expansion_mm * liquid
    give = 1.0 / (p.stroke_mm * (1.0 + p.compliance_mm_N * p.stiffness_N_mm))
    rising = (free_mm - p.compliance_mm_N * (p.preload_N + p.friction_N)) * give
    falling = (free_mm - p.compliance_mm_N * (p.preload_N - p.friction_N)) * give
    return min(1.0, max(0.0, min(falling, max(rising, opening))))


class Enthalpy(Actuator):
    """A lumped physical wax motor: PTC heater, wax with latent heat, body, ambient, spring and friction.

    Core (heater, cup, wax) and body are one temperature each; the core's state is its enthalpy. The paper (section 6)
    names such a model as missing; structure and numbers are chosen here and fitted to the times of its Table 2. No
    motor was measured. Starts at ambient temperature and closed, as after a long pause.
    """

    name = "enthalpy"
    api_version = "1.0"
    Parameters = EnthalpyParameters
    State = Motor
    examples = {
        "product A": {"product": "A"},
        "product B": {"product": "B"},
        "product B, 0-10 V": {"product": "B", "input": "proportional"},
    }

    @classmethod
    def start(cls, p: Any, dt: float) -> Motor:
        core_J = core_enthalpy_J(p, p.ambient_C)
        opening = piston(p, 0.0, liquid_fraction(p, core_J))
        return Motor(core_J=core_J, body_C=p.ambient_C, opening=opening, substep_s=substep_s(p))

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        parts = math.ceil(dt / x.substep_s)
        h = dt / parts
        for _ in range(parts):
            exchange_heat(p, x, heater_share(p, x.opening, u), h)
            x.opening = piston(p, x.opening, liquid_fraction(p, x.core_J))
        return x.opening


def substep_s(p: Any) -> float:
    """Return the longest substep that follows the fastest rate of the heat balance, and of the positioner if any."""
    core_J_K = p.cup_J_K + p.wax_g * min(p.solid_J_gK, p.liquid_J_gK)
    fall_W_K = (p.inrush_W - p.holding_W) / (p.holding_C - p.knee_C)
    rate = (p.core_body_W_K + fall_W_K) / core_J_K + (p.core_body_W_K + p.body_ambient_W_K) / p.body_J_K
    if p.input == PROPORTIONAL:  # the piston moves while wax melts
        rate += heater_W(p, p.melting_C) * p.expansion_mm / (melting_J(p) * p.stroke_mm * p.positioning_band)
    return min(LONGEST_SUBSTEP_S, 1.0 / rate)
