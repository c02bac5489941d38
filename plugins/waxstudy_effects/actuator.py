"""What a real actuator does that is not believed: it takes time, other times, or does not open fully."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from operator import mul
from typing import Any

from waxstudy.plugin import Belief, Block, Choice, Effect, NoState, Parameters, Prior, parameter
from waxstudy_effects.wrapping import believed, wrapped
from waxstudy_paper.actuators import PRODUCTS, ConstantTimes, IdealActuator, VariableTimes, steady_times

STEADY = "chosen: Table 2, product B, in the steady 15-15 min profile"
TABLE_2 = "Table 2, product B"
MOST_PAST = 1.2  # of product B's dependence on the past, with which a dead time may just vanish


def actuator_of(belief: Belief) -> Choice:
    """Return the believed actuator; none is an ideal one."""
    return belief.blocks.get("actuator", Choice(IdealActuator, IdealActuator.Parameters()))


def is_ideal(belief: Belief) -> bool:
    return actuator_of(belief).component is IdealActuator


class FourTimes(Parameters):
    dead_time_s: float = parameter(
        150.0, unit="s", ge=0.0, le=3600.0, description="From signal on to the first movement.", source=STEADY
    )
    rise_time_s: float = parameter(
        146.0, unit="s", gt=0.0, le=3600.0, description="From first movement to fully open.", source=STEADY
    )
    hold_time_s: float = parameter(
        110.0, unit="s", ge=0.0, le=3600.0, description="From signal off to the first movement.", source=STEADY
    )
    fall_time_s: float = parameter(
        123.0, unit="s", gt=0.0, le=3600.0, description="From first movement to closed.", source=STEADY
    )


class WaxTimes(FourTimes):
    """Times after a long past, and how far a short one shortens them."""

    past: float = parameter(
        0.0,
        unit="1",
        ge=0.0,
        le=MOST_PAST,
        description="Dependence of the times on pause and heating before: 0 none, 1 as Table 2 has it of product B.",
        source="chosen: dead, rise and hold time depend on it alike",
    )


SLOWEST_S = 900.0
FOUR_PRIORS = {
    "dead_time_s": Prior(0.0, SLOWEST_S, noticeable=20.0),
    "rise_time_s": Prior(10.0, SLOWEST_S, noticeable=1.2, is_log=True),
    "hold_time_s": Prior(0.0, SLOWEST_S, noticeable=20.0),
    "fall_time_s": Prior(10.0, SLOWEST_S, noticeable=1.2, is_log=True),
}


class WaxMotor(Effect):
    """The valve is moved by a wax motor, the actuator `variable-times`, where an ideal one is believed.

    Its times after a long past, and by how much a short one shortens them, in the form that Table 2 has of product B.
    A signal above 0.5 counts as on.
    """

    name = "wax-motor"
    api_version = "1.0"
    stage = "actuator"
    replaces = True
    Parameters = WaxTimes
    priors = {**FOUR_PRIORS, "past": Prior(0.0, MOST_PAST, noticeable=0.3)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return "" if is_ideal(belief) else "a real actuator is believed already"

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        return None

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("actuator", Choice.of(VariableTimes, with_past(p)))

    @classmethod
    def sentence(cls, p: Any) -> str:
        is_shorter = p.past >= cls.priors["past"].noticeable
        return (
            f"The actuator takes its time: {p.dead_time_s:.0f} s until it moves and {p.rise_time_s:.0f} s to open, "
            f"{p.hold_time_s:.0f} s until it moves back and {p.fall_time_s:.0f} s to close"
            + ("; after short pauses and short heating the first three are shorter." if is_shorter else ".")
        )

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        same = [{**steady_times(product), "past": 0.0} for product in PRODUCTS]
        return [*same, {**longest_times("B"), "past": 1.0}]


def longest_times(product: str) -> dict[str, float]:
    """Return the times [s] of a product after a long pause and long heating (Table 2)."""
    p = PRODUCTS[product]
    hold_s = p["hold_a_s"] + p["hold_b_s"]
    return dict(zip(FOUR_PRIORS, (p["dead_b_s"], p["rise_b_s"], hold_s, p["fall_s"]), strict=True))


def with_past(p: Any) -> dict[str, float]:
    """Return the coefficients of a motor with these times after a long past, and so much dependence on it."""
    b = PRODUCTS["B"]
    longest = longest_times("B")
    hold_a_s = p.past * p.hold_time_s * b["hold_a_s"] / longest["hold_time_s"]
    return {
        **b,  # time constants
        "dead_a_s": p.past * p.dead_time_s * b["dead_a_s"] / b["dead_b_s"],
        "dead_b_s": p.dead_time_s,
        "rise_a_s": p.past * p.rise_time_s * b["rise_a_s"] / b["rise_b_s"],
        "rise_b_s": p.rise_time_s,
        "hold_a_s": hold_a_s,
        "hold_b_s": p.hold_time_s - hold_a_s,
        "fall_s": p.fall_time_s,
    }


class WithConstantTimes(Effect):
    """The actuator's times do not depend on its past, where `variable-times` is believed.

    A pause after each switch, then a ramp from where the opening is; a signal above 0.5 counts as on.
    """

    name = "constant-times"
    api_version = "1.0"
    stage = "actuator"
    replaces = True
    Parameters = FourTimes
    priors = FOUR_PRIORS
    absorbs = ("slow-actuator",)

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        is_other = issubclass(actuator_of(belief).component, VariableTimes)
        return "" if is_other else "no actuator with times that vary is believed"

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        return None

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("actuator", Choice.of(ConstantTimes, dict(p)))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return (
            f"The actuator's times do not depend on its past: {p.dead_time_s:.0f} s dead, {p.rise_time_s:.0f} s rise, "
            f"{p.hold_time_s:.0f} s hold, {p.fall_time_s:.0f} s fall."
        )

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [steady_times(product) for product in PRODUCTS]


class Coefficients(Parameters):
    dead_a_s: float = parameter(
        -192.0, unit="s", ge=-3600.0, le=0.0, description="Dead time, coefficient a.", source=TABLE_2
    )
    dead_b_s: float = parameter(
        232.0, unit="s", ge=0.0, le=3600.0, description="Dead time after long cooling, b.", source=TABLE_2
    )
    dead_tau_s: float = parameter(
        780.0, unit="s", gt=0.0, le=36000.0, description="Dead time, time constant.", source=TABLE_2
    )
    rise_a_s: float = parameter(
        -30.0, unit="s", ge=-3600.0, le=0.0, description="Rise time, coefficient a.", source=TABLE_2
    )
    rise_b_s: float = parameter(
        163.0, unit="s", gt=0.0, le=3600.0, description="Rise time after long cooling, b.", source=TABLE_2
    )
    rise_tau_s: float = parameter(
        1140.0, unit="s", gt=0.0, le=36000.0, description="Rise time, time constant.", source=TABLE_2
    )
    hold_a_s: float = parameter(
        82.0, unit="s", ge=0.0, le=3600.0, description="Hold time, coefficient a.", source=TABLE_2
    )
    hold_b_s: float = parameter(
        58.0, unit="s", ge=0.0, le=3600.0, description="Hold time without overheating, b.", source=TABLE_2
    )
    hold_tau_s: float = parameter(
        600.0, unit="s", gt=0.0, le=36000.0, description="Hold time, time constant.", source=TABLE_2
    )
    fall_s: float = parameter(123.0, unit="s", gt=0.0, le=3600.0, description="Fall time.", source=TABLE_2)


TAU = Prior(60.0, 7200.0, noticeable=1.5, is_log=True)
COEFFICIENT_PRIORS = {
    "dead_a_s": Prior(-300.0, 0.0, noticeable=20.0),
    "dead_b_s": Prior(30.0, SLOWEST_S, noticeable=20.0),
    "dead_tau_s": TAU,
    "rise_a_s": Prior(-60.0, 0.0, noticeable=20.0),
    "rise_b_s": Prior(61.0, SLOWEST_S, noticeable=20.0),
    "rise_tau_s": TAU,
    "hold_a_s": Prior(0.0, 400.0, noticeable=20.0),
    "hold_b_s": Prior(0.0, 600.0, noticeable=20.0),
    "hold_tau_s": TAU,
    "fall_s": Prior(10.0, SLOWEST_S, noticeable=1.2, is_log=True),
}


class WithVariableTimes(Effect):
    """The actuator's times depend on its past (Table 2), where `constant-times` is believed.

    t = a exp(-t_in / tau) + b for dead and rise time, a (1 - exp(-t_in / tau)) + b for the hold time. Without a it is
    the believed one. `dead_a_s + dead_b_s < 0` is impossible, `rise_a_s + rise_b_s <= 0` too.
    """

    name = "variable-times"
    api_version = "1.0"
    stage = "actuator"
    replaces = True
    Parameters = Coefficients
    priors = COEFFICIENT_PRIORS
    absorbs = ("slow-actuator",)

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        is_other = issubclass(actuator_of(belief).component, ConstantTimes)
        return "" if is_other else "no actuator with constant times is believed"

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        times = {name: belief.value("actuator", name) for name in FourTimes.model_fields}
        still = {"dead_a_s": 0.0, "rise_a_s": 0.0, "hold_a_s": 0.0, "fall_s": times["fall_time_s"]}
        same = {f"{name}_b_s": times[f"{name}_time_s"] for name in ("dead", "rise", "hold")}
        return {**PRODUCTS["B"], **still, **same}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("actuator", Choice.of(VariableTimes, dict(p)))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return (
            f"The actuator's times depend on its past: it waits up to {p.dead_b_s:.0f} s before it opens after a long "
            f"pause, and up to {p.hold_a_s + p.hold_b_s:.0f} s before it closes after long heating."
        )

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [dict(PRODUCTS[product]) for product in PRODUCTS]


class SlowActuatorParameters(Parameters):
    factor: float = parameter(
        1.0,
        unit="1",
        ge=0.1,
        le=10.0,
        description="Factor on all times of the believed actuator; above 1 it is slower.",
        source="chosen: other products, other ambient temperatures, low voltage",
    )


def slowed(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Let the believed actuator live through less time than passes."""
    return believed(p, x, u, t / p.slow_actuator_factor, dt / p.slow_actuator_factor)


def started_slowly(p: Any, dt: float, block: Any) -> Any:
    """Start it at the step that it lives through: a delay of its own gets longer, too."""
    return block.start(p, dt / p.slow_actuator_factor)


class SlowActuator(Effect):
    """All times of the believed actuator are `factor` times as long, those of its memory too.

    Its own time runs slower: y(t) = believed(t / factor). So it works for any actuator that remembers something. What
    Table 2 gives scatters over the exemplars of one product by 13 to 21 s, and its displacement misses the measured one
    by up to 0.098 (Table A1): a factor of 1.4 is within that.
    """

    name = "slow-actuator"
    api_version = "1.0"
    stage = "actuator"
    Parameters = SlowActuatorParameters
    priors = {"factor": Prior(0.3, 4.0, noticeable=1.15, is_log=True, as_built=0.1)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        component = actuator_of(belief).component
        assert issubclass(component, Block)
        if component.State is NoState:
            return "the believed actuator takes no time"
        return ""

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("actuator", wrapped(actuator_of(belief), cls, p, slowed, started_slowly, both=mul))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"The actuator takes {p.factor:.2f} times as long as believed."


class LimitedTravelParameters(Parameters):
    opening: float = parameter(
        1.0,
        unit="1",
        ge=0.0,
        le=1.0,
        description="Opening that is never exceeded.",
        source="chosen: a stroke too short, an adapter that does not fit, a preset valve insert",
    )


def limited(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Stop the believed opening at the limit."""
    return min(p.limited_travel_opening, believed(p, x, u, t, dt))


class LimitedTravel(Effect):
    """The opening never exceeds `opening`: h = min(believed, opening).

    The believed displacement of Table 2 misses the measured one by up to 0.098 (Table A1), which a limit of 0.9 is
    within.
    """

    name = "limited-travel"
    api_version = "1.0"
    stage = "actuator"
    Parameters = LimitedTravelParameters
    priors = {"opening": Prior(0.05, 1.0, noticeable=0.05)}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("actuator", wrapped(actuator_of(belief), cls, p, limited, both=min))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"The actuator never opens the valve beyond {100.0 * p.opening:.0f} % of its travel."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"opening": opening} for opening in (0.3, 0.6, 0.85)]
