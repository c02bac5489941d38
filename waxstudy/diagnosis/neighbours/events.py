"""From patterns to what is told of a room: patterns of one happening together, its hours, its size, its heat."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from waxstudy.diagnosis.neighbours.control import TAUS_H, Control
from waxstudy.diagnosis.neighbours.limits import AFTER_H, ALIKE, FORM_K, FORM_SHARE, KNOWN, MAIN, NOTICEABLE_K, START_H
from waxstudy.diagnosis.neighbours.pattern import Pattern
from waxstudy.diagnosis.neighbours.search import beside, gained, sizes
from waxstudy.diagnosis.neighbours.series import response
from waxstudy.diagnosis.neighbours.spans import unrest_of
from waxstudy.diagnosis.result import NORMAL, Interval
from waxstudy.plugin import FloatArray


@dataclass(frozen=True)
class Happening:
    """What departs in a room at one time or at hours that come back: numbers of patterns that belong together."""

    control: Control
    parts: tuple[int, ...]

    @cached_property
    def inside(self) -> np.ndarray:
        """Whether a step (n,) is one in which it acts: what echoes before and after is not."""
        drive = np.zeros(len(self.control.house))
        for part in self.parts:
            drive += self.control.mean_K(part) * self.control.patterns[part].inside(len(drive))
        most = drive[np.argmax(np.abs(drive))]
        return np.asarray(drive * np.sign(most) >= MAIN * abs(most))

    @cached_property
    def spans(self) -> list[tuple[int, int]]:
        """The spans in which it acts, as steps from and to."""
        edges = np.flatnonzero(np.diff(np.concatenate(([0], self.inside.astype(int), [0]))))
        return [(int(begin), int(end)) for begin, end in edges.reshape(-1, 2)]

    @cached_property
    def course_K(self) -> FloatArray:
        """What it makes of the air (n,)."""
        return sum((self.control.course_K(part) for part in self.parts), np.zeros(len(self.control.house)))

    @cached_property
    def main(self) -> int:
        """The largest of its patterns."""
        return max(self.parts, key=lambda part: abs(self.control.mean_K(part)))

    @cached_property
    def size_K(self) -> Interval:
        """The mean departure in its hours, with what its ends and the form of the answer leave open."""
        value = float(self.course_K[self.inside].mean())
        form_K = np.hypot(FORM_K, FORM_SHARE * value)
        wide = NORMAL * float(np.sqrt(self._spread_K**2 + self._of_ends_K**2 + form_K**2))
        return Interval(value, value - wide, value + wide)

    @property
    def _spread_K(self) -> float:
        control = self.control
        means = np.zeros(control.regressors.shape[1])
        for part in self.parts:
            place = control.place(part)
            means[place] = control.regressors[self.inside][:, place].mean(axis=0)
        unrest = unrest_of(control.house, control.fit, control.patterns[self.main])
        return float(np.sqrt(unrest * max(0.0, float(means @ control.fit.covariance @ means))))

    @property
    def _of_ends_K(self) -> float:
        """The spread of the mean departure over other ends and answers of its main pattern, as likely as they are."""
        control, pattern = self.control, self.control.patterns[self.main]
        without = control.without(self.main)
        tried: list[Pattern] = [pattern, *beside(pattern)]
        gains = np.array([gained(without, each) for each in tried])
        weights = np.exp(0.5 * (gains - gains.max()) / unrest_of(control.house, control.fit, pattern))
        near = np.flatnonzero(weights > ALIKE)
        weights = weights[near] / weights[near].sum()
        means = np.array([_mean_K(without, tried[i], self.inside) for i in near])
        return float(np.sqrt(weights @ (means - weights @ means) ** 2))

    @property
    def own_heat(self) -> Interval | None:
        """The heat [W] that would do the same, by the room's answer to its own recorded heat; None if that is vague."""
        answer = answer_K_W(self.control, self.inside)
        if answer is None:
            return None
        value = self.size_K.value / answer.value
        spread = np.hypot(
            (self.size_K.high - self.size_K.low) / self.size_K.value, (answer.high - answer.low) / answer.value
        )
        wide = 0.5 * abs(value) * float(spread)
        return Interval(value, value - wide, value + wide)

    @property
    def assumed_heat(self) -> Interval | None:
        """The heat [W] that warms an assumed capacity as fast as the air departs at first; None if none is assumed."""
        capacity = self.control.room.capacity_Wh_K
        if capacity is None:
            return None
        steps = max(1, round(START_H / self.control.house.step_h))
        begins = [begin for begin, _ in self.spans if begin >= 1 and begin + steps <= len(self.course_K)]
        if not begins:
            return None
        rises = [self.course_K[begin + steps - 1] - self.course_K[begin - 1] for begin in begins]
        value = capacity * float(np.mean(rises)) / (steps * self.control.house.step_h)
        share = (self.size_K.high - self.size_K.value) / abs(self.size_K.value)
        return Interval(value, value - abs(value) * share, value + abs(value) * share)


def _mean_K(without: Control, pattern: Pattern, inside: np.ndarray) -> float:
    size_K, _ = sizes(without, pattern)
    return float((pattern.shapes(without.house)[inside] @ size_K).mean())


def answer_K_W(control: Control, inside: np.ndarray) -> Interval | None:
    """Return by how much a watt in some steps (n,) warms the air there [K/W]; None where own heat does not tell."""
    own = [
        (i, tau) for tau in TAUS_H["own heat"] for i, name in enumerate(control.names) if name == f"own heat {tau:g} h"
    ]
    if not own:
        return None
    places = [place for place, _ in own]
    drive = inside.astype(float)
    means = np.array([response(drive, tau, control.house.step_h)[inside].mean() for _, tau in own])
    value = float(means @ control.fit.coefficients[places])
    spread = float(means @ control.fit.covariance[np.ix_(places, places)] @ means) ** 0.5
    known = value > KNOWN * spread
    return Interval(value, value - NORMAL * spread, value + NORMAL * spread) if known else None


def happenings(control: Control) -> Iterator[Happening]:
    """Yield what departs in a room, the earliest first."""
    near = round(AFTER_H / control.house.step_h)
    groups: list[set[int]] = []
    for number, pattern in enumerate(control.patterns):
        touched = [group for group in groups if any(_belong(pattern, control.patterns[i], near) for i in group)]
        groups = [group for group in groups if group not in touched]
        groups.append({number}.union(*touched))
    found = [Happening(control, tuple(sorted(group))) for group in groups]
    told = [each for each in found if abs(each.size_K.value) >= NOTICEABLE_K and each.inside.any()]
    yield from sorted(told, key=lambda each: each.spans[0])


def _belong(one: Pattern, other: Pattern, near: int) -> bool:
    """Whether all spans of the one with fewer overlap with those of the other, or are next to them."""
    few, many = sorted((one, other), key=lambda each: len(each.spans))
    return all(any(a < end + near and begin < b + near for begin, end in many.spans) for a, b in few.spans)


def shares_hours(one: Sequence[tuple[int, int]], other: Sequence[tuple[int, int]], count: int) -> float:
    """Return the hours of both over the hours of either."""
    a, b = (Pattern(tuple(each), (0.0,)).inside(count) for each in (one, other))
    return float((a & b).sum() / max(1, (a | b).sum()))
