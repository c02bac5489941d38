"""A fleet made ready: its loops drawn, the rooms that they share built, its calls held against the weather."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from waxstudy.fleet.draw import Blocks, Member, members
from waxstudy.plugin import OutsideRoom
from waxstudy.simulation.engine import DAY_S
from waxstudy.simulation.modes import DrivenRoom
from waxstudy.simulation.run import InputError, prepare
from waxstudy.study.activation import TABLE, Activation
from waxstudy.study.model import Study, is_multiple


@dataclass(frozen=True)
class Fleet:
    """A study's fleet, ready to be called."""

    study: Study
    members: list[Member]
    rooms: dict[str, dict[str, DrivenRoom]]  # by their kind, under each week
    blocks: Blocks
    jit: bool
    stop: np.ndarray = field(default_factory=lambda: np.zeros(1, dtype=np.int64))

    @property
    def activation(self) -> Activation:
        assert self.study.activation
        return self.study.activation

    def driven(self, member: Member, week: str) -> DrivenRoom:
        """Return the room of a loop."""
        return self.rooms[member.room_kind][week]

    @property
    def cases(self) -> list[str]:
        """The cases whose chains the loops have, in one state or another."""
        return list(dict.fromkeys(state.case for state in self.activation.states.values()))


def prepared(study: Study, jit: bool = True) -> Fleet:
    """Draw the loops and build their rooms; raise what `simulation.run.prepare` raises, `InputError` for calls too."""
    if issubclass(study.room.component, OutsideRoom):
        raise InputError("room", "an activation needs a room that waxstudy simulates itself", "use")
    _refuse_parts_of_steps(study)
    drawn, blocks = members(study), Blocks(study)
    rooms: dict[str, dict[str, DrivenRoom]] = {}
    for member in drawn:
        if member.room_kind not in rooms:
            rooms[member.room_kind] = prepare(replace(study, room=blocks.room(study.room, member)), jit).driven
    for week, driven in rooms[drawn[0].room_kind].items():
        _refuse_calls_outside(study, week, driven.weather.duration_s)
    return Fleet(study, drawn, rooms, blocks, jit)


def _refuse_parts_of_steps(study: Study) -> None:
    """A time that is no multiple of the step would be another one than the study says."""
    activation = study.activation
    assert activation
    call = activation.call
    times = [("at_h", 3600.0 * each) for each in call.at_h]
    times += [("lasts_s", call.lasts_s), ("limit_s", call.limit_s), ("rebound_h", 3600.0 * call.rebound_h)]
    times += [(f"state.{name}.preheat_s", state.preheat_s) for name, state in activation.states.items()]
    for key, time_s in times:
        if time_s and not is_multiple(time_s, study.step_s):
            raise InputError(TABLE, f"{time_s:g} s is no multiple of the step of {study.step_s:g} s", key)


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
