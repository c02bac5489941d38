"""The numbers that the criteria (criteria.csv) are asked of: what speaks for an effect, and for what stays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.estimate.parameter_space import steps
from waxstudy.diagnosis.model.edits import EffectType
from waxstudy.diagnosis.model.travel import opening_difference_s, tolerated_s
from waxstudy.diagnosis.observations.partition import FIT, SELECT, SHRINK
from waxstudy.diagnosis.residuals.noise_floor import NoiseFloor
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.result import Interval, in_floors
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import Belief


@dataclass(frozen=True)
class Evidence:
    """What speaks for an effect that was fitted to the first part of a record, on the second."""

    stage: str
    channel: str  # where it gains most
    parameters: int  # how many are free
    gain: float  # loss that it takes away, but for what the drive's noise adds to it
    loss: float  # on both parts
    strain: float  # squares of how far the room had to depart from what is believed, in standard deviations
    over: float  # gap of the channel before it, over the larger floor of that model and of the best that was tried
    share: float  # of the channel's whitened loss above the floor that it explains
    plain_share: float  # the same of the squared gap in the channel's unit
    left: float  # whitened gap that is left of the channel, over its floor
    missed: float  # whitened gap that is left of the channel
    departure: float  # from what is believed, in noticeable steps, of the parameter that is farthest
    travel: float  # how far it moves the opening over what real motors stray; infinite of no motor
    p: float = 1.0  # family-wise
    form_share: float = 1.0  # squared, of what the room's form may leave: what it does leave here; 1 in a chain

    @property
    def gain_per_form(self) -> float:
        return self.gain / self.form_share if self.form_share else (np.inf if self.gain >= 0.0 else -np.inf)


@dataclass(frozen=True)
class Kept:
    """What speaks for an effect once everything is fitted to all days that a cause is looked for on."""

    stage: str
    parameters: int
    fresh_share: float  # of the squared gap that it takes away on days that nobody looked at; infinite without any
    whole_share: float  # of its gap above the floor over the whole record
    distinct: float  # noticeable steps, of the parameters whose interval leaves out what is believed

    @classmethod
    def of(
        cls,
        effect: EffectType,
        channel: str,
        before: Hypothesis,
        after: Hypothesis,
        floor: NoiseFloor | None = None,
        distinct: float = np.inf,
    ) -> Kept:
        """Return it; without a floor nothing is said of the whole record."""
        old, new = before.residual_of(channel), after.residual_of(channel)
        whole = explained(old.gap() ** 2, new.gap() ** 2, floor.plain[channel] ** 2) if floor else np.inf
        return cls(effect.stage, len(effect.priors), _fresh_share(old, new), whole, distinct)


def _fresh_share(old: Residual, new: Residual) -> float:
    if not (old.judged & (old.part == SHRINK)).any():
        return np.inf
    had, left = old.gap(SHRINK), new.gap(SHRINK)
    return 1.0 - left**2 / had**2 if had else (np.inf if not left else -np.inf)


@dataclass(frozen=True)
class AirLeft:
    """What stays of the air of a room."""

    over_form: float  # over the most that the room's form may leave
    share_left: float  # of what was missed before

    @classmethod
    def of(cls, before: Residual, after: Residual) -> AirLeft:
        return cls(in_floors(after.gap(), after.form), in_floors(after.gap(), before.gap()))


@dataclass(frozen=True)
class Late:
    """The gap of the last days."""

    growth: float  # over that of the days before
    over: float  # over the floor
    over_form: float  # over the most that a room's form may leave

    @classmethod
    def of(cls, residual: Residual, floor: float) -> Late:
        last, before = residual.gap(SHRINK), max(residual.gap(FIT), residual.gap(SELECT))
        return cls(in_floors(last, before), in_floors(last, floor), in_floors(last, residual.form))


@dataclass(frozen=True)
class Left:
    """What stays of a channel with all effects that were found; `over` may be asked for before the rest is known."""

    over: float = np.inf  # floors
    p: float = 1.0  # of drawing its cycles or days again
    over_form: float = np.inf  # over the most that the room's form may leave
    of_drives: float = np.inf  # over what drives that nobody recorded do to the channel


@dataclass(frozen=True)
class Exact:
    """A room exactly as believed, with effects: in floors of air and floor temperatures, the largest of them."""

    over_loose: float = 0.0  # left with all that nobody knows of the room
    over: float = np.inf  # without an effect, and of each channel that is named
    left: float = 0.0  # with the effects
    left_K: float = 0.0  # the same in kelvins, or what noise may hide


# --- numbers that several of them share ---


def travel_left(problem: SegmentProblem, fitted: Hypothesis, residual: Residual) -> float:
    """Return by how much an actuator is missed per switch, over what real ones stray or sampling tells."""
    channel = residual.channel
    if channel not in ("displacement", "flow_L_h") or "actuator" not in problem.segment.stages:
        return np.inf
    full = 1.0 if channel == "displacement" else float(np.nanmax(problem.record.values["flow_L_h"])) or 1.0
    beyond_noise = np.abs(residual.error) > WEIGHTS.surely_off * problem.record.noise[channel]
    error = residual.error * beyond_noise / full
    if problem.record.pulses and channel == "flow_L_h":
        error = error * problem.record.pulses.samples  # at the end of a span stands what all of it is missed by
    missed_s = opening_difference_s(problem.record, error)
    return missed_s / tolerated_s(problem.record, problem.belief_of(fitted))


def explained(before: float, after: float, least: float) -> float:
    """Return the share of what is missed above a floor that is explained, at most 1; nothing of what is within it."""
    return (before - after) / (before - min(least, after)) if before > least else 0.0


def departure(effect: EffectType, values: Mapping[str, float], believed: Belief) -> float:
    """Return how far an effect is from what is believed, in noticeable steps of the parameter that is farthest.

    Infinite of an effect that is neutral nowhere, as another kind of motor.
    """
    neutral = effect.neutral(believed)
    if neutral is None or not effect.priors:
        return np.inf
    both = effect.priors.keys() & neutral.keys() & values.keys()
    return max((steps(effect.priors[name], values[name], neutral[name]) for name in both), default=0.0)


def distinct(effect: EffectType, intervals: Mapping[str, Interval], believed: Belief) -> float:
    """Return the same of the parameters whose interval leaves out what is believed."""
    neutral = effect.neutral(believed) or {}
    without = [name for name, each in intervals.items() if not each.low <= neutral.get(name, np.nan) <= each.high]
    return departure(effect, {name: intervals[name].value for name in without}, believed)


def strongest(current: Hypothesis, fitted: Hypothesis, floor: NoiseFloor) -> tuple[str, float, float]:
    """Return the channel that gains most, the share of its gap above the floor that is explained, and what is left."""
    pairs = list(zip(current.residuals, fitted.residuals, strict=True))
    old, new = pairs[int(np.argmax([old.loss(SELECT) - new.loss(SELECT) for old, new in pairs]))]
    least = floor.white[old.channel] ** 2 * old.count(SELECT)
    before, after = old.loss(SELECT), new.loss(SELECT)
    left = float(np.sqrt(after / least)) if least > 0 else np.inf
    return old.channel, explained(before, after, least), left
