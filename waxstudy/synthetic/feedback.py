"""A loop under inputs that depend on its own air and flow: hour by hour, each until it agrees with itself."""

from __future__ import annotations

import copy
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from waxstudy.plugin import TRACE, FloatArray, Inputs, LinearRoom, Role
from waxstudy.plugin.registry import told
from waxstudy.simulation.engine import DAY_S, WARM_UP_DAYS, Loop, Start, State, Week
from waxstudy.simulation.modes import DrivenRoom
from waxstudy.simulation.recorded import EXTRA, RECORDED, SUN, recorded_room
from waxstudy.synthetic.simulate import RealityError

PART_S = 3600.0  # short enough that the air's answer to an effect hardly changes the effect again
AIR_K = 0.003  # how little the air of an hour may still change
MOST_RUNS = 20
HEAT = (SUN.name, EXTRA.name)
TAKEN = {**RECORDED, Role.SUN: SUN.name}  # fields of `Inputs`, by the role of what takes them
FOLLOWED = (*TAKEN.values(), EXTRA.name, "supply_C")  # fields that effects may change
FASTEST = 1e-300  # decay over a step, instead of none at all where modes of nothing fill a lane
Change = Callable[[Inputs], Inputs]


def march(loop: Loop, believed: Inputs, change: Change, setpoint_C: float, start: Start) -> tuple[Loop, Week]:
    """Return a loop under what `change` makes of its inputs, and what it does after the usual warm-up.

    The loop's weather has the intervals of `believed`. Where inputs depend on the room's own air and flow, every hour
    is run again with what they were in it, until the air stays within 3 mK: two to five times as a rule, ten to fifteen
    while a wide window is open. What is changed comes on top of what drives the room: more sun falls where the sun of
    all facades together does, extra heat goes to the air. Raises `RealityError` where an hour does not settle or
    a change would be lost, and `PluginError`.
    """
    with told("[room] with effects"):
        course = Course.of(loop, believed)
    count = len(course.places)
    part = round(PART_S / believed.interval_s) if course.depends(change) else count
    state, traces = course.loop.start(setpoint_C, start), []
    with told("[room] with effects", RealityError):
        for first in range(0, count, part):
            state, trace = course.settled(state, slice(first, min(first + part, count)), change, setpoint_C)
            traces.append(trace)
    warm_up = round(WARM_UP_DAYS * DAY_S / loop.driven.step_s)
    return course.record(), Week(hours_below=0.0, trace=np.concatenate(traces)[warm_up:])


def added(believed: Inputs, true: Inputs, room: LinearRoom) -> dict[str, FloatArray]:
    """Return what is added to each input that is believed; raise `RealityError` for a change that would be lost.

    Extra heat comes from effects alone, so that all of it is added.
    """
    for name, before in vars(believed).items():
        if name not in FOLLOWED and not np.array_equal(before, getattr(true, name)):
            followed = ", ".join(FOLLOWED)
            raise RealityError(f"an effect changes {name}, which follows from the run itself (allowed: {followed})")
    extra_W = np.zeros(len(believed.outdoor_C)) if true.extra_W is None else true.extra_W
    found = {"supply_C": true.supply_C - believed.supply_C, EXTRA.name: extra_W}
    for role, name in TAKEN.items():
        before, after = getattr(believed, name), getattr(true, name)
        if after is not None:
            found[name] = after - before if before is not None else after
            if before is None or (found[name].any() and not room.takes(role)):
                mend = f"leave it out, or give a room that has one with the role {role}"
                raise RealityError(f"an effect changes {name}, which no input of the room takes ({mend})")
        elif before is not None:
            raise RealityError(f"an effect leaves out {name}, which the room takes (it must say what is there instead)")
    return found


@dataclass(frozen=True)
class Course:
    """The intervals of warm-up and record, one after the other, with what is believed and known of them so far."""

    loop: Loop  # the rows of its driven room are written as the march goes on
    own: DrivenRoom
    places: np.ndarray  # (n,) where in the record each interval is
    seen: Inputs
    answer: Answer

    @classmethod
    def of(cls, loop: Loop, believed: Inputs) -> Course:
        own = loop.driven
        day = np.arange(round(DAY_S / believed.interval_s))
        places = np.concatenate((np.tile(day, WARM_UP_DAYS), np.arange(len(own.supply_C))))
        arrays: dict[str, Any] = {n: values[places] for n, values in vars(believed).items() if np.ndim(values)}
        return cls(_with_rows(loop, places), own, places, replace(believed, **arrays), Answer.of(own, believed))

    def depends(self, change: Change) -> bool:
        """Whether changed inputs depend on the room's own air or flow."""
        seen = self.seen
        other = replace(seen, air_C=seen.air_C + 1.0, flow_L_h=np.full(len(seen.air_C), 10.0))
        one, another = (added(each, change(each), self.own.room) for each in (seen, other))
        return any(not np.array_equal(one[name], another[name]) for name in one)

    def record(self) -> Loop:
        """Return the loop with the rows of the record, as they were written."""
        return _with_rows(self.loop, np.arange(len(self.places) - len(self.own.supply_C), len(self.places)))

    def settled(self, state: State, rows: slice, change: Change, setpoint_C: float) -> tuple[State, FloatArray]:
        """Return state and trace at the end of some intervals."""
        air_C, flow_L_h, before = self.seen.air_C, self.seen.flow_L_h, max(rows.start - 1, 0)
        assert flow_L_h is not None
        air_C[rows], flow_L_h[rows] = air_C[before], flow_L_h[before]
        intervals = np.arange(rows.start, rows.stop)
        start_s = rows.start * self.seen.interval_s - WARM_UP_DAYS * DAY_S
        for _ in range(MOST_RUNS):
            self._write(added(self.seen, change(self.seen), self.own.room), rows)
            ended = copy.deepcopy(state)
            _, trace = self.loop.advance(ended, intervals, start_s, setpoint_C, trace=True)
            steps = trace.reshape(len(intervals), -1, len(TRACE))
            is_settled = np.max(np.abs(steps[:, -1, 0] - air_C[rows])) < AIR_K
            air_C[rows] = steps[:, -1, TRACE.index("air_C")]
            flow_L_h[rows] = self.own.room.full_flow_L_h * steps[:, :, TRACE.index("flow_fraction")].mean(axis=1)
            if is_settled or len(intervals) == len(self.places):
                return ended, trace
        raise RealityError("the room's air does not settle under effects that depend on it; take them weaker")

    def _write(self, change: Mapping[str, FloatArray], rows: slice) -> None:
        driven, places = self.loop.driven, self.places[rows]
        values = np.column_stack([change[name][rows] for name in self.answer.names])
        driven.forcing[rows] = self.own.forcing[places] + values @ self.answer.to_modes
        driven.offsets[rows] = self.own.offsets[places] + values @ self.answer.to_outputs
        driven.supply_C[rows] = self.own.supply_C[places] + change["supply_C"][rows]


def _with_rows(loop: Loop, places: np.ndarray) -> Loop:
    """Return a loop whose room is driven by some of its intervals, in this order."""
    rows = {name: getattr(loop.driven, name)[places] for name in ("forcing", "offsets", "supply_C")}
    made = copy.copy(loop)
    made.driven = replace(loop.driven, **rows)
    return made


@dataclass(frozen=True)
class Answer:
    """What a unit of each input does to the modes in a step, and at once to the outputs."""

    names: tuple[str, ...]  # fields of `Inputs`
    to_modes: FloatArray  # (names, modes)
    to_outputs: FloatArray  # (names, outputs)

    @classmethod
    def of(cls, driven: DrivenRoom, inputs: Inputs) -> Answer:
        """Return it as `modes.drive` has it: what its few modes leave out answers at once."""
        room = recorded_room(driven.room, inputs)
        first = {each.role: place for place, each in enumerate(room.inputs)}
        roles = [role for role, name in RECORDED.items() if role in first and getattr(inputs, name) is not None]
        names, places = [RECORDED[role] for role in roles], [*(first[role] for role in roles), -2, -1]
        heat, direct = room.input_matrix[:, places], room.feedthrough[:, places]
        rates = -np.log(np.maximum(driven.decay, FASTEST)) / driven.step_s
        slow = (driven.to_modes / room.capacity_J_K) @ heat
        whole = room.output_matrix @ np.linalg.solve(room.conductance_W_K, heat)
        static = whole - (driven.outputs / rates) @ slow
        gain = -np.expm1(-rates * driven.step_s) / rates
        return cls((*names, *HEAT), (slow * gain[:, None]).T, (direct + static).T)
