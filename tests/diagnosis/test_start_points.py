"""Claims about where fits begin."""

from __future__ import annotations

from operator import itemgetter
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.diagnosis.realities import EFFECTS, study
from waxstudy.diagnosis.estimate.hypothesis import Residual
from waxstudy.diagnosis.estimate.parameter_space import Space
from waxstudy.diagnosis.estimate.start_points import StartPoints
from waxstudy.diagnosis.model.conventions import BEFORE, PLAIN, Convention
from waxstudy.diagnosis.model.edits import Values
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


# in standard deviations; what 240 samples miss by a little more than one is not worth three parameters
MISSED, LITTLE = (
    Residual("control_output", "1", off, off, np.full(240, True), off, off, np.arange(240))
    for off in (np.full(240, 2.0), np.full(240, 1.02))
)


def looking(at: Any, scored: Any, missed: Residual = MISSED, near: Values | None = None) -> Any:
    problem: Any = SimpleNamespace(edited=lambda effects, departures: None, at=at)
    given: Any = SimpleNamespace(effects=(), departures=(), residuals=[missed])
    look = StartPoints(problem, scored, SHIFT, given, (0,), None, 1.0, near=near)
    look.changed = {"control_output"}  # by a first look
    return look


def as_aimed(effects: Any, departures: Any, convention: Convention) -> Any:
    return SimpleNamespace(residuals=(), **effects[-1][1])


def test_little_of_an_effect_is_found_at_its_hours_beside_much_at_others() -> None:
    """No way leads from much of it at wrong hours to little at the right ones."""
    worth, values, _ = min(looking(as_aimed, lambda made, parts: score(made)).evolved(PLAIN), key=itemgetter(0))
    assert worth < 0.5
    assert -0.2 < values["offset_K"] < 0.0
    assert (values["from_h"], values["to_h"]) == pytest.approx((21.0, 6.0), abs=0.5)


def test_a_search_is_spared_where_little_is_missed_or_a_look_before_began_near() -> None:
    for about in ({"missed": LITTLE}, {"near": {"offset_K": -0.1, "from_h": 20.0, "to_h": 5.0}}):
        assert not list(looking(as_aimed, lambda made, parts: score(made), **about).evolved(PLAIN))
    look = looking(as_aimed, lambda made, parts: score(made))
    look.changed = {"sensor_temperature_C"}  # no more than another channel misses much
    assert not list(look.evolved(PLAIN))


@pytest.mark.parametrize("hours", [(6, 8), (13, 14), (2, 12)])
def test_hours_are_found_between_which_an_effect_explains_all(hours: tuple[int, int]) -> None:
    """From all day to an hour or two no single end leads: up to the evening, or from midnight on, too much is wrong."""
    clock_h = np.arange(240) / 10.0
    is_hour = (clock_h - hours[0]) % 24.0 < (hours[1] - hours[0]) % 24.0
    none = np.zeros(240)

    def at(effects: Any, departures: Any, convention: Convention) -> Any:
        """It explains all within the hours, and is as wrong beside them."""
        from_h, to_h = (effects[0][1][name] for name in ("from_h", "to_h"))
        missed = 1.0 * is_hour - ((clock_h - from_h) % 24.0 < lasting_h(from_h, to_h))
        return SimpleNamespace(
            residuals=[Residual("control_output", "1", missed, missed, none == 0.0, none, none, np.arange(240))]
        )

    look = looking(at, lambda made, parts: sum(each.loss() for each in made.residuals))
    worth, values, _ = min(look.evolved(PLAIN), key=itemgetter(0))
    assert worth == 0.0
    assert (values["from_h"], values["to_h"]) == pytest.approx(hours, abs=0.1)  # samples of six minutes


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
    given: Any = SimpleNamespace(effects=(), departures=(), residuals=[MISSED])
    look = StartPoints(problem, lambda made, parts: 0.0, EFFECTS["slow-actuator"], given, (), None, 1.0)
    assert not list(look.evolved(PLAIN))


def test_places_away_from_neutral_are_either_side_of_it_and_as_many_for_little_as_for_much() -> None:
    space = Space(SHIFT)
    offsets_K = [space.away({"offset_K": 0.0}, np.array([x, 0.5, 0.25]))["offset_K"] for x in (0.0, 0.25, 0.75, 1.0)]
    assert offsets_K == pytest.approx([-5.0, -0.354, 0.354, 5.0], abs=1e-3)  # in the middle between 0.025 and 5 K
    assert space.away({"offset_K": 0.0}, np.array([0.5, 0.5, 0.25])) == pytest.approx(
        {"offset_K": 0.025, "from_h": 12.0, "to_h": 6.0}
    )
    half = space.away({"offset_K": 0.0}, np.array([1.0, 0.5, 0.25]), most=0.5)
    assert half["offset_K"] == pytest.approx(0.354, abs=1e-3)
    factors = [Space(EFFECTS["slow-actuator"]).away({"factor": 1.0}, np.array([x]))["factor"] for x in (0.4, 0.6)]
    assert factors[0] < 1.0 < factors[1]
