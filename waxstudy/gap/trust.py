"""Whether what was found is to be trusted: the last days confirm it, and the room is understood with it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from waxstudy.gap.candidate import explained
from waxstudy.gap.claim import EXPLAINED
from waxstudy.gap.fit import Fitter
from waxstudy.gap.fitted import Fitted
from waxstudy.gap.floor import Floor
from waxstudy.gap.judge import FIT, SELECT, SHRINK, Errors
from waxstudy.gap.links import ROOM_STAGES
from waxstudy.gap.result import FoundEffect
from waxstudy.gap.room import room_error
from waxstudy.gap.space import EffectType
from waxstudy.plugin import Belief

CONFIRMED = 0.25  # of the square of a gap that an effect must take away on days that nobody looked at
MUCH = 0.25  # of what a room was missed by, that effects may leave and still be trusted
LATE = 2.0  # times the gap of the days before, at which the last days show something that those did not
OF_AIR = ("air_temperature_C", "operative_temperature_C")


def is_confirmed(channel: str, before: Fitted, after: Fitted) -> bool:
    """Whether the last part, if there is one, is missed by more without an effect at a channel than with it."""
    old, new = before.errors_of(channel), after.errors_of(channel)
    had, left = old.gap(SHRINK), new.gap(SHRINK)
    return left**2 <= (1.0 - CONFIRMED) * had**2 or not (old.judged & (old.part == SHRINK)).any()


def kept_share(channel: str, before: Fitted, after: Fitted, floor: Floor) -> float:
    """Return the share of a channel's gap that an effect explains of the whole record, all else fitted again."""
    old, new = (model.errors_of(channel).gap() for model in (before, after))
    return explained(old**2, new**2, floor.plain[channel] ** 2)


def is_poor(fitter: Fitter, before: Fitted, after: Fitted) -> bool:
    """Whether the air of a room by itself stays missed by more than its form may leave, and by much of what it was."""
    if fitter.link.stages != ROOM_STAGES:
        return False
    pairs = [each for each in zip(before.errors, after.errors, strict=True) if each[0].channel in OF_AIR]
    belief = fitter.belief
    return any(new.gap() > max(room_error(belief, new.channel).most_K, MUCH * old.gap()) for old, new in pairs)


def is_late(fitter: Fitter, errors: Errors, floor: Floor) -> bool:
    """Whether the last days show a gap at a channel that those before did not."""
    last, before = errors.gap(SHRINK), max(errors.gap(FIT), errors.gap(SELECT))
    form_K = room_error(fitter.belief, errors.channel).most_K if fitter.link.with_room else 0.0
    return last > max(LATE * before, EXPLAINED * floor.plain[errors.channel], form_K)


def reaching_belief(found: Sequence[FoundEffect], effects: Sequence[EffectType], belief: Belief) -> Iterator[str]:
    """Yield what to say of effects of which every interval holds what is believed."""
    types = {effect.name: effect for effect in effects}
    for each in found:
        neutral = types[each.name].neutral(belief) or {}
        known = [(each.parameters[name], value) for name, value in neutral.items() if name in each.parameters]
        if known and all(interval.low <= value <= interval.high for interval, value in known):
            yield f"{each.name}: its intervals reach to what is believed; it may be slight, or something else"
