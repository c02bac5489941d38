"""What a departure may be, as far as its course tells, and when it was, in words."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pandas as pd

from waxstudy.diagnosis.neighbours.events import Happening
from waxstudy.diagnosis.neighbours.limits import (
    AT_ONCE_H,
    BRIGHT,
    FAST_K,
    MOST_DAYS,
    MOST_HOURS,
    MOST_WEEKDAYS,
    QUICK,
    REGULAR,
    STEP,
)
from waxstudy.diagnosis.neighbours.series import House
from waxstudy.diagnosis.select.patterns import WEEK

LOST = "heat is lost to a colder place at once, as through an open window or door"
GAINED = "the air gets heat at once, as of a heater, people or cooking that was not recorded"
COOLS = "it cools slowly: heating is off, set back or weaker, or a little heat is lost all the time"
WARMS = "it warms slowly: heating is on for longer or set higher, or heat goes into floor and walls"
SENSOR = "the thermometer steps from one sample to the next and back: its reading, not the room"
SHADE = "; by day it may be sun kept out, too"
SUN = "; by day it may be sun let in, too"
OWN = "; its own recorded heat runs at that time, and may do more than it usually does"
RETURNS = ", and it comes back as fast when that ends"


def reading(happening: Happening) -> str:
    """Return what a departure may be: what its course does not part is named together."""
    if is_step(happening):
        return SENSOR
    house = happening.control.house
    bright = house.is_day[happening.inside].mean() >= BRIGHT
    if happening.size_K.value < 0.0:
        words = (LOST + (RETURNS if is_quick(happening, True) else "")) if is_quick(happening) else COOLS
        return words + (SHADE if bright else "")
    words = (GAINED + (RETURNS if is_quick(happening, True) else "")) if is_quick(happening) else WARMS
    return words + (SUN if bright else "") + (OWN if runs_own_heat(happening) else "")


def runs_own_heat(happening: Happening) -> bool:
    """Whether the room's recorded heat is above its usual in most of the hours in which it is known."""
    gain_W = happening.control.room.gain_W
    if gain_W is None:
        return False
    inside = gain_W[happening.inside & np.isfinite(gain_W)]
    return len(inside) > 0 and bool(np.mean(inside > np.nanmean(gain_W)) > MOST_HOURS)


def is_quick(happening: Happening, at_end: bool = False) -> bool:
    """Whether most of a departure comes within an hour of its beginning (or goes within one of its end).

    So does one of which as much comes as structure never gives.
    """
    course, steps = (
        happening.course_K * np.sign(happening.size_K.value),
        round(AT_ONCE_H / happening.control.house.step_h),
    )
    found = []
    for begin, end in happening.spans:
        most = float(course[begin:end].max())
        if at_end and end + steps <= len(course):
            found.append((course[end - 1] - course[end + steps - 1]) / min(max(most, 1e-9), 2.0 * FAST_K))
        elif not at_end:
            before = course[begin - 1] if begin else 0.0
            found.append((course[min(begin + steps, end) - 1] - before) / min(max(most, 1e-9), 2.0 * FAST_K))
    return bool(found) and float(np.median(found)) >= QUICK


def is_step(happening: Happening) -> bool:
    """Whether the thermometer itself jumps at both ends, from one sample to the next."""
    house, room = happening.control.house, happening.control.room
    if room.samples_C is None or happening.control.patterns[happening.main].taus_h[0] > 0.0:
        return False
    per_step = house.per_step
    return all(
        _jump(room.samples_C, edge * per_step, per_step) * (1.0 if is_begin else -1.0) * np.sign(happening.size_K.value)
        >= STEP * abs(happening.size_K.value)
        for begin, end in happening.spans
        for edge, is_begin in ((begin, True), (end, False))
        if 0 < edge * per_step < len(room.samples_C)
    )


def _jump(samples: np.ndarray, place: int, near: int) -> float:
    """Return the largest change from one sample to the next near a place, beyond what comes before and after it."""
    changes = np.diff(samples[max(0, place - near - 1) : place + near + 1])
    changes = np.where(np.isfinite(changes), changes, 0.0)
    if not len(changes):
        return 0.0
    most = int(np.argmax(np.abs(changes)))
    # a room that goes on in the same direction is no instrument
    beside = np.delete(changes, most)
    drift = float(np.sum(beside[np.sign(beside) == np.sign(changes[most])]))
    return float(changes[most]) if abs(drift) < abs(changes[most]) else 0.0


def when(house: House, spans: Sequence[tuple[int, int]]) -> str:
    """Return spans in words, in the record's clock."""
    ends = [(_at(house, begin), _at(house, end)) for begin, end in spans]
    if len(ends) == 1:
        begin, end = ends[0]
        until = f"{end:%H:%M}" if end.date() == begin.date() else _moment(end, house)
        last = " (the end of the record)" if spans[0][1] >= len(house) else ""
        return f"{_moment(begin, house)} to {until}{last}"
    # the record's ends may cut a span short
    whole = [(_at(house, begin), _at(house, end)) for begin, end in spans if begin > 0 and end < len(house)]
    hours = {(begin.strftime("%H:%M"), end.strftime("%H:%M")) for begin, end in whole or ends}
    if len(hours) > 1:
        told = [f"{_moment(begin, house)} to {_moment(end, house)}" for begin, end in ends[:MOST_DAYS]]
        return "; ".join(told) + _more(len(ends), "times", "; ")
    from_, to = next(iter(hours))
    return f"{from_} to {to}, {_days([each.normalize() for each, _ in ends], house)}"


def _at(house: House, step: int) -> pd.Timestamp:
    return house.begin + pd.Timedelta(step * house.step_s, "s")


def _moment(time: pd.Timestamp, house: House) -> str:
    return f"{_day(time, house)} {time:%H:%M}"


def _days(days: Sequence[pd.Timestamp], house: House) -> str:
    """Return on which days something begins."""
    first, last = house.begin.normalize(), _at(house, len(house) - 1).normalize()
    every = pd.date_range(first, last, freq="D")
    since = every[every >= days[0]]
    if len(days) >= len(since) - 1 > MOST_DAYS // 2:
        return "every day" if days[0] <= every[1] else f"every day from {_day(days[0], house)} on"
    if regular := _regular(days):
        return f"{regular} from {_day(days[0], house)} to {_day(days[-1], house)}"
    return "on " + ", ".join(_day(each, house) for each in days[:MOST_DAYS]) + _more(len(days), "days")


def _regular(days: Sequence[pd.Timestamp]) -> str:
    """Return the rule by which days come back, nothing where they have none or one of them is an exception."""
    if len(days) < REGULAR:
        return ""
    gaps = {(later - day).days for day, later in pairwise(days)}
    if len(gaps) == 1 and gaps != {len(WEEK)}:
        (gap,) = gaps
        return {1: "every day", 2: "every other day"}.get(gap, f"every {gap} days")
    week, between = sorted({each.weekday() for each in days}), pd.date_range(days[0], days[-1], freq="D")
    if len(days) < REGULAR * len(week) or list(days) != [each for each in between if each.weekday() in week]:
        return ""
    if week == [*range(5)]:
        return "from Mondays to Fridays"
    return "on " + " and ".join(f"{WEEK[place]}s" for place in week) if len(week) <= MOST_WEEKDAYS else ""


def _day(day: pd.Timestamp, house: House) -> str:
    """Return a day in words, with its year where a record has days of two."""
    is_of_years = house.begin.year != _at(house, len(house) - 1).year
    return f"{day.day} {day:%b}" + (f" {day.year}" if is_of_years else "")


def _more(count: int, what: str, before: str = " ") -> str:
    """Return how many more there are than are named one by one."""
    more = count - MOST_DAYS
    return f"{before}and {more} more {what if more > 1 else what.removesuffix('s')}" if more > 0 else ""
