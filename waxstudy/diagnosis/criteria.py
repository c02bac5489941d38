"""The limits by which effects are claimed, kept and excused: the table criteria.csv, and how it is asked.

A criterion compares one number of a piece of evidence (most are in `select/evidence.py`) with a limit. An effect is
named if it may be claimed, by itself or as one of a pair, and is kept. What decides, why an effect is not named,
`waxstudy diagnose --criteria` and the table in docs/criteria.md all come from there.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from importlib.resources import files
from operator import ge, gt, le, lt
from typing import Any, NamedTuple

COMPARE = {"<=": le, "<": lt, ">=": ge, ">": gt}
FAR_APART_S = 300.0  # interval from which on samples hide what happened between them
ROOM_STAGES = ("emitter", "room")
CLEAR_GAIN, CLEAR_GAP = 50.0, 3.0  # whitened gain and floors, from which on a gap is clear


class Question(StrEnum):
    """What the table decides; of UNDERSTOOD, NO_FORM and EXCUSED one criterion is enough."""

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
    NO_FORM = "does less stay than a room of another form would leave"
    UNKNOWN = "is what stays a gap of its own"
    EXCUSED = "is what stays no finding"


class Where(NamedTuple):
    """What a criterion applies to, in words, and whether evidence is of that."""

    words: str
    applies: Callable[[Any], bool]


def _is_clear_flow(e: Any) -> bool:
    return bool(e.stage == "valve" and e.gain >= CLEAR_GAIN and e.over >= CLEAR_GAP)


WHERE = {
    "": Where("everything", lambda e: True),
    "actuator": Where("effects of the actuator", lambda e: e.stage == "actuator"),
    "sensor": Where("effects of the sensor", lambda e: e.stage == "sensor"),
    "of-room": Where("effects of emitter and room", lambda e: e.stage in ROOM_STAGES),
    "several-parameters": Where(
        "effects of the chain with several parameters",
        lambda e: e.stage not in ROOM_STAGES and e.parameters > 1,
    ),
    "smoothed": Where(
        "a control output that runs on; opening and flow behind a smoothed temperature",
        lambda e: e.runs_on or (e.is_behind_smoothed and e.channel in ("displacement", "flow_L_h")),
    ),
    "far-flow": Where(
        "flow in samples of 5 min and more", lambda e: e.channel == "flow_L_h" and e.interval_s >= FAR_APART_S
    ),
    "far-opening": Where(
        "opening in samples of 5 min and more", lambda e: e.channel == "displacement" and e.interval_s >= FAR_APART_S
    ),
    "clear-flow": Where(f"a valve's clear gap ({CLEAR_GAP:g} floors, a gain of {CLEAR_GAIN:g})", _is_clear_flow),
    "not-clear-flow": Where("all but a valve's clear gap", lambda e: not _is_clear_flow(e)),
    "supply": Where("the supply temperature", lambda e: e.channel == "supply_temperature_C"),
    "handicapped": Where("a controller that reads the logged noise, or once a sample", lambda e: e.is_handicapped),
    "runs-on": Where("a control output that runs on", lambda e: e.runs_on),
    "room": Where("rooms", lambda e: e.is_room),
    "not-room": Where("the chain", lambda e: not e.is_room),
}


@dataclass(frozen=True)
class Criterion:
    """One comparison. `name` is said of what it decides; `is_tuned`: its limit was set on judged records."""

    questions: tuple[Question, ...]
    statistic: str  # attribute of the evidence
    operator: str
    limit: float
    where: Where
    name: str
    reason: str
    source: str
    is_tuned: bool

    def holds(self, evidence: Any) -> bool:
        return bool(COMPARE[self.operator](getattr(evidence, self.statistic), self.limit))


@cache
def criteria() -> tuple[Criterion, ...]:
    """Return the table, in the order in which it is asked."""
    text = files("waxstudy.diagnosis").joinpath("criteria.csv").read_text(encoding="utf-8")
    return tuple(_read(row) for row in csv.DictReader(text.splitlines()))


def _read(row: dict[str, str]) -> Criterion:
    questions = tuple(Question[name.upper().replace("-", "_")] for name in row["questions"].split())
    where = WHERE[row["where"]]
    words = row["name"], row["reason"], row["source"]
    return Criterion(
        questions, row["statistic"], row["operator"], float(row["limit"]), where, *words, bool(row["tuned"])
    )


def _of(question: Question, evidence: Any) -> Iterator[Criterion]:
    return (each for each in criteria() if question in each.questions and each.where.applies(evidence))


def failed(question: Question, evidence: Any) -> Criterion | None:
    """Return the first criterion of a question that evidence does not meet, None where it meets all."""
    return next((each for each in _of(question, evidence) if not each.holds(evidence)), None)


def meets(question: Question, evidence: Any) -> bool:
    return failed(question, evidence) is None


def meets_one(question: Question, evidence: Any) -> bool:
    return any(each.holds(evidence) for each in _of(question, evidence))


def limit(question: Question, statistic: str, evidence: Any = None) -> float:
    """Return the strictest limit of a statistic among the criteria that apply, which all compare it the same way."""
    found = [each for each in _of(question, evidence) if each.statistic == statistic]
    return (max if found[0].operator in (">", ">=") else min)(each.limit for each in found)
