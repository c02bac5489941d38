"""What a real valve does that is not believed: its curve, what it lets through, how much flows at all."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from waxstudy.plugin import Belief, Choice, Effect, Parameters, Prior, parameter
from waxstudy_effects.description import changed_circuit, full_flow_L_h, room_hindrance
from waxstudy_effects.wrapping import believed, wrapped
from waxstudy_paper.valves import LinearValve, QuickOpeningValve

JUST_OPEN = (0.003, 0.008, 0.015)  # chosen: beyond the opening at which a valve lifts, within the 2 % between points
AUTHORITY = Prior(0.02, 1.0, noticeable=1.25, is_log=True)


def valve_of(belief: Belief) -> Choice:
    """Return the believed valve; none is a linear one."""
    return belief.blocks.get("valve", Choice(LinearValve, LinearValve.Parameters()))


def _authority(default: float) -> Any:
    return parameter(
        default,
        unit="1",
        gt=0.0,
        le=1.0,
        description="Authority N: pressure drop of the open valve over that of the pump.",
        source="section 3.2.2: 2.9 kPa of 30 kPa",
    )


class QuickOpeningParameters(Parameters):
    h_min: float = parameter(
        0.17, unit="1", ge=0.0, lt=1.0, description="Opening at which the flow starts.", source="section 4.2"
    )
    h_mid: float = parameter(
        0.41, unit="1", gt=0.0, lt=1.0, description="Opening at which the curve bends.", source="section 4.2"
    )
    v_mid: float = parameter(
        0.50, unit="1", ge=0.0, le=1.0, description="Theoretical flow at the bend.", source="section 4.2"
    )
    authority: float = _authority(0.097)


class QuickOpening(Effect):
    """The valve opens quickly, and the pressure across it rises as it closes, where a linear one is believed.

    The valve `quick-opening` with its flow full at the opening 1. Believed is h_min = 0, h_mid = v_mid = 0.5, N = 1.
    """

    name = "quick-opening"
    api_version = "1.0"
    stage = "valve"
    replaces = True
    Parameters = QuickOpeningParameters
    priors = {
        "h_min": Prior(0.0, 0.35, noticeable=0.03),
        "h_mid": Prior(0.36, 0.9, noticeable=0.05),
        "v_mid": Prior(0.1, 0.95, noticeable=0.05),
        "authority": AUTHORITY,
    }

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        is_linear = issubclass(valve_of(belief).component, LinearValve)
        return "" if is_linear else "another valve than a linear one is believed"

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        return {"h_min": 0.0, "h_mid": 0.5, "v_mid": 0.5, "authority": 1.0}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("valve", Choice.of(QuickOpeningValve, dict(p)))

    @classmethod
    def sentence(cls, p: Any) -> str:
        at_bend = 100.0 * corrected(p.v_mid, p.authority)
        return f"The valve opens quickly: at {100.0 * p.h_mid:.0f} % of its travel {at_bend:.0f} % of the flow passes."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        curve = {"h_min": 0.17, "h_mid": 0.41, "v_mid": 0.5}
        return [{**curve, "authority": authority} for authority in (0.097, 0.3, 1.0)]


class LowAuthorityParameters(Parameters):
    authority: float = _authority(0.097)


class LowAuthority(Effect):
    """The valve's authority is another than believed: V_a = V / sqrt(V^2 (1 - N) + N)."""

    name = "low-authority"
    api_version = "1.0"
    stage = "valve"
    Parameters = LowAuthorityParameters
    priors = {"authority": AUTHORITY}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return "" if belief.has("valve", "authority") else "the believed valve has no authority"

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        return {"authority": belief.value("valve", "authority")}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.changed("valve", authority=p.authority)

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"The valve's authority is {p.authority:.2f}."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"authority": authority} for authority in (0.05, 0.3, 0.8)]


class LetByParameters(Parameters):
    fraction: float = parameter(
        0.0,
        unit="1",
        ge=0.0,
        le=1.0,
        description="Theoretical flow through the closed valve, before the authority correction.",
        source="chosen: dirt on the seat, a worn seal",
    )


def corrected(flow: float, authority: float) -> float:
    """Return the flow fraction at an authority: V / sqrt(V^2 (1 - N) + N), section 3.2.2."""
    return flow / math.sqrt(flow * flow * (1.0 - authority) + authority)


def leaking(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Pass the leak, where the believed valve would pass less."""
    return max(min(1.0, p.let_by_fraction), believed(p, x, u, t, dt))


def leaking_at_authority(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Pass the leak at the pressure across the valve, where the believed valve would pass less."""
    return max(min(1.0, corrected(p.let_by_fraction, p.authority)), believed(p, x, u, t, dt))


class LetBy(Effect):
    """The closed valve lets a flow through: V = max(V_believed(h), fraction), then the authority correction.

    V_a = V / sqrt(V^2 (1 - N) + N) rises with V, so that V_a = max(V_a,believed, V_a(fraction)). N is the believed
    valve's `authority`, 1 where it has none. At N = 0.097, 0.015 lets 4.8 % of the full flow through.
    """

    name = "let-by"
    api_version = "1.0"
    stage = "valve"
    Parameters = LetByParameters
    priors = {"fraction": Prior(0.0, 0.3, noticeable=0.002)}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        step = leaking_at_authority if belief.has("valve", "authority") else leaking
        return belief.with_block("valve", wrapped(valve_of(belief), cls, p, step, both=max))

    @classmethod
    def sentence(cls, p: Any) -> str:
        leak = f"{100.0 * p.fraction:.1f} % of its flow through"
        return f"The closed valve lets {leak} at the pressure of an open one."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"fraction": fraction} for fraction in (0.01, 0.05, 0.15)]


class StuckOpenParameters(Parameters):
    opening: float = parameter(
        0.0,
        unit="1",
        ge=0.0,
        le=1.0,
        description="Opening that is never undercut.",
        source="chosen: a pin that jams, an actuator that is not pushed home",
    )


def stuck(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Let the believed valve be as open as it sticks."""
    return believed(p, x, max(p.stuck_open_opening, u), t, dt)


class StuckOpen(Effect):
    """The valve never closes further than to `opening`: V = V_believed(max(h, opening)).

    The actuator's displacement is as it was. Of a valve whose flow starts at h_min, less than that shows nowhere.
    """

    name = "stuck-open"
    api_version = "1.0"
    stage = "valve"
    Parameters = StuckOpenParameters
    priors = {"opening": Prior(0.0, 0.8, noticeable=0.02)}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("valve", wrapped(valve_of(belief), cls, p, stuck, both=max))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"The valve sticks and never closes below {100.0 * p.opening:.0f} % of its travel."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        # little flows at first: a point beside the opening at which the valve lifts shows nothing, or far too much
        lifts = belief.value("valve", "h_min") if belief.has("valve", "h_min") else 0.0
        openings = [percent / 100.0 for percent in (*range(2, 30, 2), 40, 60)]
        return [{"opening": opening} for opening in (*openings, *(lifts + beyond for beyond in JUST_OPEN))]


class MaxFlowParameters(Parameters):
    factor: float = parameter(
        1.0,
        unit="1",
        ge=0.05,
        le=5.0,
        description="Factor on the circuit's full flow.",
        source="chosen: balancing that was never done, a clogged filter",
    )


class MaxFlow(Effect):
    """The flow with the valve open is `factor` times the believed one; the valve's curve stays as it is.

    The circuit's full flow in the room's description changes; the exchange between water and floor follows from it.
    """

    name = "max-flow"
    api_version = "1.0"
    stage = "valve"
    Parameters = MaxFlowParameters
    priors = {"factor": Prior(0.2, 3.0, noticeable=1.04, is_log=True, as_built=0.1)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return room_hindrance(belief)

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return changed_circuit(belief, full_flow_L_h=p.factor * full_flow_L_h(belief))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"With the valve open, {p.factor:.2f} times the believed flow passes."
