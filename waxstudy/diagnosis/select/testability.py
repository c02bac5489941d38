"""Which effects a record could not show, why, and what to measure next."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from waxstudy.dataset.channels import CHANNELS, SHOW_ROOM
from waxstudy.diagnosis.criteria import ROOM_STAGES, Question, limit
from waxstudy.diagnosis.estimate.parameter_space import Space, stepped
from waxstudy.diagnosis.model.edits import EffectType, Values
from waxstudy.diagnosis.model.segments import SHOWN, Segment
from waxstudy.diagnosis.model.shares import hidden_pulses
from waxstudy.diagnosis.observations.noise import ON
from waxstudy.diagnosis.observations.record import AIR, SPARSE_S, Record
from waxstudy.diagnosis.result import FoundEffect, Lack, Measurement, Untestable
from waxstudy.diagnosis.select.search import OF_AIR, Selection
from waxstudy.diagnosis.weights import WEIGHTS
from waxstudy.plugin import CHAIN, Belief, SimulationError

FEW = 0.1  # of a first look's points
CLEAR = 4  # noticeable steps from neutral that a record should show
LEVELS = ("control_output", "displacement")
DOUBTFUL = 3.0  # times a usual instrument's noise
STEADY = 0.1  # range of a level that stays where it is
DRIVES = ("supply_temperature_C", "outdoor_temperature_C")


def too_short(segment: Segment, record: Record, belief: Belief) -> str:
    """Return why a segment cannot be judged at all, or an empty text."""
    hidden = hidden_pulses(record, belief)
    if not segment.with_room and (means := [name for name in (segment.driven_by, *segment.judged) if name in hidden]):
        apart = f"{record.interval_s / 60.0:g} min"
        return f"{means[0]} was logged as means of {apart}, which hide its pulses; samples of a minute show them"
    channel = _best_known(segment, record)
    blocks = np.unique((record.day if segment.with_room else record.cycle)[record.settled & _known(record, channel)])
    least_blocks, least_share = limit(Question.JUDGE, "blocks"), limit(Question.JUDGE, "known_share")
    if len(blocks) < least_blocks:
        one = "day" if segment.with_room else "cycle"
        found = f"{len(blocks)} {one if len(blocks) == 1 else f'{one}s'} of {channel}"
        return f"only {found} can be judged after the first hours, {least_blocks:g} are needed"
    # what stands although it should move shows a dead motor, a signal that is always on one that stands elsewhere
    if record.is_still(channel):
        if not _should_move(segment, record, belief, channel):
            return f"{channel} never changes in this record"
    elif record.is_still(segment.driven_by) and not (
        _needs_none(segment, record) or _stands(record, channel, segment.driven_by)
    ):
        return f"{segment.driven_by} never changes in this record"
    share = float(_known(record, channel).mean())
    if share < least_share:
        return f"{100 * (1 - share):.0f} % of {channel} is missing"
    driven = ~record.is_gap(segment.driven_by) & (record.driven if segment.with_room else True)
    judged = float((_known(record, channel) & driven).mean())
    lost = "outdoor air, supply, flow, sun or gains" if segment.with_room else segment.driven_by
    is_lost = judged < limit(Question.JUDGE, "driven_share")
    return f"{100 * (1 - judged):.0f} % is lost in gaps of {lost}" if is_lost else ""


def _should_move(segment: Segment, record: Record, belief: Belief, channel: str) -> bool:
    """Whether a constant channel is elsewhere than the belief has it, at some time.

    A controller that asks for nothing may have been told to: that shows nothing of it.
    """
    if segment.with_room or {"sensor", "controller"} & set(segment.stages):
        return False
    try:
        predicted = segment.predict(record, belief, segment.conventions[0])[channel]
    except (SimulationError, ValueError):
        return False
    off = np.abs(predicted - record.filled(channel))
    return float(off.max()) > STEADY * max(float(np.abs(predicted).max()), 1e-9)


def _needs_none(segment: Segment, record: Record) -> bool:
    """Whether a room stays warmer than its setpoint and nothing of its loop heats: the weather alone drives it.

    What else stands still may be a dead meter.
    """
    sensed, chain = record.sensed_channel, filter(record.has, ("heating_signal", *LEVELS))
    if not (segment.with_room and sensed and record.has("setpoint_C")):
        return False
    if any(np.nanmax(record.values[channel]) > STEADY for channel in chain):
        return False
    above_K = record.values[sensed] - record.values["setpoint_C"]
    return bool(np.nanmin(above_K) > 0.0 and np.nanmax(record.values[segment.driven_by]) <= 0.0)


def _best_known(segment: Segment, record: Record) -> str:
    """Return what shows the whole of a segment: the last channel, of a room's the one that misses least."""
    shown = segment.judged if segment.with_room else segment.judged[-1:]
    return max(shown, key=lambda each: _known(record, each).mean())


def _stands(record: Record, channel: str, driven_by: str) -> bool:
    """Whether a level stays where it is, but for noise, or a flow that nothing drives never stops.

    Other circuits and the pump move it: of a valve that is always open it shows nothing.
    """
    low, high = np.nanquantile(record.values[channel], (0.01, 0.99))
    if channel == "flow_L_h":
        return bool(low > WEIGHTS.flows * high and np.nanmax(record.values[driven_by]) <= ON)
    return channel in LEVELS and bool(high - low < STEADY)


def _known(record: Record, channel: str) -> np.ndarray:
    return np.isfinite(record.values[channel])


def uncovered(
    effects: Sequence[EffectType], segments: Sequence[Segment], record: Record, belief: Belief
) -> Iterator[Untestable]:
    """Yield the effects whose stage no segment covers, with what is missing."""
    covered = {stage for segment in segments for stage in segment.stages}
    for effect in effects:
        # without a record of what drives a room no effect of its own can be thought of
        is_lacking = belief.room is not None and belief.inputs is None and effect.stage in ROOM_STAGES
        if effect.stage not in covered and (is_lacking or not effect.hindrance(belief)):
            is_shown = effect.stage in ROOM_STAGES and any(map(record.has, SHOW_ROOM))
            shows = "nothing recorded tells what warms the room" if is_shown else f"no channel shows the {effect.stage}"
            reason = f"{shows}: record {needed(effect.stage, record)}"
            if belief.room is None and effect.stage in ROOM_STAGES:
                reason = "no room is believed: tell it in [building] or [room]"
            yield Untestable(effect.name, reason, Lack.NOT_RECORDED)


def needed(stage: str, record: Record) -> str:
    """Return what to record to judge a stage, of what is not recorded yet."""
    if stage in ROOM_STAGES:
        lacking = lacking_of_room(record)
        alone = " (a lone thermometer may be named so)" if record.has(SHOWN["sensor"]) else ""
        others = in_words([each for each in SHOW_ROOM[1:] if not record.has(each)], "or")
        return in_words(lacking) + (f"{alone}, or else {others}" if SHOW_ROOM[0] in lacking and others else "")
    if not record.has(SHOWN[stage]):
        return f"{SHOWN[stage]} and what drives it"
    before = "setpoint_C" if stage in ("sensor", "controller") else SHOWN[CHAIN[CHAIN.index(stage) - 1]]
    return before if not record.has(before) else "what comes behind it, as control_output"


def lacking_of_room(record: Record) -> list[str]:
    """Return the channels to record to judge a room: a thermometer that the controller reads shows none."""
    lacking = [channel for channel in DRIVES if not record.has(channel)]
    if not (record.sensed_channel and any(map(record.has, SHOW_ROOM))):
        lacking.append(SHOW_ROOM[0])
    return lacking or [SHOWN["valve"]]


def in_words(names: Sequence[str], conjunction: str = "and") -> str:
    """Return names with commas, and a conjunction before the last."""
    return f" {conjunction} ".join(part for part in (", ".join(names[:-1]), *names[-1:]) if part)


def unshown(selection: Selection, effects: Sequence[EffectType]) -> Iterator[Untestable]:
    """Yield the effects that a clear departure would not have moved what is recorded by.

    In a room that stays missed by more than its form, none could be told from what is not understood of it.
    """
    estimator, problem, base = selection.estimator, selection.problem, selection.before
    missed_K = max((each.gap() for each in selection.after.residuals if each.channel in OF_AIR), default=0.0)
    believed = problem.belief_of(base)
    named = {name for found in selection.found for name in found.group}
    least = 2.0 * limit(Question.SLIGHT, "gain_per_form") * max(1.0, float(np.mean(base.whitened**2)))
    # in the likeliest way where a healthy record tells it, else in each that may be
    is_told = problem.as_built is not None and problem.segment.name in problem.as_built.conventions
    ways = problem.conventions[:1] if is_told else estimator.conventions
    tried = [(convention, problem.at((), base.departures, convention)) for convention in ways]
    stills = [(convention, still.whitened) for convention, still in tried if still]

    def moves(effect: EffectType, values: Values) -> bool:
        """Whether it changes the residuals by a loss, however the record is read; also where nobody can say."""
        could_be = False
        for convention, still in stills:
            if other := problem.at([(effect, values)], base.departures, convention):
                could_be = True
                if float(np.sum((other.whitened - still) ** 2)) >= least:
                    return True
        return not could_be

    for effect in effects:
        if effect.name in named or effect.hindrance(believed):
            continue
        departures = [] if selection.is_poor else list(clear(effect, believed))
        if selection.is_poor:
            told = "with what was found" if selection.found else "whatever is added"
            reason = f"the room stays missed by {missed_K:.1f} K {told}"
            yield Untestable(effect.name, reason, Lack.NOT_UNDERSTOOD)
        elif departures and not any(moves(effect, values) for values in departures):
            reason = "this record would look the same with it, unless it were large"
            yield Untestable(effect.name, reason, Lack.NOT_EXCITED)


def clear(effect: EffectType, believed: Belief) -> Iterator[Mapping[str, float]]:
    """Yield departures from neutral that are worth naming, one parameter each and both ways.

    Of what is neutral nowhere, as another kind of motor, points of its whole range.
    """
    neutral = effect.neutral(believed)
    if neutral is None:
        yield from Space(effect).points(FEW)
        return
    values = {**effect.Parameters(**neutral).model_dump(), **neutral}
    for name, prior in effect.priors.items():
        for steps in (-CLEAR, CLEAR) if name in neutral else ():
            value = stepped(prior, neutral[name], steps)
            if value != neutral[name]:
                yield {**values, name: value}
    yield from effect.starts(believed)


def doubts_of_sampling(record: Record, segments: Sequence[Segment]) -> Iterator[str]:
    """Yield what to say of samples that hide what flowed, or so far apart that their noise may be real change."""
    if record.pulses:
        yield (
            f"flow_L_h was counted in pulses of {record.pulse_L:.3g} L: its means between pulses are judged, and what "
            "a valve does between two of them is not seen"
        )
    if record.interval_s < SPARSE_S:
        return
    if any(segment.with_room for segment in segments):
        hidden = "the return temperature counts only where water flowed throughout a sample, and "
        yield (
            f"Samples {record.interval_s / 60.0:g} min apart do not tell how warm the water was while the valve was "
            f"open: {hidden if record.has('return_temperature_C') else ''}what is said of the water on its way to the "
            "room is doubtful"
        )
    for channel in dict.fromkeys(channel for segment in segments for channel in segment.judged):
        noise, usual = record.noise[channel], CHANNELS[channel].noise
        if channel not in record.stated_noise and usual and noise > DOUBTFUL * usual:
            yield (
                f"{channel}: its noise was estimated as {noise:.2g} from samples {record.interval_s:g} s apart; that "
                "may be real change between them, and hide a gap: state it in [noise] of dataset.toml"
            )


def next_measurements(
    segments: Sequence[Segment],
    found: Sequence[FoundEffect],
    untestable: Sequence[Untestable],
    stages: Mapping[str, str],
    record: Record,
) -> Iterator[Measurement]:
    """Yield what to measure next: what shows the room, its drives, what splits groups and stages, was never shown.

    `stages` are those of the effects by name.
    """
    unseen = {stages.get(each.name) for each in untestable if each.lack is Lack.NOT_RECORDED}
    hidden = [stage for stage in ROOM_STAGES if stage in unseen]
    lacking = [channel for channel in lacking_of_room(record) if not record.has(channel)]
    if hidden and lacking:  # a room that nobody told of lacks nothing that could be recorded
        yield Measurement(f"record {in_words(lacking)}", hidden)
    of_room = [segment.name for segment in segments if segment.with_room]
    for channel in record.stand_ins if of_room else ():
        yield Measurement(f"record {channel}", of_room)
    for effect in found:
        if len(effect.group) > 1:
            within = {stages[name] for name in effect.group if name in stages}
            yield Measurement(_splitting(effect, segments, within, record.interval_s), list(effect.group))
    for segment in segments:
        for channel in separating(segment):
            yield Measurement(f"record {channel}", [segment.name])
    excited = [each.name for each in untestable if each.lack is Lack.NOT_EXCITED]
    if excited:
        yield Measurement("record more days, with long pauses, full heating, sun and cold nights", excited)


def separating(segment: Segment) -> list[str]:
    """Return the channels that would cut a merged segment."""
    chain = [stage for stage in segment.stages if stage in CHAIN]
    inner = chain if segment.with_room else chain[:-1]
    found = [SHOWN[stage] for stage in inner if SHOWN[stage] not in (*segment.judged, segment.driven_by)]
    reads_alone = segment.driven_by == SHOWN["sensor"] and "sensor" in inner and SHOWN["sensor"] not in segment.judged
    return [AIR[0], *found] if reads_alone else found  # the air beside a reading shows what the sensor does


def _splitting(effect: FoundEffect, segments: Sequence[Segment], stages: set[str], interval_s: float) -> str:
    """Return what tells the members of a group apart: a channel between their stages, else a closer look."""
    for segment in segments:
        if effect.stage in segment.stages:
            for channel in separating(segment):
                if channel == AIR[0] and "sensor" in stages:
                    return f"record {channel}"
                places = (place for place, stage in enumerate(segment.stages) if SHOWN.get(stage) == channel)
                before = segment.stages[: 1 + next(places, 0)]
                if 0 < len(stages & set(before)) < len(stages):
                    return f"record {channel}"
    if interval_s > 20.0:
        return f"record {effect.channel} every 10 s"
    return f"record {effect.channel} for more days, in other weather"
