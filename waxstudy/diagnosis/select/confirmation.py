"""Whether what was found is to be trusted: the last days confirm it, and the room is understood with it."""

from __future__ import annotations

from collections.abc import Mapping

from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.noise_floor import NoiseFloor
from waxstudy.diagnosis.estimate.parameter_space import EffectType
from waxstudy.diagnosis.model.room_response import ROOM_FORM_K
from waxstudy.diagnosis.model.segments import ROOM_STAGES, Segment
from waxstudy.diagnosis.residuals.judge import FIT, SELECT, SHRINK, Residual
from waxstudy.diagnosis.result import Interval
from waxstudy.diagnosis.select.candidate import departs, explained
from waxstudy.diagnosis.select.criteria import EXPLAINED
from waxstudy.plugin import Belief

CONFIRMED = 0.25  # of the square of a gap that an effect must take away on days that nobody looked at
MUCH = 0.25  # of what a room was missed by, that effects may leave and still be trusted
LATE = 2.0  # times the gap of the days before, at which the last days show something that those did not
OF_AIR = ("air_temperature_C", "operative_temperature_C")


def is_confirmed(channel: str, before: Hypothesis, after: Hypothesis) -> bool:
    """Whether the last part, if there is one, is missed by more without an effect at a channel than with it."""
    old, new = before.residual_of(channel), after.residual_of(channel)
    had, left = old.gap(SHRINK), new.gap(SHRINK)
    return left**2 <= (1.0 - CONFIRMED) * had**2 or not (old.judged & (old.part == SHRINK)).any()


def kept_share(channel: str, before: Hypothesis, after: Hypothesis, floor: NoiseFloor) -> float:
    """Return the share of a channel's gap that an effect explains of the whole record, all else fitted again."""
    old, new = (model.residual_of(channel).gap() for model in (before, after))
    return explained(old**2, new**2, floor.plain[channel] ** 2)


def is_poor(segment: Segment, before: Hypothesis, after: Hypothesis) -> bool:
    """Whether the air of a room by itself stays missed by more than its form may leave, and by much of what it was."""
    if segment.stages != ROOM_STAGES:
        return False
    pairs = [each for each in zip(before.residuals, after.residuals, strict=True) if each[0].channel in OF_AIR]
    return any(new.gap() > max(ROOM_FORM_K[new.channel], MUCH * old.gap()) for old, new in pairs)


def is_late(segment: Segment, residual: Residual, floor: NoiseFloor) -> bool:
    """Whether the last days show a gap at a channel that those before did not."""
    last, before = residual.gap(SHRINK), max(residual.gap(FIT), residual.gap(SELECT))
    form_K = ROOM_FORM_K.get(residual.channel, 0.0) if segment.with_room else 0.0
    return last > max(LATE * before, EXPLAINED * floor.plain[residual.channel], form_K)


def is_distinct(effect: EffectType, intervals: Mapping[str, Interval], believed: Belief) -> bool:
    """Whether a parameter is noticeably off what is believed, and its interval leaves that out."""
    neutral = effect.neutral(believed)
    if neutral is None or not effect.priors:
        return True
    known = [(effect.priors[name], intervals[name], neutral[name]) for name in effect.priors.keys() & neutral.keys()]
    return any(departs(prior, i.value, still) and not i.low <= still <= i.high for prior, i, still in known)
