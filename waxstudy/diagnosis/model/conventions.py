"""How a record may have been logged, where its words leave a choice."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from waxstudy.diagnosis.criteria import Question, limit


@dataclass(frozen=True)
class Convention:
    """A way to read a record where its words leave a choice."""

    words: str = ""  # a sentence for the report
    is_before: bool = False  # the sensor's temperature was logged before what the sensor does to it
    is_raw: bool = False  # the controller reads the noise that was logged
    is_late: bool = False  # the controller reads the temperature of a sample ago
    solar_factor: float = 1.0  # the sun's heat over what was recorded of it
    is_mean: bool = False  # temperatures were logged as means over the interval, not at its end
    is_rough: bool = False  # a chain is replayed in long steps, for a search that ends with short ones

    def differs(self, other: Convention) -> int:
        """Return in how many of its choices it differs: the sensor's log, the sun's heat, the room's temperatures."""
        return sum(one != another for one, another in zip(self._choices, other._choices, strict=True))

    def is_as(self, other: Convention, open_: Sequence[bool]) -> bool:
        """Whether it differs from another in none of the choices that are open (choices,)."""
        choices = zip(self._choices, other._choices, open_, strict=True)
        return all(one == another or not is_open for one, another, is_open in choices)

    def has_log_of(self, other: Convention) -> bool:
        """Whether the sensor's log is read in the same way."""
        return bool(self._choices[0] == other._choices[0])

    @property
    def is_handicapped(self) -> bool:
        """Whether it must be better than the others by more: it has most freedom."""
        return self.is_raw or self.is_late

    @property
    def handicap(self) -> float:
        """Loss by which it must be better than one with less freedom."""
        return limit(Question.CONVENTION, "gain", self) if self.is_handicapped else 0.0

    @property
    def drawn(self) -> Convention:
        """How it is read where noise is drawn: a controller that is said to read the logged noise has it already."""
        return AFTER if self.is_raw else self

    @property
    def _choices(self) -> tuple[Any, ...]:
        return (self.is_before, self.is_raw, self.is_late), self.solar_factor, self.is_mean


AFTER = Convention("The sensor temperature was logged as the controller reads it.")
BEFORE = Convention("The sensor temperature was logged before the sensor's delay or lag.", is_before=True)
RAW = Convention("The controller reads the sensor temperature with the noise that was logged.", is_raw=True)
LATE = Convention("The controller decides once a sample, on the temperature of the last.", is_late=True)
PLAIN = Convention()
MEAN_WORDS = "The room's temperatures were logged as means over the interval."
LONG_S = 300.0  # interval from which on that matters


def left_by(
    found: Sequence[Convention], of_healthy: Sequence[Convention], ways: Sequence[Convention]
) -> list[Convention]:
    """Return the ways to read a record that a healthy one leaves, the likeliest first.

    It leaves `found` of its own ways, `of_healthy`; `ways` are those of the record. A choice that only one of the two
    records has stays open, as how a sun is meant that only the later one has. If none of the record's ways fits, all
    stay.
    """
    open_ = [one and other for one, other in zip(_open(ways), _open(of_healthy), strict=True)]
    return list(dict.fromkeys(way for each in found for way in ways if way.is_as(each, open_))) or list(ways)


def _open(ways: Sequence[Convention]) -> list[bool]:
    """Return of each choice whether the ways differ in it."""
    return [len(set(each)) > 1 for each in zip(*(way._choices for way in ways), strict=True)]
