"""The limits by which effects are claimed, kept and excused, in limits.csv and criteria.csv, and how they are asked.

A criterion compares one number of a piece of evidence (most are in `select/evidence.py`) with a limit, which several
criteria share. An effect is named if it may be claimed, by itself or as one of a pair, and is kept. What decides, why
an effect is not named, `waxstudy diagnose --criteria` and the tables in docs/criteria.md all come from there.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from importlib.resources import files
from operator import ge, gt, le, lt
from typing import Any, NamedTuple

COMPARE = {"<=": le, "<": lt, ">=": ge, ">": gt}
ROOM_STAGES = ("emitter", "room")


class Question(StrEnum):
    """What the table decides; of most every criterion that applies must hold, of `ONE_IS_ENOUGH` one."""

    NUISANCE = "how far may what nobody knows of a room depart"
    JUDGE = "may a segment be judged"
    CLAIM = "may an effect be claimed, before all days are fitted"
    PAIR = "may it be one of two that explain a gap together"
    JOINT = "do two explain enough together"
    SLIGHT = "does an effect that is too small to be named explain its gap"
    SIMPLER = "is one with fewer parameters as good"
    ALIKE = "can it not be told from the best one"
    CONVENTION = "was the record logged in another way"
    ENOUGH = "does a quick look stop here"
    KEEP = "is an effect kept, fitted to all days"
    UNDERSTOOD = "is a room understood with its effects"
    LATE = "do the last days show what those before do not"
    EXACT = "is a room exactly as believed, but for its effects"
    UNKNOWN = "is what stays a gap of its own"
    EXCUSED = "is what stays no finding"


ONE_IS_ENOUGH = (Question.UNDERSTOOD, Question.EXCUSED)


class Where(NamedTuple):
    """What a criterion applies to, in words, and whether evidence is of that."""

    words: str
    applies: Callable[[Any], bool]


WHERE = {
    "": Where("everything", lambda e: True),
    "actuator": Where("effects of the actuator", lambda e: e.stage == "actuator"),
    "of-room": Where("effects of emitter and room", lambda e: e.stage in ROOM_STAGES),
    "several-parameters": Where(
        "effects of the chain with several parameters",
        lambda e: e.stage not in ROOM_STAGES and e.parameters > 1,
    ),
    "handicapped": Where("a controller that reads the logged noise, or once a sample", lambda e: e.is_handicapped),
}


@dataclass(frozen=True)
class Limit:
    """One number that decides; `is_tuned`: it was set on judged records."""

    name: str
    value: float
    unit: str
    what: str
    reason: str
    source: str
    is_tuned: bool


@dataclass(frozen=True)
class Criterion:
    """One comparison. `name` is said of what it decides."""

    questions: tuple[Question, ...]
    statistic: str  # attribute of the evidence
    operator: str
    limit: Limit
    where: Where
    name: str
    reason: str

    def holds(self, evidence: Any) -> bool:
        return bool(COMPARE[self.operator](getattr(evidence, self.statistic), self.limit.value))


@cache
def limits() -> Mapping[str, Limit]:
    """Return every limit by its name, in the order of their table."""
    return {row["name"]: _limit(**row) for row in _rows("limits.csv")}


def _limit(value: str, tuned: str, **words: str) -> Limit:
    return Limit(**words, value=float(value), is_tuned=bool(tuned))


@cache
def criteria() -> tuple[Criterion, ...]:
    """Return the table, in the order in which it is asked."""
    return tuple(_read(row) for row in _rows("criteria.csv"))


def _read(row: Mapping[str, str]) -> Criterion:
    questions = tuple(Question[name.upper().replace("-", "_")] for name in row["questions"].split())
    compared = row["statistic"], row["operator"], limits()[row["limit"]]
    return Criterion(questions, *compared, WHERE[row["where"]], row["name"], row["reason"])


def _rows(name: str) -> Iterator[Mapping[str, str]]:
    return csv.DictReader(files("waxstudy.diagnosis").joinpath(name).read_text(encoding="utf-8").splitlines())


def _of(question: Question, evidence: Any) -> Iterator[Criterion]:
    return (each for each in criteria() if question in each.questions and each.where.applies(evidence))


def failed(question: Question, evidence: Any) -> Criterion | None:
    """Return the first criterion of a question that evidence does not meet, None where it meets all."""
    return next((each for each in _of(question, evidence) if not each.holds(evidence)), None)


def meets(question: Question, evidence: Any) -> bool:
    return failed(question, evidence) is None


def meets_one(question: Question, evidence: Any) -> bool:
    return any(held(question, evidence).values())


def held(question: Question, evidence: Any) -> Mapping[str, bool]:
    """Return whether each criterion of a question holds, by its statistic."""
    return {each.statistic: each.holds(evidence) for each in _of(question, evidence)}


def limit(question: Question, statistic: str, evidence: Any = None) -> float:
    """Return the strictest limit of a statistic among the criteria that apply, which all compare it the same way."""
    asked = (each for each in criteria() if question in each.questions and each.statistic == statistic)
    found = [each for each in asked if each.where.applies(evidence)]
    return (max if found[0].operator in (">", ">=") else min)(each.limit.value for each in found)
