"""Claims about where fits begin."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from tests.diagnosis.realities import EFFECTS, study
from waxstudy.diagnosis.estimate.start_points import IMPOSSIBLE, StartPoints
from waxstudy.diagnosis.model.conventions import PLAIN
from waxstudy.plugin import Belief

pytestmark = pytest.mark.quick


def score(values: dict[str, float]) -> float:
    """A slight setback at night, beside a hollow where a deep one at noon looks nearly as good."""
    is_slight = abs(values["offset_K"]) < 0.2
    from_h, to_h = (21.0, 6.0) if is_slight else (5.0, 14.0)
    off = abs(values["from_h"] - from_h) + abs(values["to_h"] - to_h)
    return off + (0.0 if is_slight else 1.0) + (100.0 if is_slight and values["offset_K"] > 0.0 else 0.0)


def test_little_of_an_effect_is_looked_for_at_every_hour_as_well() -> None:
    """No way leads from much of it at wrong hours to little at the right ones."""
    problem: Any = SimpleNamespace(
        edited=lambda effects, departures: None,
        at=lambda effects, departures, convention: dict(effects[-1][1]),
    )
    given: Any = SimpleNamespace(effects=(), departures=())
    shift = EFFECTS["setpoint-offset"]
    look: Any = StartPoints(problem, lambda made, parts: score(made), shift, given, (), None, 1.0)
    deep = {"offset_K": -1.9, "from_h": 4.0, "to_h": 13.0}
    found = list(look.scanned(score(deep), deep, PLAIN))
    assert [each[1] for each in found] == [
        {**deep, "from_h": 5.0, "to_h": 14.0},
        {"offset_K": -0.05, "from_h": 21.0, "to_h": 6.0},
    ]
    # where little of it cannot be simulated only the first is a start
    look.score = lambda made, parts: score(made) if abs(made["offset_K"]) > 0.2 else IMPOSSIBLE
    assert len(list(look.scanned(score(deep), deep, PLAIN))) == 1


def test_an_effect_without_hours_begins_where_it_looked_best() -> None:
    believed = Belief(study().cases["REAL"].blocks, study().room)
    problem: Any = SimpleNamespace(edited=lambda effects, departures: believed)
    given: Any = SimpleNamespace(effects=(), departures=())
    look = StartPoints(problem, lambda made, parts: 0.0, EFFECTS["slow-actuator"], given, (), None, 1.0)
    assert list(look.scanned(3.0, {"factor": 1.6}, PLAIN)) == [(3.0, {"factor": 1.6}, PLAIN)]
