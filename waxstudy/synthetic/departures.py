"""A reality that strays from what is believed of its room and its heat, as every real one does; it is no effect."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import exp

from waxstudy.plugin import Belief, Choice, Inputs, Room

# channels of heat that stray by a factor, as fields of `Inputs`
HEATS = {"internal_gain_W": "gains_W", "solar_gain_W": "solar_W"}
# name of the room's uncertainty -> what its `apply` takes; channel of heat -> logarithm of a factor
Departures = Mapping[str, float]


def departed(belief: Belief, departures: Departures) -> Belief:
    """Return a belief whose room and heat stray from it; raise `ValueError` for a name that nothing of it has."""
    if not departures:
        return belief
    room = belief.room and departed_room(belief.room, departures)
    return replace(belief, room=room, inputs=belief.inputs and departed_inputs(belief.inputs, departures))


def departed_room(room: Choice, departures: Departures) -> Choice:
    assert issubclass(room.component, Room)
    ways = {each.name: each.apply for each in room.component.uncertainties(room.parameters)}
    if unknown := departures.keys() - ways.keys() - HEATS.keys():
        raise ValueError(f"nothing of this room is called {', '.join(sorted(unknown))}")
    for name, apply in ways.items():
        room = apply(room, departures.get(name, 0.0))
    return room


def departed_inputs(inputs: Inputs, departures: Departures) -> Inputs:
    strays = {field: exp(departures[channel]) for channel, field in HEATS.items() if channel in departures}
    return replace(inputs, **{field: factor * getattr(inputs, field) for field, factor in strays.items()})
