"""Claims about the table of criteria: every limit is asked, says why, and decides at the number that it states."""

from __future__ import annotations

import ast
import csv
import re
from collections.abc import Mapping
from dataclasses import FrozenInstanceError, dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import waxstudy.diagnosis
from tests.diagnosis import evidences
from tests.diagnosis.evidences import SOUND
from tests.diagnosis.realities import EFFECTS
from tests.diagnosis.regenerate_criteria import PAGE, page
from waxstudy.diagnosis.criteria import (
    COMPARE,
    ONE_IS_ENOUGH,
    WHERE,
    Criterion,
    Limit,
    Question,
    criteria,
    failed,
    limit,
    limits,
    meets,
    meets_one,
)
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.conventions import AFTER, BEFORE, LATE, PLAIN, RAW, Convention
from waxstudy.diagnosis.select.candidate import Candidate, alike, best_of
from waxstudy.diagnosis.select.evidence import AirLeft, Evidence, Left

pytestmark = pytest.mark.quick

FOLDER = Path(waxstudy.diagnosis.__path__[0])
SOURCES = {path: path.read_text(encoding="utf-8") for path in sorted(FOLDER.rglob("*.py"))}
ASKING = "\n".join(text for path, text in SOURCES.items() if path.name != "criteria.py")
WITH_WORDS = ("reason", "sentence", "summary", "words", "why", "why_not", "warnings", "assumptions")
NEAR = 1e-9
EACH_QUESTION = pytest.mark.parametrize("question", Question)
EACH_ROW = pytest.mark.parametrize("row", criteria(), ids=lambda row: f"{row.questions[0].name}-{row.statistic}")


@dataclass(frozen=True)
class Alike:
    """What is compared of two effects."""

    p: float = 0.001
    gain_per_form: float = 100.0
    apart: float = 0.0


# evidence that meets all criteria of a question; the others ask for a limit by its name
MEETING: Mapping[Question, Any] = {
    Question.CLAIM: SOUND,
    Question.PAIR: SOUND,
    Question.JOINT: SOUND,
    Question.SLIGHT: replace(SOUND, departure=0.5),
    Question.SIMPLER: Alike(),
    Question.ALIKE: Alike(),
    Question.ENOUGH: SOUND,
    Question.KEEP: evidences.KEPT,
    Question.UNDERSTOOD: AirLeft(over_form=5.0, share_left=0.9),
    Question.LATE: evidences.LATE,
    Question.EXACT: evidences.EXACT,
    Question.UNKNOWN: evidences.UNKNOWN,
    Question.EXCUSED: Left(),
}


# --- the table -------------------------------------------------------------------------------------------


def rows(name: str) -> list[dict[str, str]]:
    return list(csv.DictReader((FOLDER / name).read_text(encoding="utf-8").splitlines()))


def test_every_row_is_read_in_its_order() -> None:
    asked = [(r["statistic"], r["operator"], r["limit"], WHERE[r["where"]], r["name"]) for r in rows("criteria.csv")]
    assert asked == [(e.statistic, e.operator, e.limit.name, e.where, e.name) for e in criteria()]
    assert [[name.upper().replace("-", "_") for name in r["questions"].split()] for r in rows("criteria.csv")] == [
        [question.name for question in each.questions] for each in criteria()
    ]
    told = [(r["name"], float(r["value"]), r["unit"], r["tuned"] == "yes") for r in rows("limits.csv")]
    assert told == [(e.name, e.value, e.unit, e.is_tuned) for e in limits().values()]
    assert {r["tuned"] for r in rows("limits.csv")} == {"", "yes"}


def test_fifteen_limits_at_most_decide_and_each_of_them_does() -> None:
    assert len(limits()) <= 15
    assert {row.limit.name for row in criteria()} == set(limits())


def test_criteria_that_share_a_limit_share_one_that_nobody_changes() -> None:
    assert {id(row.limit) for row in criteria()} == {id(each) for each in limits().values()}
    for each in (criteria()[0], criteria()[0].limit):
        with pytest.raises(FrozenInstanceError):
            each.name = "another"  # type: ignore[misc]


def test_a_limit_says_what_it_is_why_and_where_it_comes_from() -> None:
    for each in limits().values():
        assert all(words.strip() for words in (each.what, each.reason, each.source)), each.name


@EACH_ROW
def test_a_criterion_says_what_it_decides_and_why(row: Criterion) -> None:
    assert row.questions
    assert len(set(row.questions)) == len(row.questions)
    assert all(words.strip() for words in (row.name, row.reason, row.where.words))


def test_no_two_limits_are_of_the_same_number_of_the_same_evidence() -> None:
    asked = [(question, row.statistic, row.where.words) for row in criteria() for question in row.questions]
    assert len(set(asked)) == len(asked)


def test_a_question_compares_a_number_with_all_its_limits_the_same_way() -> None:
    asked = {(question, row.statistic, row.operator) for row in criteria() for question in row.questions}
    assert len({asked_for[:2] for asked_for in asked}) == len(asked)


def test_each_kind_of_evidence_that_is_told_apart_has_a_limit_of_its_own() -> None:
    assert {id(row.where) for row in criteria()} == {id(where) for where in WHERE.values()}


@EACH_QUESTION
def test_every_question_has_a_row_and_is_asked(question: Question) -> None:
    assert any(question in row.questions for row in criteria())
    assert re.search(rf"\bQuestion\.{question.name}\b", ASKING)


@EACH_QUESTION
def test_a_number_that_is_asked_for_is_one_of_the_evidence_or_named_where_it_is_asked_for(question: Question) -> None:
    for row in (row for row in criteria() if question in row.questions):
        if question in MEETING:
            assert isinstance(getattr(MEETING[question], row.statistic), float | int)
        else:
            assert re.search(rf'limit\((Question\.)?{question.name}, "{row.statistic}"', ASKING)


# --- how it is asked -------------------------------------------------------------------------------------


def criterion(operator: str, limit: float = 2.0) -> Criterion:
    number = Limit("gap", limit, "", "what", "reason", "source", False)
    return Criterion((Question.CLAIM,), "gain", operator, number, WHERE[""], "name", "reason")


@pytest.mark.parametrize(
    ("operator", "below", "at", "above"),
    [("<=", True, True, False), ("<", True, False, False), (">=", False, True, True), (">", False, False, True)],
)
def test_an_operator_compares_the_evidence_with_the_limit(operator: str, below: bool, at: bool, above: bool) -> None:
    held = [criterion(operator).holds(replace(SOUND, gain=gain)) for gain in (1.999, 2.0, 2.001)]
    assert held == [below, at, above]


@given(st.floats(), st.floats(allow_nan=False))
def test_what_is_no_number_meets_nothing_and_every_other_one_a_comparison_or_its_opposite(
    gain: float, least: float
) -> None:
    evidence = replace(SOUND, gain=gain)
    held = {operator: criterion(operator, least).holds(evidence) for operator in COMPARE}
    if np.isnan(gain):
        assert not any(held.values())
    else:
        assert held["<="] is not held[">"]
        assert held[">="] is not held["<"]


ORDER = (
    ({"p": 0.5}, "may be chance"),
    ({"gain": 1.0}, "hardly better than without"),
    ({"travel": 0.5}, "real motors stray as much"),
    ({"over": 1.0}, "the gap is within noise"),
    ({"departure": 0.5}, "too slight to be named"),
    ({"share": 0.1}, "explains too little"),
)


def test_the_first_criterion_that_fails_is_the_one_that_is_named() -> None:
    for place, (_, name) in enumerate(ORDER):
        poor = replace(SOUND, **{key: value for each, _ in ORDER[place:] for key, value in each.items()})  # type: ignore[arg-type]
        found = failed(Question.CLAIM, poor)
        assert found
        assert found.name == candidate(poor).why_not == name
        assert not candidate(poor).meets(Question.CLAIM)
    assert failed(Question.CLAIM, SOUND) is None
    assert candidate(SOUND).why_not == ""


@given(st.sets(st.sampled_from(range(len(ORDER)))))
def test_evidence_is_accepted_where_no_criterion_fails_and_nowhere_else(places: set[int]) -> None:
    poor = replace(SOUND, **{key: value for place in places for key, value in ORDER[place][0].items()})  # type: ignore[arg-type]
    assert candidate(poor).meets(Question.CLAIM) is (not places)
    assert candidate(poor).why_not == (ORDER[min(places)][1] if places else "")


# --- each limit ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Case:
    """A limit as it should be; `of` makes evidence that it applies to, `beside` such that it does not."""

    questions: tuple[Question, ...]
    statistic: str
    operator: str
    limit: float
    of: Mapping[str, Any] = field(default_factory=lambda: MappingProxyType({}))
    beside: Mapping[str, Any] | None = None
    by: str = ""  # the field that moves the statistic

    @property
    def name(self) -> str:
        of = "-".join(f"{value}" for value in self.of.values())
        return f"{self.statistic}-{self.limit:g}-{of}{self.by}"

    def with_(self, question: Question, value: float, more: Mapping[str, Any] = MappingProxyType({})) -> Any:
        return replace(MEETING[question], **{**self.of, **more, self.by or self.statistic: value})

    @property
    def sides(self) -> tuple[float, float]:
        """Values that just meet it, and just do not."""
        up = NEAR if self.operator in (">", "<=") else -NEAR
        return (self.limit, self.limit + up) if "=" in self.operator else (self.limit + up, self.limit)

    def row(self, question: Question) -> Criterion:
        key = self.statistic, self.operator, self.limit
        (found,) = [
            e for e in criteria() if question in e.questions and (e.statistic, e.operator, e.limit.value) == key
        ]
        return found


Q = Question
CLAIMED, SEEN = (Q.CLAIM, Q.PAIR), (Q.CLAIM, Q.PAIR, Q.SLIGHT)
CASES = (
    Case((*SEEN, Q.ALIKE), "p", "<=", 0.01),
    Case(SEEN, "gain_per_form", ">=", 9.0, by="gain"),
    Case((Q.ALIKE,), "gain_per_form", ">=", 9.0),
    Case((Q.ALIKE, Q.SIMPLER), "apart", "<=", 9.0),
    Case(CLAIMED, "travel", ">", 1.0, beside={"stage": "valve"}),
    Case(CLAIMED, "over", ">=", 1.5),
    Case((Q.CLAIM,), "departure", ">", 1.0),
    Case((Q.SLIGHT,), "departure", "<=", 1.0),
    Case((Q.CLAIM,), "share", ">=", 0.5),
    Case((Q.CLAIM,), "plain_share", ">=", 0.5),
    Case((Q.PAIR,), "share", ">=", 0.25),
    Case((Q.JOINT,), "share", ">=", 0.8),
    Case((Q.SLIGHT,), "left", "<=", 1.5),
    Case((Q.ENOUGH,), "left", "<=", 1.5),
    Case((Q.KEEP,), "fresh_share", ">=", 0.25),
    Case((Q.KEEP,), "whole_share", ">=", 0.5, {"stage": "room"}, {"stage": "valve", "parameters": 1}),
    Case((Q.KEEP,), "whole_share", ">=", 0.5, {"stage": "emitter"}, {"stage": "sensor", "parameters": 1}),
    Case((Q.KEEP,), "whole_share", ">=", 0.8, {"stage": "valve", "parameters": 2}, {"parameters": 1}),
    Case((Q.KEEP,), "whole_share", ">=", 0.8, {"stage": "valve", "parameters": 2}, {"stage": "emitter"}),
    Case((Q.KEEP,), "distinct", ">", 1.0),
    Case((Q.UNDERSTOOD,), "over_form", "<=", 1.0),
    Case((Q.UNDERSTOOD,), "share_left", "<=", 0.25),
    Case((Q.LATE,), "growth", ">", 1.5),
    Case((Q.LATE,), "over", ">", 1.5),
    Case((Q.LATE,), "over_form", ">", 1.0),
    Case((Q.EXACT,), "over_loose", "<=", 3.0),
    Case((Q.EXACT,), "over", ">=", 1.5),
    Case((Q.EXACT,), "left", "<=", 1.5),
    Case((Q.EXACT,), "left_K", "<=", 0.015),
    Case((Q.UNKNOWN,), "p", "<=", 0.01),
    Case((Q.UNKNOWN,), "over", ">", 1.5),
    Case((Q.EXCUSED,), "over_form", "<=", 1.0),
    Case((Q.EXCUSED,), "of_drives", "<=", 0.5),
)
ASKED = [(case, question) for case in CASES for question in case.questions]
EACH_CASE = pytest.mark.parametrize(
    ("case", "question"), ASKED, ids=[f"{question.name}-{case.name}" for case, question in ASKED]
)
# limits that are asked for by their name
PINNED: Mapping[tuple[Question, str, Convention | None], float] = {
    (Q.JUDGE, "blocks", None): 3.0,
    (Q.JUDGE, "known_share", None): 0.3,
    (Q.JUDGE, "driven_share", None): 0.3,
    (Q.CONVENTION, "gain", PLAIN): 9.0,
    (Q.CONVENTION, "gain", AFTER): 9.0,
    (Q.CONVENTION, "gain", BEFORE): 9.0,
    (Q.CONVENTION, "gain", RAW): 60.0,
    (Q.CONVENTION, "gain", LATE): 60.0,
}


def test_each_limit_of_evidence_is_tried() -> None:
    tried = {(question, case.statistic, case.operator, case.limit) for case, question in ASKED}
    asked = [(question, row) for row in criteria() for question in row.questions if question in MEETING]
    assert tried == {(question, row.statistic, row.operator, row.limit.value) for question, row in asked}


@EACH_CASE
def test_what_just_meets_a_limit_passes_and_what_just_does_not_is_refused_by_it(case: Case, question: Question) -> None:
    meeting, failing = (case.with_(question, value) for value in case.sides)
    if question in ONE_IS_ENOUGH:
        assert meets_one(question, meeting)
        assert not meets_one(question, failing)
        return
    assert failed(question, meeting) is None
    assert meets(question, meeting)
    assert failed(question, failing) is case.row(question)


@pytest.mark.parametrize(
    ("case", "question"), [(case, question) for case, question in ASKED if case.beside is not None]
)
def test_what_a_limit_does_not_apply_to_is_not_judged_by_it(case: Case, question: Question) -> None:
    assert case.beside is not None
    meeting, failing = (case.with_(question, value, case.beside) for value in case.sides)
    row = case.row(question)
    assert not row.where.applies(failing)
    assert failed(question, failing) is not row
    if question in ONE_IS_ENOUGH:
        assert not meets_one(question, meeting)


@pytest.mark.parametrize(("asked", "most"), PINNED.items(), ids=lambda each: str(each))
def test_a_limit_that_is_asked_for_by_its_name(asked: tuple[Question, str, Convention | None], most: float) -> None:
    assert limit(*asked) == most


def test_of_several_limits_that_apply_the_largest_is_the_least_that_must_be_reached() -> None:
    asked = [each for each in criteria() if Q.CONVENTION in each.questions]
    assert [each.limit.value for each in asked if each.where.applies(PLAIN)] == [9.0]
    assert [each.limit.value for each in asked if each.where.applies(RAW)] == [9.0, 60.0]
    assert (limit(Q.CONVENTION, "gain", PLAIN), limit(Q.CONVENTION, "gain", RAW)) == (9.0, 60.0)


def read(name: str) -> str:
    """A name as it is read from a file: not the object that the code holds."""
    return "".join(name)


@pytest.mark.parametrize("told", ["actuator", "controller", "modulator", "room", "sensor", "supply", "valve"])
def test_a_place_is_no_other_one_of_a_name_before_or_after_it(told: str) -> None:
    assert WHERE["actuator"].applies(replace(SOUND, stage=read(told))) is (told == "actuator")


# --- evidence --------------------------------------------------------------------------------------------


def candidate(evidence: Evidence, name: str = "slow-actuator") -> Candidate:
    return Candidate(EFFECTS[name], Hypothesis((), PLAIN, np.zeros(0), []), evidence)


@given(st.integers(-100, 100), st.sampled_from([0.0, 0.125, 0.25, 0.5, 1.0]))
def test_a_gain_counts_for_more_in_a_room_whose_form_leaves_less(gain: int, form: float) -> None:
    """In one that leaves nothing at all whatever is no loss is enough."""
    assert meets(Q.CLAIM, replace(SOUND, gain=float(gain), form_share=form)) is (gain >= 9.0 * form)


@pytest.mark.parametrize(("more", "is_alike"), [(0.0, True), (36.0, True), (36.0 + 1e-6, False), (-5.0, True)])
def test_effects_are_alike_by_what_is_left_of_the_best_one(more: float, is_alike: bool) -> None:
    """Nine times what twice a standard deviation is squared."""
    best = candidate(replace(SOUND, missed=2.0))
    other = candidate(replace(SOUND, loss=SOUND.loss + more), "limited-travel")
    strained = candidate(replace(SOUND, strain=more), "limited-travel")
    for each in (other, strained):
        group = ("slow-actuator", "limited-travel") if is_alike else ("slow-actuator",)
        assert alike(best, [best, each]) == group
    assert alike(best, [best, candidate(replace(SOUND, p=0.5), "limited-travel")]) == ("slow-actuator",)
    assert alike(best, [best, candidate(replace(SOUND, gain=1.0), "limited-travel")]) == ("slow-actuator",)


@given(st.lists(st.floats(-30.0, 30.0), min_size=1, max_size=8))
def test_a_group_begins_with_the_best_and_goes_on_with_what_is_nearest_to_it(more: list[float]) -> None:
    best, names = candidate(SOUND), [name for name in sorted(EFFECTS) if name != "slow-actuator"]
    others = {name: replace(SOUND, loss=SOUND.loss + each) for name, each in zip(names, more, strict=False)}
    group = alike(best, [best, *(candidate(each, name) for name, each in others.items())])
    assert group[0] == "slow-actuator"
    assert set(group[1:]) == {name for name, each in others.items() if each.loss - SOUND.loss <= 9.0}
    losses = [others[name].loss for name in group[1:]]
    assert losses == sorted(losses)


def test_of_gains_that_are_the_same_but_for_rounding_the_first_by_name_is_the_best() -> None:
    ahead = candidate(replace(SOUND, gain=1000.0), "slow-actuator")
    even = candidate(replace(SOUND, gain=1000.0 - 1e-6), "limited-travel")
    assert best_of([ahead, even]).effect.name == "limited-travel"
    assert best_of([ahead, replace(even, evidence=replace(even.evidence, gain=999.0))]) is ahead


@given(st.floats(0.0, 20.0), st.integers(1, 4), st.integers(1, 4))
def test_one_with_fewer_parameters_is_the_best_where_it_cannot_be_told_from_it(
    worse: float, few: int, many: int
) -> None:
    ahead = candidate(replace(SOUND, gain=1000.0, parameters=many), "constant-times")
    simple = candidate(replace(SOUND, gain=500.0, parameters=few, loss=SOUND.loss + worse))
    assert best_of([ahead, simple]) is (simple if few < many and simple.evidence.loss - SOUND.loss <= 9.0 else ahead)


@given(st.floats(0.0, 10.0), st.floats(0.0, 10.0), st.floats(0.0, 10.0))
def test_a_part_of_a_pair_may_be_too_slight_to_be_named_and_a_slight_one_is_never_claimed(
    over: float, departure: float, left: float
) -> None:
    each = candidate(replace(SOUND, over=over, departure=departure, left=left))
    assert not (each.meets(Question.SLIGHT) and each.meets(Question.CLAIM))
    assert each.meets(Question.PAIR) is (over >= 1.5)
    assert not each.meets(Question.CLAIM) or each.meets(Question.PAIR)


# --- words decide nothing --------------------------------------------------------------------------------


def is_of_words(node: ast.expr) -> bool:
    """Whether an expression is something that a user reads."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, str) and " " in node.value.strip()
    return isinstance(node, ast.Attribute | ast.Name) and getattr(node, "attr", getattr(node, "id", "")) in WITH_WORDS


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(FOLDER)))
def test_no_decision_rests_on_words(path: Path) -> None:
    for node in ast.walk(ast.parse(SOURCES[path])):
        if isinstance(node, ast.Compare):
            assert not any(map(is_of_words, (node.left, *node.comparators))), ast.unparse(node)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            is_search = node.func.attr in ("startswith", "endswith", "removeprefix", "find", "match", "search")
            # the unit that a parameter's name ends with is no word
            is_unit = [getattr(each, "value", "") for each in node.args] == ["_s"]
            assert not is_search or is_unit, ast.unparse(node)


def test_the_page_lists_every_criterion() -> None:
    current = PAGE.read_text(encoding="utf-8") == page()
    assert current, f"the table of {PAGE.name} is old: python -m tests.diagnosis.regenerate_criteria"
