"""Which effects a record could not show, why, and what to measure next."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from waxstudy.dataset.channels import CHANNELS
from waxstudy.gap.candidate import LEAST_GAIN
from waxstudy.gap.links import ROOM_STAGES, SHOWN, Link
from waxstudy.gap.reading import Reading
from waxstudy.gap.record import AIR, Record
from waxstudy.gap.result import FoundEffect, Measurement, Untestable
from waxstudy.gap.select import Selection
from waxstudy.gap.space import EffectType, Space, Values
from waxstudy.gap.trust import OF_AIR, is_poor
from waxstudy.plugin import CHAIN, Belief, FloatArray, SimulationError

UNSHOWN = "no channel shows"  # how the reason begins where nothing was recorded
FEW = 0.1  # of a first look's points
CLEAR = 4  # noticeable steps from neutral that a record should show
LEAST_BLOCKS = 3
LEAST_SHARE = 0.3  # of the samples
LEVELS = ("control_output", "displacement")
FAR_APART_S, DOUBTFUL = 900.0, 3.0  # interval, and times a usual instrument's noise
STEADY = 0.1  # range of a level that stays where it is
NEEDS = {"emitter": "supply and outdoor temperatures and the flow", "room": "supply and outdoor temperatures"}


def too_short(link: Link, record: Record, belief: Belief) -> str:
    """Return why a link cannot be judged at all, or an empty text."""
    channel = _best_known(link, record)
    blocks = np.unique((record.day if link.with_room else record.cycle)[record.settled & _known(record, channel)])
    if len(blocks) < LEAST_BLOCKS:
        one = "day" if link.with_room else "cycle"
        found = f"1 {one} of {channel} is" if len(blocks) == 1 else f"{len(blocks)} {one}s of {channel} are"
        return f"only {found} recorded, {LEAST_BLOCKS} are needed"
    # what stands although it should move shows a dead motor, a signal that is always on one that stands elsewhere
    if _is_constant(record, channel):
        if not _should_move(link, record, belief, channel):
            return f"{channel} never changes in this record"
    elif _is_constant(record, link.driven_by) and not _stands(record, channel):
        return f"{link.driven_by} never changes in this record"
    share = float(_known(record, channel).mean())
    if share < LEAST_SHARE:
        return f"{100 * (1 - share):.0f} % of {channel} is missing"
    judged = float((_known(record, channel) & ~record.is_gap(link.driven_by)).mean())
    return f"{100 * (1 - judged):.0f} % is lost in gaps of {link.driven_by}" if judged < LEAST_SHARE else ""


def _is_constant(record: Record, channel: str) -> bool:
    values = record.values[channel]
    return bool(np.nanmax(values) - np.nanmin(values) <= 1e-9)


def _should_move(link: Link, record: Record, belief: Belief, channel: str) -> bool:
    """Whether a constant channel is elsewhere than the belief has it, at some time.

    A controller that asks for nothing may have been told to: that shows nothing of it.
    """
    if link.with_room or {"sensor", "controller"} & set(link.stages):
        return False
    try:
        predicted = link.predict(record, belief, link.readings[0])[channel]
    except (SimulationError, ValueError):
        return False
    off = np.abs(predicted - record.filled(channel))
    return float(off.max()) > STEADY * max(float(np.abs(predicted).max()), 1e-9)


def _best_known(link: Link, record: Record) -> str:
    """Return what shows the whole of a link: the last channel, of a room's the one that misses least."""
    return max(link.judged, key=lambda each: _known(record, each).mean()) if link.with_room else link.judged[-1]


def _stands(record: Record, channel: str) -> bool:
    """Whether a level stays where it is, but for noise."""
    low, high = np.nanquantile(record.values[channel], (0.01, 0.99))
    return channel in LEVELS and bool(high - low < STEADY)


def _known(record: Record, channel: str) -> np.ndarray:
    return np.isfinite(record.values[channel])


def uncovered(effects: Sequence[EffectType], links: Sequence[Link], belief: Belief) -> Iterator[Untestable]:
    """Yield the effects whose stage no link covers, with what is missing."""
    covered = {stage for link in links for stage in link.stages}
    for effect in effects:
        # without a record of what drives a room no effect of its own can be thought of
        is_lacking = belief.room is not None and belief.inputs is None and effect.stage in ROOM_STAGES
        if effect.stage not in covered and (is_lacking or not effect.hindrance(belief)):
            yield Untestable(effect.name, f"{UNSHOWN} the {effect.stage}: record {needed(effect.stage)}")


def needed(stage: str) -> str:
    """Return what to record to judge a stage."""
    return NEEDS.get(stage) or f"{SHOWN[stage]} and what drives it"


def unshown(selection: Selection, effects: Sequence[EffectType]) -> Iterator[Untestable]:
    """Yield the effects that a clear departure would not have moved what is recorded by.

    In a room that stays missed by more than its form, none could be told from what is not understood of it.
    """
    fitter, base = selection.fitter, selection.before
    missed_K = max((errors.gap() for errors in selection.after.errors if errors.channel in OF_AIR), default=0.0)
    is_lost = is_poor(fitter, base, selection.after)
    lost = f"the room stays missed by {missed_K:.1f} K whatever is added" if is_lost else ""
    now = base.whitened
    believed = fitter.edited(base.effects, base.departures)
    named = {name for found in selection.found for name in found.group}
    least = 2.0 * LEAST_GAIN * max(1.0, float(np.mean(now**2)))
    tried = [(reading, fitter.at((), base.departures, reading)) for reading in fitter.readings]
    stills = [(reading, still.whitened) for reading, still in tried if still]
    for effect in effects:
        if effect.name in named or effect.hindrance(believed):
            continue
        if lost:
            yield Untestable(effect.name, lost)
            continue
        departures = list(clear(effect, believed))
        if departures and not any(_moves_by(selection, effect, values, stills, least) for values in departures):
            yield Untestable(effect.name, "nothing in this record would look different with it, unless it were large")


def _moves_by(
    selection: Selection,
    effect: EffectType,
    values: Values,
    stills: Sequence[tuple[Reading, FloatArray]],  # the errors without it, for each way to read the record
    least: float,
) -> bool:
    """Whether an effect changes the errors by a loss, however the record is read; also where that cannot be told."""
    fitter, departures = selection.fitter, selection.before.departures
    told = False
    for reading, still in stills:
        if other := fitter.at([(effect, values)], departures, reading):
            told = True
            if float(np.sum((other.whitened - still) ** 2)) >= least:
                return True
    return not told


def clear(effect: EffectType, believed: Belief) -> Iterator[Mapping[str, float]]:
    """Yield departures from neutral that are worth naming, one parameter each and both ways.

    Of what is neutral nowhere, as another kind of motor, points of its whole range.
    """
    neutral = effect.neutral(believed)
    if neutral is None:
        yield from Space(effect).points(FEW)
        return
    values = {**effect.Parameters(**neutral).model_dump(), **neutral}
    for name in [each for each in effect.priors if each in neutral]:
        prior = effect.priors[name]
        for way in (-1, 1):
            steps = way * CLEAR
            value = (
                neutral[name] * prior.noticeable**steps if prior.is_log else neutral[name] + steps * prior.noticeable
            )
            clipped = min(prior.high, max(prior.low, value))
            if clipped != neutral[name]:
                yield {**values, name: clipped}
    yield from effect.starts(believed)


def doubtful_noise(record: Record, links: Sequence[Link]) -> Iterator[str]:
    """Yield what to say of judged channels whose noise is told from samples so far apart that it may be none."""
    if record.interval_s < FAR_APART_S:
        return
    for channel in dict.fromkeys(channel for link in links for channel in link.judged):
        noise, usual = record.noise[channel], CHANNELS[channel].noise
        if channel not in record.stated_noise and usual and noise > DOUBTFUL * usual:
            yield (
                f"{channel}: its noise was estimated as {noise:.2g} from samples {record.interval_s:g} s apart; that "
                "may be real change between them, and hide a gap: state it in [noise] of dataset.toml"
            )


def next_measurements(
    links: Sequence[Link],
    found: Sequence[FoundEffect],
    untestable: Sequence[Untestable],
    stages: Mapping[str, str],
    interval_s: float,
) -> Iterator[Measurement]:
    """Yield what to measure next: what splits groups, what separates merged stages, what was never shown.

    `stages` are those of the effects by name.
    """
    for effect in found:
        if len(effect.group) > 1:
            within = {stages[name] for name in effect.group if name in stages}
            yield Measurement(_splitting(effect, links, within, interval_s), list(effect.group))
    for link in links:
        for channel in separating(link):
            yield Measurement(f"record {channel}", [f"{link.name}"])
    excited = [each.name for each in untestable if each.reason.startswith("nothing")]
    if excited:
        yield Measurement("record more days, with long pauses, full heating, sun and cold nights", excited)


def separating(link: Link) -> list[str]:
    """Return the channels that would cut a merged link."""
    chain = [stage for stage in link.stages if stage in CHAIN]
    inner = chain if link.with_room else chain[:-1]
    found = [SHOWN[stage] for stage in inner if SHOWN[stage] not in (*link.judged, link.driven_by)]
    reads_alone = link.driven_by == SHOWN["sensor"] and "sensor" in inner and SHOWN["sensor"] not in link.judged
    return [AIR[0], *found] if reads_alone else found  # the air beside a reading shows what the sensor does


def _splitting(effect: FoundEffect, links: Sequence[Link], stages: set[str], interval_s: float) -> str:
    """Return what tells the members of a group apart: a channel between their stages, else a closer look."""
    for link in links:
        if effect.stage in link.stages:
            for channel in separating(link):
                if channel == AIR[0] and "sensor" in stages:
                    return f"record {channel}"
                before = link.stages[: 1 + next((i for i, s in enumerate(link.stages) if SHOWN.get(s) == channel), 0)]
                if 0 < len(stages & set(before)) < len(stages):
                    return f"record {channel}"
    if interval_s > 20.0:
        return f"record {effect.channel} every 10 s"
    return f"record {effect.channel} for more days, in other weather"
