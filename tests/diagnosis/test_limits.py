"""Claims about how the limits are taken away one by one: what decides alone is noted, and one limit asks no more."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from benchmarks.limits import Watched, fits_kept
from tests.diagnosis.evidences import SOUND
from waxstudy.diagnosis import criteria, diagnose
from waxstudy.diagnosis.criteria import Question, failed, limit, limits, meets, meets_one
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.estimate.start_points import Screen
from waxstudy.diagnosis.model.conventions import PLAIN
from waxstudy.diagnosis.select.evidence import AirLeft, Evidence
from waxstudy.plugin import Effect

pytestmark = pytest.mark.quick


def watching(monkeypatch: pytest.MonkeyPatch, without: str = "") -> Watched:
    found = Watched(without)
    monkeypatch.setattr(criteria, "_of", found)
    return found


FAILING = (("chance", {"p": 0.5}), ("clear", {"gain": 1.0}), ("gap", {"over": 1.0}), ("half", {"share": 0.1}))


@pytest.mark.parametrize(("name", "poor"), FAILING)
def test_a_limit_by_which_alone_evidence_fails_is_noted(
    monkeypatch: pytest.MonkeyPatch, name: str, poor: dict[str, float]
) -> None:
    found = watching(monkeypatch)
    assert not meets(Question.CLAIM, replace(SOUND, **poor))  # type: ignore[arg-type]
    assert found.alone == {name}


def test_of_two_that_fail_none_decides_alone_and_a_number_that_is_read_decides_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = watching(monkeypatch)
    assert not meets(Question.CLAIM, replace(SOUND, p=0.5, over=1.0))
    assert meets(Question.CLAIM, SOUND)
    assert limit(Question.CLAIM, "over", SOUND) == limits()["gap"].value
    assert found.alone == set()


@pytest.mark.parametrize(("name", "poor"), FAILING)
def test_evidence_does_not_fail_by_a_limit_that_is_taken_away(
    monkeypatch: pytest.MonkeyPatch, name: str, poor: dict[str, float]
) -> None:
    watching(monkeypatch, name)
    worst: Evidence = replace(SOUND, **{key: -1e9 if key != "p" else 1.0 for key in poor})  # type: ignore[arg-type]
    assert failed(Question.CLAIM, worst) is None
    assert limit(Question.CLAIM, "over", SOUND) == limits()["gap"].value


def test_where_one_criterion_is_enough_nothing_passes_by_a_limit_that_is_taken_away(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    close = AirLeft(over_form=0.5, share_left=0.9)
    found = watching(monkeypatch)
    assert meets_one(Question.UNDERSTOOD, close)
    assert found.alone == {"tolerated"}
    watching(monkeypatch, "tolerated")
    assert not meets_one(Question.UNDERSTOOD, close)


def test_a_fit_is_made_once_and_any_other_problem_start_or_part_is_another(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[Any] = []
    monkeypatch.setattr(Estimator, "fit", lambda self, *given: made.append((self.problem.name, *given)))
    one, other = (
        Estimator[Any](SimpleNamespace(name=name, holds_out=True, is_exact_room=False, sd=())) for name in ("a", "b")
    )
    start, moved = (Hypothesis((), PLAIN, np.array([departure]), ()) for departure in (0.0, 0.1))
    with fits_kept():
        for estimator, given, parts in 2 * [
            (one, start, (0,)),
            (one, moved, (0,)),
            (one, start, (0, 1)),
            (other, start, (0,)),
        ]:
            estimator.fit(Effect, given, parts)
        assert len(made) == 4
        for least, share in 2 * [(1.0, 3.0), (2.0, 3.0), (1.0, 4.0)]:
            one.fit(Effect, start, (0,), Screen(least, {"flow_L_h": share}))
        assert len(made) == 7
        other.problem.name = "a"  # a link with days held out has the name of the whole one
        other.fit(Effect, moved, (0,))
        assert len(made) == 8
    one.fit(Effect, start, (0,))
    assert len(made) == 9


def test_a_link_that_is_weighed_is_weighed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The criteria are not asked there: without a limit it comes to the same."""
    weighed: list[str] = []
    monkeypatch.setattr(diagnose, "_changed", lambda work, segment, *given: weighed.append(segment.name) or segment)
    asked: Any = diagnose
    links = [SimpleNamespace(name=name) for name in ("valve", "actuator", "valve")]
    with fits_kept():
        assert [asked._changed(None, link, (), 1, print).name for link in links] == ["valve", "actuator", "valve"]
        assert weighed == ["valve", "actuator"]
    asked._changed(None, links[0], (), 1, print)
    assert len(weighed) == 3
