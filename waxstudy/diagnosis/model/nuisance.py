"""What nobody knows exactly of a room and of what drives it: fitted with every hypothesis, held by priors."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import exp

import numpy as np

from waxstudy.dataset.stand_ins import FIELDS
from waxstudy.diagnosis.model.room_response import full_flow_L_h
from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import Belief, FloatArray, Inputs, Room, Uncertainty

# chosen: how well gains are known that nobody measured, as logarithms of a factor
ASSUMED_GAINS, ASSUMED_SUN = 0.15, 0.12
MEASURED_GAINS, MEASURED_SUN = 0.05, 0.07
GAINS, SUN, START, FLOOR = "internal gains", "solar gain", "start", "start of the floor"
START_K = 2.0  # nobody knows the weather before the record
LOST_S, MOST_LOST = 600.0, 6  # gaps that matter, and how many of them are fitted, the longest first


@dataclass(frozen=True)
class Nuisance:
    """A departure from what is believed, with a normal prior around 0."""

    name: str
    sd: float
    apply: Callable[[Belief, float], Belief]
    is_event: bool = False  # something that happened once, no property of the room: it shows from then on only


def nuisances(belief: Belief, record: Record, driven_by: str, tolerance: float | None = 1.0) -> list[Nuisance]:
    """Return what the room says of itself, how well its gains are known, how warm it was at first, and lost flows.

    `tolerance` multiplies the spreads of the first two; with None the room is exactly as believed.
    """
    found = []
    room = belief.room
    if room is not None:
        assert issubclass(room.component, Room)
        found = [_of_room(each) for each in room.component.uncertainties(room.parameters)]
    if record.has("internal_gain_W"):
        sd = ASSUMED_GAINS if "internal_gain_W" in record.assumed else MEASURED_GAINS
        found.append(
            Nuisance(GAINS, sd, _scaled(lambda inputs, factor: replace(inputs, gains_W=factor * inputs.gains_W)))
        )
    if record.has("solar_gain_W"):
        sd = ASSUMED_SUN if "solar_gain_W" in record.assumed else MEASURED_SUN
        found.append(
            Nuisance(SUN, sd, _scaled(lambda inputs, factor: replace(inputs, solar_W=factor * inputs.solar_W)))
        )
    return [
        *(replace(nuisance, sd=tolerance * nuisance.sd) for nuisance in found if tolerance is not None),
        *_unrecorded(record),
        Nuisance(START, START_K, _started),
        Nuisance(FLOOR, START_K, _floor_started),
        *_lost(belief, record, driven_by),
    ]


def _unrecorded(record: Record) -> Iterator[Nuisance]:
    """Yield what is unknown of what stands in for drives that nobody recorded."""
    for channel, found in record.stand_ins.items():
        field = FIELDS[channel]
        if found.factor_sd:
            factor = partial(_times, field, found.values)
            yield Nuisance(f"factor of {channel}", found.factor_sd, factor)
        for shape in found.shapes:
            course = partial(_more, field, shape.heat_W)
            yield Nuisance(shape.name, shape.sd, course, is_event=shape.is_once)


def _times(field: str, values: FloatArray, belief: Belief, departure: float) -> Belief:
    return _more(field, values, belief, exp(departure) - 1.0)


def _more(field: str, heat_W: FloatArray, belief: Belief, strength: float) -> Belief:
    """Return the belief with some times a course of heat on top of one of its inputs."""
    assert belief.inputs
    changed = {field: getattr(belief.inputs, field) + strength * heat_W}
    return replace(belief, inputs=replace(belief.inputs, **changed))


def _lost(belief: Belief, record: Record, driven_by: str) -> Iterator[Nuisance]:
    """Yield what flowed in long gaps of what drives a room: a day or two later it is still as warm as that made it."""
    missing = np.concatenate(([False], ~np.isfinite(record.values[driven_by]), [False]))
    first, end = np.flatnonzero(np.diff(missing)).reshape(-1, 2).T
    longest = np.argsort(first - end, kind="stable")[:MOST_LOST]
    least = max(2.0, LOST_S / record.interval_s)
    for place in np.sort(longest[(end - first)[longest] >= least]):
        within = np.zeros(len(record))
        within[first[place] : end[place]] = 1.0
        name = f"flow lost after {first[place] * record.interval_s / 3600.0:.1f} h"
        yield Nuisance(name, full_flow_L_h(record, belief), partial(_flowed, within), is_event=True)


def _flowed(within: FloatArray, belief: Belief, departure: float) -> Belief:
    assert belief.inputs
    before = 0.0 if belief.inputs.added_flow_L_h is None else belief.inputs.added_flow_L_h
    return replace(belief, inputs=replace(belief.inputs, added_flow_L_h=before + departure * within))


def _of_room(uncertainty: Uncertainty) -> Nuisance:
    def apply(belief: Belief, departure: float) -> Belief:
        assert belief.room
        return replace(belief, room=uncertainty.apply(belief.room, departure))

    return Nuisance(uncertainty.name, uncertainty.sd, apply)


def _started(belief: Belief, departure: float) -> Belief:
    assert belief.inputs
    return replace(belief, inputs=replace(belief.inputs, start_K=departure))


def _floor_started(belief: Belief, departure: float) -> Belief:
    assert belief.inputs
    return replace(belief, inputs=replace(belief.inputs, start_floor_K=departure))


def _scaled(edit: Callable[[Inputs, float], Inputs]) -> Callable[[Belief, float], Belief]:
    def apply(belief: Belief, departure: float) -> Belief:
        assert belief.inputs
        return replace(belief, inputs=edit(belief.inputs, exp(departure)))

    return apply
