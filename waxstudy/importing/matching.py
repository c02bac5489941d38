"""Which entity is which channel: by name, unit and values, with how sure that is and why."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from waxstudy.dataset.channels import CHANNELS
from waxstudy.importing import units
from waxstudy.importing.limits import (
    ALIKE,
    BY_VALUES,
    CLEAR,
    COLDEST_C,
    EXACT,
    FOLLOWING,
    LEAST_SURE,
    MOST_SURE,
    OTHER_WORDS,
    ROOM,
    STRANGE,
    SURE,
    UNIT,
    VAGUE,
    VALUES,
    WARMEST_C,
    WEAK,
)
from waxstudy.importing.names import CHANNEL_NAMES, NEITHER, OTHERS, has_other_words, is_of_room, plain, says, says_no
from waxstudy.importing.seen import Seen, by_values, is_plausible

TWICE = ("supply_temperature_C", "return_temperature_C")
OF_HOUSE = (*TWICE, "flow_L_h", "outdoor_temperature_C", "global_irradiance_W_m2", "diffuse_irradiance_W_m2",
            "photovoltaic_power_W", "ventilation_supply_temperature_C", "neighbour_temperature_C")  # fmt: skip


@dataclass(frozen=True)
class Match:
    """An entity as a channel."""

    channel: str
    seen: Seen
    confidence: float  # 0 to 1
    why: str
    rivals: tuple[str, ...] = ()  # entities that fit equally well
    is_by_values: bool = False  # no name tells it
    is_stated: bool = False

    @property
    def is_sure(self) -> bool:
        return self.confidence >= SURE and not self.rivals


def matched(entities: Sequence[Seen], stated: Mapping[str, str], room: str) -> dict[str, Match]:
    """Return the proposal: an entity at most for each channel; what was stated goes first, an empty name is none."""
    by_name = {each.entity: each for each in entities}
    found = {
        channel: Match(channel, by_name[entity], 1.0, "stated", is_stated=True)
        for channel, entity in stated.items()
        if entity
    }
    free = [each for each in entities if each.entity not in stated.values()]
    open_channels = [channel for channel in CHANNELS if channel not in stated]
    scores = [match for each in free for channel in open_channels if (match := _match(each, channel, room))]
    scores.sort(key=lambda match: -match.confidence)
    for match in scores:
        taken = {each.seen.entity for each in found.values()}
        if match.channel not in found and match.seen.entity not in taken:
            found[match.channel] = match
    settled = {match.seen.entity: match.confidence for match in found.values()}
    for match in scores:
        best, entity = found.get(match.channel), match.seen.entity
        # an entity that went elsewhere would have fitted here better
        is_left = entity not in settled or settled[entity] < match.confidence - ALIKE
        if best and is_left and best.seen.entity != entity and best.confidence - match.confidence < ALIKE:
            found[match.channel] = replace(best, rivals=(*best.rivals, entity))
    return _water(_flow_and_return({channel: found[channel] for channel in CHANNELS if channel in found}))


def _flow_and_return(found: dict[str, Match]) -> dict[str, Match]:
    """Return a flow without a unit, beside a return, as the supply temperature that it may be: it is called so, too."""
    flow, back = found.get("flow_L_h"), found.get("return_temperature_C")
    if flow is None or back is None or "supply_temperature_C" in found or flow.is_stated:
        return found
    seen, of_back = flow.seen, back.seen
    is_warmer = of_back.median <= seen.median < WARMEST_C and seen.low >= COLDEST_C
    if seen.is_unit_written or seen.is_counter or not is_warmer:
        return found
    supply = replace(flow, channel="supply_temperature_C", confidence=round(SURE - ALIKE, 2))
    return {channel: each for channel, each in found.items() if channel != "flow_L_h"} | {supply.channel: supply}


def _match(each: Seen, channel: str, room: str) -> Match | None:
    """Return how well an entity is a channel, None where it is none."""
    quantity = CHANNELS[channel].quantity
    is_like = is_plausible(each, quantity)
    if is_like is None:
        return None
    score, why = _by_name(each, channel)
    is_open = score == 0.0 and not _names_another(each, channel)
    is_by_values = is_open and by_values(each, channel, quantity)
    if is_by_values:
        score, why = BY_VALUES, ["values alone"]
        if channel in TWICE and each.following > FOLLOWING:
            why.append(f"follows the valve (correlation {each.following:.2f})")
    if score == 0.0:
        return None
    if each.unit:
        score += UNIT if each.is_unit_written else 0.0
        why.append(f"unit '{each.unit}', {each.why_unit}")
    if channel == "heating_signal" and not each.is_two_state:
        is_like = False  # a signal is on or off, an output or opening is anything between
    if channel == "displacement" and each.is_two_state:
        is_like = False
    if score != EXACT:  # what a name says to the letter, the checks of datasets judge
        score += VALUES if is_like else -STRANGE
    why.append(each.range_words + ("" if is_like else ", strange for it"))
    score += _by_room(each, channel, room) if room else 0.0
    if score < LEAST_SURE:
        return None
    return Match(channel, each, round(min(score, MOST_SURE), 2), "; ".join(why), is_by_values=is_by_values)


def _by_room(each: Seen, channel: str, room: str) -> float:
    if is_of_room(each.entity, room):
        return ROOM
    is_written = each.entity == channel or channel in OF_HOUSE or not has_other_words(each.entity)
    return 0.0 if is_written else -OTHER_WORDS


def _by_name(each: Seen, channel: str) -> tuple[float, list[str]]:
    if each.entity == channel:
        return EXACT, ["the channel's own name"]
    name, words = plain(each.entity), CHANNEL_NAMES[channel]
    if says_no(name, channel, _has_degrees(each)):
        return 0.0, []
    if says(name, words.clear):
        return CLEAR, ["name"]
    if says(name, words.weak):
        return WEAK, ["part of its name"]
    return (VAGUE, ["a word of its name that other things have, too"]) if says(name, words.vague) else (0.0, [])


def is_kept_by_unit(each: Seen) -> bool:
    """Whether a name says clearly that an entity is a channel, and its unit fits none that the name says."""
    named = [channel for channel in CHANNELS if _by_name(each, channel)[0] >= CLEAR]
    return bool(named) and all(is_plausible(each, CHANNELS[channel].quantity) is None for channel in named)


def _names_another(each: Seen, channel: str) -> bool:
    """Whether a name says clearly that an entity is something else, or is not of a channel."""
    name = plain(each.entity)
    others = [words.clear for other, words in CHANNEL_NAMES.items() if other != channel]
    has_degrees = _has_degrees(each)
    against = (*others, NEITHER) if has_degrees else (*others, OTHERS, NEITHER)
    return says_no(name, channel, has_degrees) or any(says(name, words) for words in against)


def _has_degrees(each: Seen) -> bool:
    """Whether the unit of a temperature is written."""
    return each.is_unit_written and bool(units.fitting(each.unit, ["indoor"]))


def _water(found: dict[str, Match]) -> dict[str, Match]:
    """Return supply and return the right way round, where values alone told that both are water."""
    if set(TWICE) <= set(found) and all(found[name].is_by_values for name in TWICE):
        supply, back = (found[name] for name in TWICE)
        if back.seen.high > supply.seen.high:  # heat is given off between them
            found |= {TWICE[0]: replace(back, channel=TWICE[0]), TWICE[1]: replace(supply, channel=TWICE[1])}
    return found
