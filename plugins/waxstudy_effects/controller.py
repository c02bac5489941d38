"""What a real controller does that is not believed: it is set otherwise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from waxstudy.plugin import Belief, Effect, Parameters, Prior, parameter


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
