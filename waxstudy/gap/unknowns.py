"""What nobody knows exactly of a room and of what drives it: fitted with every hypothesis, held by priors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import exp

from waxstudy.gap.record import Record
from waxstudy.plugin import Belief, Inputs, Room, Uncertainty

# chosen: how well gains are known that nobody measured, as logarithms of a factor
ASSUMED_GAINS, ASSUMED_SUN = 0.15, 0.12
MEASURED_GAINS, MEASURED_SUN = 0.05, 0.07
GAINS, SUN, START, FLOOR = "internal gains", "solar gain", "start", "start of the floor"
START_K = 2.0  # nobody knows the weather before the record


@dataclass(frozen=True)
class Unknown:
    """A departure from what is believed, with a normal prior around 0."""

    name: str
    sd: float
    apply: Callable[[Belief, float], Belief]


def unknowns(belief: Belief, record: Record, tolerance: float = 1.0) -> list[Unknown]:
    """Return what the room says of itself, and how well its gains are known."""
    found = []
    room = belief.room
    if room is not None:
        assert issubclass(room.component, Room)
        found = [_of_room(each) for each in room.component.uncertainties(room.parameters)]
    if record.has("internal_gain_W"):
        sd = ASSUMED_GAINS if "internal_gain_W" in record.assumed else MEASURED_GAINS
        found.append(
            Unknown(GAINS, sd, _scaled(lambda inputs, factor: replace(inputs, gains_W=factor * inputs.gains_W)))
        )
    if record.has("solar_gain_W"):
        sd = ASSUMED_SUN if "solar_gain_W" in record.assumed else MEASURED_SUN
        found.append(Unknown(SUN, sd, _scaled(lambda inputs, factor: replace(inputs, solar_W=factor * inputs.solar_W))))
    found += [Unknown(START, START_K, _started), Unknown(FLOOR, START_K, _floor_started)]
    return [replace(unknown, sd=tolerance * unknown.sd) for unknown in found]


def _of_room(uncertainty: Uncertainty) -> Unknown:
    def apply(belief: Belief, departure: float) -> Belief:
        assert belief.room
        return replace(belief, room=uncertainty.apply(belief.room, departure))

    return Unknown(uncertainty.name, uncertainty.sd, apply)


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
