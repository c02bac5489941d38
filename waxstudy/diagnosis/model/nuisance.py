"""What nobody knows exactly of a room and of what drives it: fitted with every hypothesis, held by priors."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import exp
from typing import Any

import numpy as np

from waxstudy.dataset.stand_ins import ASSUMED, FIELDS, GAINS, SUN
from waxstudy.diagnosis.model.room_response import full_flow_L_h
from waxstudy.diagnosis.observations.record import Record
from waxstudy.plugin import Belief, FloatArray, Room, Uncertainty

START, FLOOR = "start", "start of the floor"
# chosen: how well they are known where somebody measured them, and where not, as logarithms of a factor
HEATS = (("internal gains", GAINS, 0.05, ASSUMED[GAINS]), ("solar gain", SUN, 0.07, ASSUMED[SUN]))
START_K = 2.0  # nobody knows the weather before the record
LOST_S, MOST_LOST = 600.0, 6  # gaps that matter, and how many of them are fitted, the longest first


@dataclass(frozen=True)
class Nuisance:
    """A departure from what is believed, with a normal prior around 0."""

    name: str
    sd: float
    apply: Callable[[Belief, float], Belief]
    is_event: bool = False  # something that happened once, no property of the room: it shows from then on only
    varies: float = 0.0  # standard deviation of it from one record to another
    is_habit: bool = False  # of a drive that nobody recorded, by this record's own days

    @property
    def tells(self) -> frozenset[str]:
        """The names of all that it tells of."""
        return frozenset((self.name,))

    def known_within(self, sd: float) -> Nuisance:
        """Return the same, known by a record within a standard deviation."""
        return replace(self, sd=sd)

    def step(self, departure: float) -> float:
        """Return the step of what is applied after a departure from what was known."""
        return departure

    @property
    def is_added_heat(self) -> bool:
        """Whether it does no more than add heat to a room, in proportion to its departure."""
        return isinstance(self.apply, _OfInput) and self.apply.is_added_heat

    @property
    def is_of_inputs(self) -> bool:
        """Whether it changes a course of what drives the room, and nothing of the room itself."""
        return isinstance(self.apply, _OfInput)


def nuisances(belief: Belief, record: Record, driven_by: str, tolerance: float | None = 1.0) -> list[Nuisance]:
    """Return what the room says of itself, how well its gains are known, how warm it was at first, and lost flows.

    `tolerance` multiplies the spreads of the first two; with None the room is exactly as believed.
    """
    found = []
    if room := belief.room:
        assert issubclass(room.component, Room)
        found = [_of_room(each) for each in room.component.uncertainties(room.parameters)]
    found += heats(record)
    return [
        *(replace(nuisance, sd=tolerance * nuisance.sd) for nuisance in found if tolerance is not None),
        *habits(record),
        *of_record(belief, record, driven_by),
    ]


def heats(record: Record) -> Iterator[Nuisance]:
    """Yield how well drives are known that were recorded or assumed."""
    for name, channel, measured, assumed in HEATS:
        if record.has(channel):
            sd = record.spreads.get(channel, assumed if channel in record.assumed else measured)
            yield Nuisance(name, sd, _OfInput(FIELDS[channel], lambda old, factor: exp(factor) * old))


def habits(record: Record) -> Iterator[Nuisance]:
    """Yield what is unknown of drives that nobody recorded, and much the same in the next record of a room."""
    for channel, found in record.stand_ins.items():
        of = FIELDS[channel]
        if found.factor_sd:
            apply = _OfInput(of, partial(_times, found.values))
            told = f"factor on {found.source}", found.factor_sd
            yield Nuisance(*told, apply, varies=found.factor_varies, is_habit=True)
        for shape in found.shapes:
            if shape.varies is not None:
                apply = _OfInput(of, partial(_more, shape.heat_W), is_added_heat=True)
                yield Nuisance(shape.name, shape.sd, apply, varies=shape.varies, is_habit=True)


def of_record(belief: Belief, record: Record, driven_by: str) -> list[Nuisance]:
    """Return what nobody knows of a record itself: unrecorded drives, how warm it was at first, lost flows."""
    return [
        *_unrecorded(record),
        Nuisance(START, START_K, _OfInput("start_K", lambda old, departure: departure)),
        Nuisance(FLOOR, START_K, _OfInput("start_floor_K", lambda old, departure: departure)),
        *_lost(belief, record, driven_by),
    ]


def _unrecorded(record: Record) -> Iterator[Nuisance]:
    """Yield what is unknown of drives that nobody recorded, and tells nothing of another record."""
    for channel, found in record.stand_ins.items():
        for shape in found.shapes:
            if shape.varies is None:
                apply = _OfInput(shape.field or FIELDS[channel], partial(_more, shape.heat_W), is_added_heat=True)
                yield Nuisance(shape.name, shape.sd, apply, shape.is_once)


def _times(heat_W: FloatArray, old: FloatArray, departure: float) -> FloatArray:
    return _more(heat_W, old, exp(departure) - 1.0)


def _more(course: FloatArray, old: FloatArray | None, strength: float) -> FloatArray:
    """Return an input with some times a course on top of it."""
    return (0.0 if old is None else old) + strength * course


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
        flowed = _OfInput("added_flow_L_h", partial(_more, within))
        yield Nuisance(name, full_flow_L_h(record, belief), flowed, is_event=True)


def _of_room(uncertainty: Uncertainty) -> Nuisance:
    def apply(belief: Belief, departure: float) -> Belief:
        assert belief.room
        return replace(belief, room=uncertainty.apply(belief.room, departure))

    return Nuisance(uncertainty.name, uncertainty.sd, apply)


@dataclass(frozen=True)
class _OfInput:
    """Puts another value in the place of a field of the inputs, by a departure."""

    of: str
    changed: Callable[[Any, float], Any]
    is_added_heat: bool = False

    def __call__(self, belief: Belief, departure: float) -> Belief:
        return _with_inputs(belief, [(self, departure)])


def departed_inputs(belief: Belief, departures: Iterable[tuple[Nuisance, float]]) -> Belief:
    """Return a belief after all departures of its inputs, which are copied once; those of the room are left out."""
    return _with_inputs(belief, ((each.apply, value) for each, value in departures if isinstance(each.apply, _OfInput)))


def _with_inputs(belief: Belief, changes: Iterable[tuple[_OfInput, float]]) -> Belief:
    inputs, new = belief.inputs, dict[str, Any]()
    for change, departure in changes:
        assert inputs
        new[change.of] = change.changed(new[change.of] if change.of in new else getattr(inputs, change.of), departure)
    return replace(belief, inputs=replace(inputs, **new)) if inputs and new else belief
