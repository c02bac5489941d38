"""What stands between a controller's output and the heating signal, and is not believed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from waxstudy.plugin import Belief, Choice, Effect, FloatArray, Parameters, Prior, parameter
from waxstudy_paper.modulators import Pwm

FEWEST_RISES, MOST_RISES = 8, 1000  # the more, the more periods have to be tried
CLOSE = 0.9  # of the best hit: a fraction of a period is hit as often, the longest that is hit is meant
NEAR = 0.02
BLOCK = 256  # frequencies that are turned at once
USUAL_S = (600.0, 900.0, 1200.0, 1800.0, 3600.0)  # periods of manifold controllers


class PeriodParameters(Parameters):
    period_s: float = parameter(
        3600.0,
        unit="s",
        gt=0.0,
        le=86400.0,
        description="Period; a decision is taken at the start of each.",
        source="section 3.3: once per hour",
    )


class MinPulseParameters(Parameters):
    min_pulse_s: float = parameter(
        300.0,
        unit="s",
        ge=0.0,
        le=43200.0,
        description="Shortest pulse and shortest pause; a shorter one is left out.",
        source="section 3.1.2 asks for 3 to 5 min of heating and cooling",
    )


class ModulationParameters(PeriodParameters, MinPulseParameters):
    """Of the whole modulator."""


PERIOD = Prior(300.0, 14400.0, noticeable=1.002, is_log=True)  # three minutes a day, which no clock is off by
MIN_PULSE = Prior(0.0, 1800.0, noticeable=30.0)


def likely_periods_s(belief: Belief) -> Sequence[float]:
    """Return periods to start from: the usual ones, and those at whose starts the recorded signal switches on.

    A period must be hit closely: after two weeks an error of a thousandth has pulses where pauses are.
    """
    signal = belief.inputs.signal if belief.inputs else None
    if belief.inputs is None or signal is None:
        return USUAL_S
    rises = np.flatnonzero(np.diff(signal) > 0.5)[:MOST_RISES] + 1
    if len(rises) < FEWEST_RISES:
        return USUAL_S
    at_s = belief.inputs.start_s + (rises + 0.5) * belief.inputs.interval_s
    return (*USUAL_S, _period_s(tuple(at_s.tolist())))


@lru_cache(maxsize=8)
def _period_s(at_s: tuple[float, ...]) -> float:
    """Return the longest period at whose starts most of some times [s] lie."""
    times_s, span_s = np.array(at_s), at_s[-1] - at_s[0]
    often_Hz = np.arange(1.0 / PERIOD.high, 1.0 / PERIOD.low, 0.1 / span_s)
    periods_s = 1.0 / often_Hz
    # an interval's length of doubt about each switch is nothing beside a period
    hits = _together(times_s - times_s[0], often_Hz)
    longest = np.flatnonzero(hits >= CLOSE * hits.max())[0]
    near = np.abs(periods_s / periods_s[longest] - 1.0) < NEAR
    return float(periods_s[near][np.argmax(hits[near])])


def _together(times_s: FloatArray, often_Hz: FloatArray) -> FloatArray:
    """Return how far times (n,) lie together in the cycles of evenly spaced frequencies (m,): 1 if all at one phase.

    Frequencies of a block differ from its first one alike in every block, which turns sums into products of matrices.
    """
    starts_Hz, steps_Hz = often_Hz[::BLOCK], often_Hz[:BLOCK] - often_Hz[0]
    turned = np.exp(2j * np.pi * np.outer(starts_Hz, times_s)) @ np.exp(2j * np.pi * np.outer(times_s, steps_Hz))
    return np.asarray(np.abs(turned).reshape(-1)[: len(often_Hz)] / len(times_s))


def is_continuous(belief: Belief) -> bool:
    """Whether the controller's output takes values between 0 and 1: all do but those with a dead band."""
    return belief.has("controller") and not belief.has("controller", "dead_band_K")


class Modulation(Effect):
    """A pulse-width modulation turns the controller's continuous output into pulses, where none is believed."""

    name = "modulation"
    api_version = "1.0"
    stage = "modulator"
    replaces = True
    Parameters = ModulationParameters
    priors = {"period_s": PERIOD, "min_pulse_s": MIN_PULSE}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        if belief.has("modulator"):
            return "a modulator is believed already"
        if not belief.has("controller"):
            return "no controller is believed"
        return "" if is_continuous(belief) else "the believed controller switches on and off itself"

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        return None

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.with_block("modulator", Choice.of(Pwm, dict(p)))

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"The controller's output is turned into pulses, one every {p.period_s / 60.0:.0f} min."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"period_s": period_s, "min_pulse_s": 0.0} for period_s in likely_periods_s(belief)]


class PwmPeriod(Effect):
    """The pulse-width modulation has another period."""

    name = "pwm-period"
    api_version = "1.0"
    stage = "modulator"
    Parameters = PeriodParameters
    priors = {"period_s": PERIOD}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return "" if belief.has("modulator", "period_s") else "no modulator with a period is believed"

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        return {"period_s": belief.value("modulator", "period_s")}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.changed("modulator", period_s=p.period_s)

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"The modulation decides once every {p.period_s / 60.0:.1f} min."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"period_s": period_s} for period_s in likely_periods_s(belief)]


class MinPulse(Effect):
    """The pulse-width modulation leaves out pulses and pauses shorter than `min_pulse_s`."""

    name = "min-pulse"
    api_version = "1.0"
    stage = "modulator"
    Parameters = MinPulseParameters
    priors = {"min_pulse_s": MIN_PULSE}

    @classmethod
    def hindrance(cls, belief: Belief) -> str:
        return "" if belief.has("modulator", "min_pulse_s") else "no modulator with a shortest pulse is believed"

    @classmethod
    def neutral(cls, belief: Belief) -> Mapping[str, float] | None:
        return {"min_pulse_s": belief.value("modulator", "min_pulse_s")}

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        return belief.changed("modulator", min_pulse_s=p.min_pulse_s)

    @classmethod
    def sentence(cls, p: Any) -> str:
        return f"Pulses and pauses shorter than {p.min_pulse_s:.0f} s are left out."

    @classmethod
    def starts(cls, belief: Belief) -> Sequence[Mapping[str, float]]:
        return [{"min_pulse_s": pulse_s} for pulse_s in (0.0, 180.0, 600.0)]
