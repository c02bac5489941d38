"""Some loops of a fleet through every state and call: a row for each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from waxstudy.fleet.course import Course, copied
from waxstudy.fleet.draw import Member
from waxstudy.fleet.figures import COLUMN, Called
from waxstudy.fleet.prepare import Fleet
from waxstudy.plugin import FloatArray, SimulationError, Stopped
from waxstudy.plugin.registry import described
from waxstudy.simulation.engine import State
from waxstudy.study.activation import FleetState
from waxstudy.sweeps.point import ONE

Stretch = tuple[int, int, float | None]  # from a step to another, overridden by a value or not
IDLE_S = 3600.0  # kept off for so long, then watched for so long: what flows then flows though nobody asks


def computed(fleet: Fleet, numbers: Sequence[int], stop: np.ndarray) -> pd.DataFrame:
    """Return the rows of some loops; raise `SimulationError` naming loop and week, or `Stopped`."""
    fleet = replace(fleet, stop=stop)
    return pd.DataFrame([row for number in numbers for row in _loop(fleet, fleet.members[number])])


def _loop(fleet: Fleet, member: Member) -> Iterator[dict[str, Any]]:
    for week in fleet.study.weeks:
        try:
            for case in fleet.cases:
                yield from _Calls(fleet, member, week, case).rows()
        except Stopped:
            raise
        except Exception as error:
            reason = str(error) if isinstance(error, SimulationError) else described(error)
            raise SimulationError(f"loop {member.number}, {week}: {reason}") from error


def course_of(fleet: Fleet, member: Member, week: str, case: str) -> Course:
    """Return a loop with the chain of a case."""
    driven, blocks = fleet.driven(member, week), fleet.blocks.of(fleet.study.cases[case], member)
    return Course(blocks, driven, member.setpoint_C, member.flow_share, member.clock_s, fleet.jit, fleet.stop)


class _Calls:
    """One loop with the chain of one case: every call in every state that has this chain."""

    def __init__(self, fleet: Fleet, member: Member, week: str, case: str) -> None:
        self.fleet, self.member, self.week = fleet, member, week
        self.call = fleet.activation.call
        self.states = [state for state in fleet.activation.states.values() if state.case == case]
        with ONE:
            self.course = course_of(fleet, member, week, case)
        self.full_flow_L_h = self.course.driven.room.full_flow_L_h * member.flow_share

    def rows(self) -> Iterator[dict[str, Any]]:
        """Run the loop undisturbed, and leave that course for each call."""
        state, now = self.course.warm(self.member.start), 0
        idle = self._idle_share(copied(state))
        calls = [(self._begin(each, at_h), at_h, each) for each in self.states for at_h in self.call.at_h]
        for begin, at_h, each in sorted(calls, key=lambda planned: planned[0]):
            self.course.run(state, now, begin, trace=False)
            now = begin
            yield {
                **self._place(each, at_h),
                **self._called(each, at_h, begin, state).figures(),
                "idle_share": idle,
            }

    def _place(self, state: FleetState, at_h: float) -> dict[str, Any]:
        member = self.member
        return {
            "loop": member.number,
            "room": member.room,
            "week": self.week,
            "state": state.name,
            "at_h": at_h,
            "pause_s": member.pause_s(state) if state.pause_s else np.nan,
            **member.values,
        }

    def _steps(self, seconds: float) -> int:
        return round(seconds / self.course.step_s)

    def _begin(self, state: FleetState, at_h: float) -> int:
        """Return the step from which a loop is watched: it is not left to itself from there on, or called next."""
        before_s = state.preheat_s + self.member.pause_s(state)
        return self._steps(at_h * 3600.0) - max(1, self._steps(before_s))

    def _idle_share(self, state: State) -> float:
        """Return the share of the full flow while nobody asks for heat."""
        half = self._steps(IDLE_S)
        trace = self.course.run(state, 0, 2 * half, held=0.0)
        return float(trace[half:, COLUMN["flow_fraction"]].mean())

    def _called(self, state: FleetState, at_h: float, begin: int, at: State) -> Called:
        call = self.call
        called, length = self._steps(at_h * 3600.0), self._steps(call.lasts_s)
        heated, ended = called - self._steps(state.preheat_s), called + length
        last = ended + self._steps(call.rebound_h * 3600.0)
        off, on = (0.0 if state.pause_s else None), 1.0
        signal = on if call.signal == "on" else 0.0
        stretches = [(begin, heated, off), (heated, called, on), (called, ended, signal), (ended, last, None)]
        trace = self._course(at, stretches)
        # without the call: what went on before it goes on; heating ahead of a call to switch on is part of the call
        if call.signal == "on" or heated == called:
            stretches = [(begin, ended, off), (ended, last, None)]
        else:
            stretches = [(begin, heated, off), (heated, ended, on), (ended, last, None)]
        before = called - begin
        return Called(
            trace,
            self._course(at, stretches),
            before,
            before + length,
            self.course.step_s,
            call.signal,
            self.full_flow_L_h,
            self.fleet.study.comfort.operative_limit_C,
        )

    def _course(self, at: State, stretches: Sequence[Stretch]) -> FloatArray:
        state = copied(at)
        return np.concatenate([self.course.run(state, *stretch) for stretch in _joined(stretches)])


def _joined(stretches: Sequence[Stretch]) -> list[Stretch]:
    """Return stretches without those of no length, and as one what goes on: nothing begins anew between them."""
    found: list[Stretch] = []
    for begin, end, held in stretches:
        if found and begin < end and found[-1][2] == held:
            found[-1] = (found[-1][0], end, held)
        elif begin < end:
            found.append((begin, end, held))
    return found
