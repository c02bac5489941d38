"""A fleet made ready: its loops drawn, the rooms that they share built, its calls held against the weather."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from waxstudy.fleet.draw import Blocks, Member, members
from waxstudy.plugin import Choice, OutsideRoom
from waxstudy.simulation.engine import DAY_S
from waxstudy.simulation.modes import DrivenRoom
from waxstudy.simulation.run import InputError, prepare
from waxstudy.study.activation import TABLE, Activation
from waxstudy.study.model import Study
from waxstudy.sweep.point import STOP


@dataclass(frozen=True)
class Fleet:
    """A study's fleet, ready to be called."""

    study: Study
    members: list[Member]
    rooms: list[dict[str, DrivenRoom]]  # under each week
    room_of: list[int]  # of each loop
    blocks: Blocks
    jit: bool
    stop: np.ndarray

    @property
    def activation(self) -> Activation:
        assert self.study.activation
        return self.study.activation

    @property
    def cases(self) -> list[str]:
        """The cases whose chains the loops have, in one state or another."""
        return list(dict.fromkeys(state.case for state in self.activation.states.values()))


def prepared(study: Study, jit: bool = True) -> Fleet:
    """Draw the loops and build their rooms; raise what `simulation.run.prepare` raises, `InputError` for calls too."""
    if issubclass(study.room.component, OutsideRoom):
        raise InputError("room", "an activation needs a room that waxstudy simulates itself", "use")
    drawn, blocks = members(study), Blocks(study)
    choices: list[Choice] = []
    room_of = []
    for member in drawn:
        choice = blocks.room(study.room, member)
        if choice not in choices:
            choices.append(choice)
        room_of.append(choices.index(choice))
    rooms = [prepare(replace(study, room=choice), jit).driven for choice in choices]
    for week, driven in rooms[0].items():
        _refuse_calls_outside(study, week, driven.weather.duration_s)
    return Fleet(study, drawn, rooms, room_of, blocks, jit, STOP)


def _refuse_calls_outside(study: Study, week: str, duration_s: float) -> None:
    activation = study.activation
    assert activation
    call = activation.call
    longest_s = max(state.longest_s for state in activation.states.values())
    latest_h = (duration_s - call.lasts_s) / 3600.0 - call.rebound_h
    for at_h in call.at_h:
        if not longest_s / 3600.0 < at_h <= latest_h:
            told = (
                f"the call at {at_h:g} h does not fit into week '{week}' of {duration_s / DAY_S:g} days: after "
                f"{longest_s / 3600.0:g} h (pauses and preheating come before), and up to {latest_h:g} h (the rebound "
                "comes behind)"
            )
            raise InputError(TABLE, told, "at_h")
