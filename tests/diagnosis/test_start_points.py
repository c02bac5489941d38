"""Claims about where fits begin."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.diagnosis.realities import EFFECTS, study
from waxstudy.diagnosis.estimate.hypothesis import Residual
from waxstudy.diagnosis.estimate.start_points import IMPOSSIBLE, StartPoints
from waxstudy.diagnosis.model.conventions import BEFORE, PLAIN, Convention
from waxstudy.plugin import Belief
from waxstudy_effects.controller import lasting_h

pytestmark = pytest.mark.quick


SHIFT = EFFECTS["setpoint-offset"]


def score(made: Any) -> float:
    """A slight setback at night, beside a hollow where a deep one at noon looks nearly as good."""
    is_slight = abs(made.offset_K) < 0.2
    from_h, to_h = (21.0, 6.0) if is_slight else (5.0, 14.0)
    off = abs(made.from_h - from_h) + abs(made.to_h - to_h)
    return off + (0.0 if is_slight else 1.0) + (100.0 if is_slight and made.offset_K > 0.0 else 0.0)


def looking(at: Any, scored: Any) -> Any:
    problem: Any = SimpleNamespace(edited=lambda effects, departures: None, at=at, clock_h=np.arange(240) / 10.0)
    given: Any = SimpleNamespace(effects=(), departures=())
    return StartPoints(problem, scored, SHIFT, given, (0,), None, 1.0)


def test_little_of_an_effect_is_looked_for_at_every_hour_as_well() -> None:
    """No way leads from much of it at wrong hours to little at the right ones."""

    def at(effects: Any, departures: Any, convention: Convention) -> Any:
        return SimpleNamespace(residuals=(), **(effects[-1][1] if effects else {}))

    deep = {"offset_K": -1.9, "from_h": 4.0, "to_h": 13.0}
    look = looking(at, lambda made, parts: score(made))
    first = score(at([(SHIFT, deep)], (), PLAIN))
    assert [each[1] for each in look.scanned(first, deep, PLAIN)] == [
        {**deep, "from_h": 5.0, "to_h": 14.0},
        {"offset_K": -0.05, "from_h": 21.0, "to_h": 6.0},
    ]
    # where little of it cannot be simulated only the first is a start
    look.score = lambda made, parts: score(made) if abs(made.offset_K) > 0.2 else IMPOSSIBLE
    assert len(list(look.scanned(first, deep, PLAIN))) == 1


@pytest.mark.parametrize("hours", [(6, 8), (13, 14), (2, 12)])
def test_hours_are_looked_at_first_between_which_an_effect_that_acts_always_would_gain(hours: tuple[int, int]) -> None:
    """From all day to an hour or two no single end leads: up to the evening, or from midnight on, too much is wrong."""
    clock_h = np.arange(240) / 10.0
    is_hour = (clock_h - hours[0]) % 24.0 < (hours[1] - hours[0]) % 24.0
    none = np.zeros(240)

    def at(effects: Any, departures: Any, convention: Convention) -> Any:
        """It explains all within the hours, and is as wrong beside them."""
        shifted = effects and (clock_h - effects[0][1]["from_h"]) % 24.0 < lasting_h(
            effects[0][1]["from_h"], effects[0][1]["to_h"]
        )
        missed = 1.0 * is_hour - shifted if effects else 1.0 * is_hour
        return SimpleNamespace(
            residuals=[Residual("control_output", "1", missed, missed, none == 0.0, none, none, np.arange(240))]
        )

    look = looking(at, lambda made, parts: sum(each.loss() for each in made.residuals))
    always = {"offset_K": 0.3, "from_h": 0.0, "to_h": 24.0}
    worth, values, _ = next(iter(look.scanned(1e9, always, PLAIN)))
    assert worth == 0.0
    assert (values["from_h"], values["to_h"]) == hours


def test_hours_that_were_found_in_one_way_to_read_a_record_are_a_start_in_another() -> None:
    look = looking(
        lambda effects, departures, convention: effects[-1][1], lambda made, parts: abs(made["from_h"] - 23.0)
    )
    poor, good = ({"offset_K": 2.0, "from_h": from_h, "to_h": 6.0} for from_h in (19.5, 23.5))
    assert look.better((3.5, poor, BEFORE), good) == (0.5, good, BEFORE)
    assert look.better((0.5, good, BEFORE), poor) == (0.5, good, BEFORE)


def test_an_effect_without_hours_begins_where_it_looked_best() -> None:
    believed = Belief(study().cases["REAL"].blocks, study().room)
    problem: Any = SimpleNamespace(edited=lambda effects, departures: believed)
    given: Any = SimpleNamespace(effects=(), departures=())
    look = StartPoints(problem, lambda made, parts: 0.0, EFFECTS["slow-actuator"], given, (), None, 1.0)
    assert list(look.scanned(3.0, {"factor": 1.6}, PLAIN)) == [(3.0, {"factor": 1.6}, PLAIN)]
