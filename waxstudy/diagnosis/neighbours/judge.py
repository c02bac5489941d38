"""Rooms that were measured beside each other, judged: how each follows the others, and what departs in which room."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import exp, log

import numpy as np
import pandas as pd

from waxstudy.dataset.neighbours import MeasuredRoom, Neighbours
from waxstudy.diagnosis.neighbours.control import Control
from waxstudy.diagnosis.neighbours.events import Happening, answer_K_W, happenings, shares_hours
from waxstudy.diagnosis.neighbours.limits import LIKELY, OF_HOUSE, STANDARD_H, STEP_S, TOGETHER
from waxstudy.diagnosis.neighbours.reading import reading, when
from waxstudy.diagnosis.neighbours.search import Tick, gained, searched
from waxstudy.diagnosis.neighbours.series import House, RoomSeries, coarse
from waxstudy.diagnosis.neighbours.spans import days_paid, tried, unrest_of
from waxstudy.diagnosis.result import Interval, NeighbourEvent, NeighbourRoom, RoomCourse, RoomsBeside

SURE_LOG = 50.0  # beyond, a probability is 1
BY_OWN = "by the room's answer to its own recorded heat"
BY_CAPACITY = "by the heat capacity that was assumed"


def judged(neighbours: Neighbours, tick: Tick) -> RoomsBeside:
    """Return what departs in which room. Days of a baseline tell what is usual; what ended in them is left out."""
    house = house_of(neighbours)
    controls = searched(house, tick)
    first = 0 if neighbours.since is None else int((house.begins < neighbours.since).sum())
    all_ = [each for control in controls.values() for each in happenings(control)]
    found = [each for each in all_ if each.spans[-1][1] > first and _probability(each) >= LIKELY]
    events = [_event(each, found, house) for each in found]
    rooms = [_room(control) for control in controls.values()]
    courses = {name: _course(control) for name, control in controls.items() if any(e.room == name for e in events)}
    return RoomsBeside(rooms, events, sentence(events, rooms), courses, house.begin.isoformat())


def house_of(neighbours: Neighbours) -> House:
    """Return rooms on steps of half an hour, or of their own interval if that is longer."""
    interval_s, outdoor_C = neighbours.interval_s, neighbours.outdoor_C
    per_step = max(1, round(STEP_S / interval_s))

    def series(room: MeasuredRoom) -> RoomSeries:
        gain_W = None if room.gain_W is None else coarse(room.gain_W, per_step)
        return RoomSeries(room.name, coarse(room.air_C, per_step), gain_W, room.capacity_Wh_K, room.air_C)

    return House(
        rooms=[series(room) for room in neighbours.rooms],
        outdoor_C=None if outdoor_C is None else coarse(outdoor_C, per_step),
        sun={name: coarse(values, per_step) for name, values in neighbours.sun.items()},
        begin=neighbours.time[0] - pd.Timedelta(interval_s, "s"),
        step_s=per_step * interval_s,
        per_step=per_step,
    )


def _room(control: Control) -> NeighbourRoom:
    hours = control.house.begins
    standard = np.zeros(len(hours), dtype=bool)
    standard[: round(STANDARD_H / control.house.step_h)] = True
    answer = answer_K_W(control, standard)
    told = None if answer is None else Interval(*(1000.0 * each for each in (answer.value, answer.low, answer.high)))
    left = control.fit.left_K
    return NeighbourRoom(control.room.name, float(np.sqrt(np.nanmean((left - np.nanmean(left)) ** 2))), told)


def _event(happening: Happening, all_: Sequence[Happening], house: House) -> NeighbourEvent:
    own, assumed = happening.own_heat, happening.assumed_heat
    alike = [
        each.control.room.name
        for each in all_
        if each.control is not happening.control
        and each.size_K.value * happening.size_K.value > 0.0
        and shares_hours(each.spans, happening.spans, len(house)) >= TOGETHER
    ]
    return NeighbourEvent(
        room=happening.control.room.name,
        when=when(house, happening.spans),
        spans_h=[(begin * house.step_h, end * house.step_h) for begin, end in happening.spans],
        size_K=happening.size_K,
        heat_W=own or assumed,
        heat_from=BY_OWN if own else BY_CAPACITY if assumed else "",
        reading=reading(happening) + _beside(alike, house),
        together_with=alike,
        probability=_probability(happening),
    )


def _beside(alike: Sequence[str], house: House) -> str:
    if len(alike) + 1 > OF_HOUSE * len(house.rooms):
        return "; so in most rooms at once: this is the house, not one room"
    if alike:
        return f"; at the same time in {', '.join(alike)}"
    return "; or the other room departs the other way: two rooms cannot tell" if len(house.rooms) == 2 else ""


def _probability(happening: Happening) -> float:
    """Return how likely the room departs, even odds before and what was tried paid for: spans, sizes and days."""
    control = happening.control
    house, pattern = control.house, control.patterns[happening.main]
    gain = gained(control.without(happening.main), pattern, unrest_of(house, control.fit, pattern))
    chosen = len(pattern.spans)
    odds = 0.5 * (gain - (days_paid(int(house.days[-1]) + 1, chosen) if chosen > 1 else 0.0)) - log(tried(house))
    return 1.0 / (1.0 + exp(-min(SURE_LOG, max(-SURE_LOG, odds))))


def sentence(events: Sequence[NeighbourEvent], rooms: Sequence[NeighbourRoom]) -> str:
    """Return what was found, in one sentence."""
    if not events:
        return f"None of {len(rooms)} rooms departs from its neighbours by what stands out of their own unrest."
    return "; ".join(_counted(events)) + "."


def _counted(events: Sequence[NeighbourEvent]) -> Iterator[str]:
    of_room: Mapping[str, list[NeighbourEvent]] = {each.room: [] for each in events}
    for each in events:
        of_room[each.room].append(each)
    for name, own in of_room.items():
        yield f"{name} departs from its neighbours " + ("once" if len(own) == 1 else f"{len(own)} times")


def _course(control: Control) -> RoomCourse:
    times = (np.arange(len(control.house)) + 0.5) * control.house.step_h
    return RoomCourse(times.tolist(), control.room.air_C.tolist(), control.expected_C.tolist())
