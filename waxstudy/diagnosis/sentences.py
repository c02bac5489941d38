"""What a diagnosis says in words; nothing is decided here."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from waxstudy.dataset.read import Dataset
from waxstudy.dataset.stand_ins import GAINS, SUN, SUPPLY_AIR
from waxstudy.diagnosis.criteria import ROOM_STAGES
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.result import FoundEffect, Lack, Unexplained, Untestable, Verdict
from waxstudy.diagnosis.select.candidate import Candidate
from waxstudy.diagnosis.select.posterior import NONE
from waxstudy.diagnosis.select.search import Selection, Withdrawn
from waxstudy.diagnosis.select.testability import in_words
from waxstudy.plugin import LinearRoom, Role

HELD = ("outdoor_temperature_C", "supply_temperature_C", SUN, GAINS)
LONG_GAP_H = 1.0
NOTHING = "the record shows no effect that the model lacks"
HEAT_IS_OFF = " Yet the room's heat is not as believed: no cause of that is sure enough to be named."
MOST_TOLD = 3  # sentences of a group; the others by name


def summary(
    verdict: Verdict,
    found: Sequence[FoundEffect],
    remains: Sequence[Unexplained],
    untestable: Sequence[Untestable],
    since: str = "",
    stages: Stages | None = None,
    heat_is_off: bool = False,
    is_quick: bool = False,
) -> str:
    """Return a diagnosis in a sentence or two; `since`: what the record was compared with, if it was."""
    if verdict in ("effect", "group"):
        return " ".join(group_sentence(effect) for effect in found)
    if verdict == "unknown":
        return " ".join(_unnamed(remains, "a quick look does not explain" if is_quick else "no known effect explains"))
    if verdict == "untestable":
        return f"This record cannot be judged: {_main_reason(untestable)}."
    nothing = _nothing(f"no change shows since {since}" if since else NOTHING, stages or Stages())
    return f"{nothing}{HEAT_IS_OFF if heat_is_off else ''}"


def _unnamed(remains: Sequence[Unexplained], what: str) -> Iterator[str]:
    """Yield where something is amiss that no effect explains, as `what` says, and where none is sure enough."""
    findings = [each for each in remains if each.is_finding]
    unknown = dict.fromkeys(each.stage for each in findings if not each.is_nameless)
    nameless = dict.fromkeys(each.stage for each in findings if each.is_nameless)
    if unknown:
        yield f"Something that {what} lies at: {', '.join(unknown)}."
    yield from (f"It looks as if {each.like}." for each in findings if each.like)
    if nameless:
        yield f"Something is amiss at: {', '.join(nameless)}. No effect is sure enough to be named."


@dataclass(frozen=True)
class Stages:
    """Stages that were judged, and those of which no effect could be."""

    judged: Sequence[str] = ()
    not_judged: Sequence[str] = ()


def _nothing(said: str, stages: Stages) -> str:
    """Return that nothing was found, and of what, where that is not the whole loop."""
    if not stages.not_judged:
        return f"{said[:1].upper()}{said[1:]}."
    return f"Of {in_words(stages.judged)}, {said}; {in_words(stages.not_judged)} could not be judged."


def _main_reason(untestable: Sequence[Untestable]) -> str:
    """Return the commonest reason, rather of what was recorded than of what was not."""
    recorded = [each.reason for each in untestable if each.lack is not Lack.NOT_RECORDED]
    reasons = recorded or [each.reason for each in untestable]
    return max(reasons, key=reasons.count, default="it holds too little")


def why_not(selection: Selection, candidate: Candidate) -> str:
    """Return why an effect that was tried is not named."""
    name = candidate.effect.name
    if selection.posterior:
        if selection.found:
            return "less likely than what is named"
        likelier = selection.posterior.get(name, 0.0) > selection.posterior.get(NONE, 0.0)
        return "not sure enough to be named" if likelier else "less likely than that nothing is amiss"
    for each in selection.withdrawn:
        if name in each.found.group:
            return each.criterion.name
    return candidate.why_not or (
        "another explains more" if selection.found else "another effect fitted better, but could not be kept"
    )


def warned(selections: Sequence[Selection]) -> Iterator[str]:
    """Yield what is to be said of effects that were found and not kept, or kept by days that chose them."""
    for selection in selections:
        yield from map(_withdrawn, selection.withdrawn)
        for found in () if selection.problem.holds_out else selection.found:
            name = found.effect.name
            yield f"{name} shows in the last days only: these helped to find it, so no held-out days confirm it"


def _withdrawn(each: Withdrawn) -> str:
    name, statistic = each.found.effect.name, each.criterion.statistic
    if statistic == "fresh_share":
        return f"{name} fitted the first days, but the last days do not confirm it: it is not claimed"
    if statistic == "distinct":
        return f"{name} explains a gap, but by its interval it may as well be what is believed: it is not claimed"
    missed = "the room" if each.found.effect.stage in ROOM_STAGES else each.found.channel
    return f"{name} explains a part of what {missed} is missed by, but too much stays: not claimed"


def logged(selections: Sequence[Selection]) -> list[str]:
    """Return how the record was taken to be logged, where its words leave a choice."""
    chosen = [selection.before.convention for selection in selections if len(selection.segment.conventions) > 1]
    return [convention.words for convention in chosen if convention.words]


def needless(selections: Sequence[Selection]) -> Iterator[str]:
    for selection in selections:
        if selection.problem.is_exact_room:
            names = " and ".join(found.effect.name for found in selection.found)
            yield f"The room is exactly as believed: with {names} nothing has to depart but how it began."


def group_sentence(effect: FoundEffect) -> str:
    """Return the sentence of an effect; of a group those of its members, lest the first be taken for the cause."""
    text = _either(effect)
    return f"{text.rstrip('.')} ({effect.slight})." if effect.slight else text


def _either(effect: FoundEffect) -> str:
    others = effect.alternatives[: MOST_TOLD - 1]
    known = {effect.name, *(each.name for each in others)}
    rest = [name for name in effect.group if name not in known]
    if not others and not rest:
        return effect.sentence
    clauses = [_clause(sentence) for sentence in (effect.sentence, *(each.sentence for each in others))]
    clauses += [f"one of: {', '.join(rest)}" if len(rest) > 1 else rest[0]] if rest else []
    return f"Either {', or '.join(clauses)}."


def _clause(sentence: str) -> str:
    """Return a sentence as a part of another one; a name that it begins with keeps its capitals."""
    text = sentence.rstrip(".")
    return text[:1].lower() + text[1:] if text[1:2].islower() or text[1:2] == " " else text


def filled_in(dataset: Dataset, record: Record, room: LinearRoom | None) -> Iterator[str]:
    """Yield a sentence for each input of the room that was not recorded, or not all the time, and what stands in."""
    setpoint_C = dataset.values.get("setpoint_C")
    if setpoint_C is not None and setpoint_C.notna().any() and setpoint_C.isna().iloc[0]:
        yield "setpoint_C begins later than the record: its first value is taken for the time before."
    if room is None or not record.has_inputs:
        return
    yield from (each.sentence for each in record.stand_ins.values())
    if room.places(Role.SUPPLY_AIR) and not record.has(SUPPLY_AIR):
        yield f"{SUPPLY_AIR} was not recorded: the supply air is as the room has it."
    if room.places(Role.SKY):
        yield "The temperature of the sky was not recorded: it is taken for that of the air outside."
    for channel in HELD:
        if record.has(channel) and (lost_h := _longest_gap_h(record, channel)) > LONG_GAP_H:
            yield f"{channel} is missing for up to {lost_h:.3g} h: a straight line stands in for it."


def _longest_gap_h(record: Record, channel: str) -> float:
    known = np.flatnonzero(np.isfinite(record.values[channel]))
    ends = np.concatenate(([-1], known, [len(record)]))
    return float(np.max(np.diff(ends)) - 1) * record.interval_s / 3600.0
