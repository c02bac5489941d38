"""What a real controller does that is not believed: it is set otherwise."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from waxstudy.plugin import Belief, Choice, Effect, Parameters, Prior, clock, parameter
from waxstudy_effects.wrapping import believed, is_wrapped, parameter_name, wrapped

DAY_H = 24.0
OFFSETS_K = (0.1, 0.2, 0.35, 0.5, 0.7, 1.0, 1.5, 2.5)  # an on-off controller answers in jumps: a fit begins near
ALL_DAY_H = 23.5  # what leaves out less than the half hour that is noticeable is there always


class DeadBandParameters(Parameters):
    dead_band_K: float = parameter(
        0.5,
        unit="K",
        ge=0.0,
        le=20.0,
        description="Full width of the dead band, half above and half below the setpoint.",
        source="Table 4: 2 K by default, 0.5 K adapted",
    )


class DeadBand(Effect):
    """The on-off controller switches `dead_band_K / 2` above and below the setpoint."""

    name = "dead-band"
    api_version = "1.0"
    stage = "controller"
    Parameters = DeadBandParameters
    priors = {"dead_band_K": Prior(0.0, 4.0, noticeable=0.05)}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return "" if belief.has("controller", "dead_band_K") else "the believed controller has no dead band"

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        return {"dead_band_K": belief.value("controller", "dead_band_K")}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.changed("controller", dead_band_K=p.dead_band_K)

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"The controller's dead band is {p.dead_band_K:.2f} K wide."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"dead_band_K": width_K} for width_K in (0.2, 0.5, 1.0, 2.0)]


class PITuningParameters(Parameters):
    gain: float = parameter(
        18.0,
        unit="1/K",
        gt=0.0,
        le=1000.0,
        description="Proportional gain.",
        source="Table 4: 0.3 by default, 18 adapted",
    )
    integration_time_s: float = parameter(
        2300.0,
        unit="s",
        gt=0.0,
        le=1e6,
        description="Integration time.",
        source="Table 4: 300 s by default, 2300 s adapted",
    )


class PITuning(Effect):
    """The PI controller has another gain and integration time; the tracking time stays as believed."""

    name = "pi-tuning"
    api_version = "1.0"
    stage = "controller"
    Parameters = PITuningParameters
    priors = {
        "gain": Prior(0.03, 100.0, noticeable=1.15, is_log=True),
        "integration_time_s": Prior(60.0, 36000.0, noticeable=1.15, is_log=True),
    }

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        is_pi = belief.has("controller", "gain", "integration_time_s")
        return "" if is_pi else "the believed controller is no PI controller"

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        return {name: belief.value("controller", name) for name in cls.Parameters.model_fields}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.changed("controller", gain=p.gain, integration_time_s=p.integration_time_s)

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"The PI controller is set to a gain of {p.gain:.3g} per K and to {p.integration_time_s:.0f} s."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"gain": 0.3, "integration_time_s": 300.0}, {"gain": 18.0, "integration_time_s": 2300.0}]


def offset_parameter(description: str, source: str) -> Any:
    return parameter(0.0, unit="K", ge=-10.0, le=10.0, description=description, source=source)


def hour_parameter(default: float, description: str) -> Any:
    return parameter(default, unit="h", ge=0.0, le=DAY_H, description=description, source="chosen")


class Hours(Parameters):
    from_h: float = hour_parameter(0.0, "Hour of the day from which it aims elsewhere.")
    to_h: float = hour_parameter(DAY_H, "Hour up to which it does, of the next day where that is no later: all day.")


class SetpointOffsetParameters(Hours):
    offset_K: float = offset_parameter(
        "What is added to the setpoint; below 0 the room is kept colder.",
        "chosen: dials are off by tenths of a kelvin, setbacks at night are of 1 to 4 K",
    )


class AimParameters(Hours):
    """Of a controller that has it: once always, and once more between two hours."""

    always_K: float = offset_parameter("What is added to the setpoint at all times.", "as of setpoint-offset")
    at_hours_K: float = offset_parameter("What is added between two hours besides.", "as of setpoint-offset")


def lasting_h(from_h: float, to_h: float) -> float:
    """Return how long a day it is from one hour to the other; the whole day where they are the same.

    >>> lasting_h(22.0, 6.0), lasting_h(0.0, 24.0), lasting_h(5.0, 5.0), lasting_h(24.0, 0.0)
    (8.0, 24.0, 24.0, 24.0)
    """
    from_h = from_h if from_h < DAY_H else from_h - DAY_H
    return to_h - from_h if to_h > from_h else to_h - from_h + DAY_H


def is_always(p: Any) -> bool:
    return lasting_h(p.from_h, p.to_h) >= ALL_DAY_H


def aiming(p: Any, x: Any, u: float, t: float, dt: float) -> float:
    """Let the believed controller see the error from where it truly aims."""
    from_h, to_h = p.setpoint_offset_from_h, p.setpoint_offset_to_h
    since_h = t / 3600.0 - from_h
    since_h -= DAY_H * math.floor(since_h / DAY_H)  # a remainder by `%` takes a processor as long as all else
    is_hour = since_h < lasting_h(from_h, to_h)
    offset_K = p.setpoint_offset_always_K + (p.setpoint_offset_at_hours_K if is_hour else 0.0)
    return believed(p, x, u + offset_K, t, dt)


class SetpointOffset(Effect):
    """The controller aims `offset_K` above the setpoint, always or every day between two hours.

    A setback at night is one below 0. Always and the other way round it does to the loop what a sensor's bias does:
    where the reading is not recorded nobody can tell them apart.
    """

    name = "setpoint-offset"
    api_version = "1.0"
    stage = "controller"
    Parameters = SetpointOffsetParameters
    # as built: the scale of a dial and who set it, a few tenths of a kelvin; hours are nobody's tolerance
    priors = {
        "offset_K": Prior(-5.0, 5.0, noticeable=0.05, as_built=0.2),
        "from_h": Prior(0.0, DAY_H, noticeable=0.5),
        "to_h": Prior(0.0, DAY_H, noticeable=0.5),
    }

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return "" if belief.has("controller") else "no controller is believed"

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        return {"offset_K": 0.0}  # at any hours

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("controller", _aimed(belief.blocks["controller"], p))

    @classmethod
    def hours(cls, p: Any) -> tuple[float, float] | None:
        return None if is_always(p) else super().hours(p)

    @classmethod
    def sentence(cls, p: Any) -> str:
        side = "above" if p.offset_K > 0.0 else "below"
        when = "at all times" if is_always(p) else f"every day from {clock(p.from_h)} to {clock(p.to_h)}"
        return f"The controller aims {abs(p.offset_K):.2f} K {side} the setpoint {when}."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        sizes_K = [side * size_K for size_K in OFFSETS_K for side in (-1.0, 1.0)]
        always = [{"offset_K": offset_K, "from_h": 0.0, "to_h": DAY_H} for offset_K in sizes_K]
        hours = [(3.0 * hour, lasts_h) for hour in range(8) for lasts_h in (3.0, 8.0)]
        found = [
            {"offset_K": offset_K, "from_h": from_h, "to_h": (from_h + lasts_h) % DAY_H}
            for offset_K in (-1.0, -0.2, 0.2, 1.0)
            for from_h, lasts_h in hours
        ]
        return [*always, *found]


class Aim(Effect):
    """What a controller that aims elsewhere has of it; never offered by itself."""

    name = SetpointOffset.name
    Parameters = AimParameters


def _aimed(controller: Choice, p: Any) -> Choice:
    """Return a controller that aims elsewhere; what it has of this already stays, and offsets add up."""
    had = _aim_of(controller)
    always_K, at_hours_K = (p.offset_K, 0.0) if is_always(p) else (0.0, p.offset_K)
    hours = (p.from_h, p.to_h) if at_hours_K else (had.from_h, had.to_h)
    if at_hours_K and had.at_hours_K and hours != (had.from_h, had.to_h):
        raise ValueError("the controller aims elsewhere between other hours already")
    whole_K = {"always_K": had.always_K + always_K, "at_hours_K": had.at_hours_K + at_hours_K}
    aim = AimParameters(from_h=hours[0], to_h=hours[1], **whole_K)
    if is_wrapped(controller, Aim):
        return controller.changed(**{parameter_name(Aim, name): value for name, value in dict(aim).items()})
    return wrapped(controller, Aim, aim, aiming)


def _aim_of(controller: Choice) -> AimParameters:
    if not is_wrapped(controller, Aim):
        return AimParameters()
    return AimParameters(
        **{name: getattr(controller.parameters, parameter_name(Aim, name)) for name in AimParameters.model_fields}
    )
