"""Weighing what may differ at a link: probabilities, courses over time, heat at hours."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.diagnosis.realities import EFFECTS, study
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.conventions import PLAIN
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.select.patterns import patterns
from waxstudy.diagnosis.select.timed import can_be_timed, timed
from waxstudy.diagnosis.select.weigh import Weighed, posterior
from waxstudy.plugin import Belief, Inputs, open_share

NOTHING = Weighed(
    fitted=Hypothesis((), PLAIN, np.zeros(0), ()),
    names=(),
    gain=0.0,
    ease=0.0,
    always=0.0,
    misfit=0.0,
    price=0.0,
    spread=1.0,
    most=0.0,
)
LEAK = replace(NOTHING, names=("infiltration",), gain=30.0, price=6.0, most=50.0, always=-20.0, left=0.1)


# --- probabilities -----------------------------------------------------------------------------------


@given(
    st.lists(
        st.builds(
            lambda gain, always, misfit, name: replace(LEAK, names=(name,), gain=gain, always=always, misfit=misfit),
            st.floats(-50.0, 1e5),
            st.floats(-50.0, 50.0),
            st.floats(0.0, 20.0),
            st.sampled_from(["a", "b", "c"]),
        ),
        max_size=6,
    )
)
def test_probabilities_sum_to_one_whatever_is_weighed(others: list[Weighed]) -> None:
    found = posterior([NOTHING, *others])
    assert sum(found.values()) == pytest.approx(1.0)
    assert all(0.0 <= each <= 1.0 for each in found.values())
    assert {"none", "unknown"} <= set(found)


def test_what_gains_much_is_probable_and_what_gains_little_is_not() -> None:
    assert posterior([NOTHING, LEAK])["infiltration"] > 0.9
    assert posterior([NOTHING, replace(LEAK, gain=2.0)])["none"] > 0.9


def test_what_leaves_much_may_as_well_be_something_unknown() -> None:
    assert posterior([NOTHING, replace(LEAK, left=0.9)])["unknown"] > 0.5


def test_what_was_so_from_the_start_is_no_change() -> None:
    found = posterior([NOTHING, replace(LEAK, always=25.0)])
    assert found["none"] > 0.9


def test_few_days_can_tell_only_so_much() -> None:
    found = posterior([NOTHING, replace(LEAK, gain=1e4, most=7.0)])
    assert 0.05 < found["none"] < 0.95


def test_what_a_healthy_record_would_not_leave_is_unknown() -> None:
    found = posterior([replace(NOTHING, misfit=6.0), replace(LEAK, gain=1.0, misfit=6.0)])
    assert found["unknown"] > 0.9


# --- courses over time -------------------------------------------------------------------------------


def record(days: int, start_h: float = 0.0) -> Record:
    return Record(600.0, 3600.0 * start_h, {"flow_L_h": np.ones(days * 144)}, {}, ())


@pytest.mark.parametrize("start_h", [0.0, 7.5])
def test_each_course_acts_in_its_hours_and_in_no_others(start_h: float) -> None:
    seen = record(5, start_h)
    time_h = (np.arange(len(seen)) + 0.5) / 6.0
    tried = list(patterns(seen))
    assert len({each.words for each in tried}) == len(tried)
    for each in tried[1:]:
        told = sum(((time_h >= begin) & (time_h < end)).astype(float) for begin, end in each.spans_h)
        assert np.array_equal(each.strength, np.broadcast_to(told, len(seen)))


def test_a_course_between_hours_goes_by_the_clock() -> None:
    evening = next(each for each in patterns(record(3, 12.0)) if each.words == "every day from 22:00 to 06:00")
    assert evening.spans_h == ((10.0, 18.0), (34.0, 42.0), (58.0, 66.0))


def test_what_grows_is_as_strong_as_always_in_the_mean() -> None:
    growing = next(iter(patterns(record(4))))
    assert growing.words == "growing"
    assert growing.strength.mean() == pytest.approx(1.0)
    assert np.all(np.diff(growing.strength) > 0.0)


# --- heat at hours -----------------------------------------------------------------------------------


def driven(count: int = 288) -> Belief:
    zero = np.zeros(count)
    air_C = 21.0 + np.sin(np.arange(count) / 23.0)
    inputs = Inputs(600.0, 0.0, zero, zero + 30.0, zero, zero + 50.0, air_C)
    return Belief({}, study().room, inputs)


def test_constant_heat_can_come_at_hours_and_nothing_else_can() -> None:
    assert {name for name, effect in EFFECTS.items() if can_be_timed(effect, driven())} == {"extra-heat"}


def test_heat_at_hours_is_the_same_heat_in_those_hours_and_none_beside_them() -> None:
    effect, believed = EFFECTS["extra-heat"], driven()
    always = effect.apply(believed, effect.Parameters(heat_W=80.0, radiant_share=0.2)).inputs
    at_night = timed(effect)
    values = {"heat_W": 80.0, "radiant_share": 0.2, "from_h": 22.0, "to_h": 6.0}
    found = at_night.apply(believed, at_night.Parameters(**values)).inputs
    assert believed.inputs
    assert always
    assert found
    assert always.extra_W is not None
    assert found.extra_W is not None
    share = open_share(believed.inputs, 22.0, 6.0)
    assert share.mean() == pytest.approx(8.0 / 24.0)
    assert found.extra_W == pytest.approx(share * always.extra_W)
    assert found.gains_W - 50.0 == pytest.approx(share * (always.gains_W - 50.0))
    assert at_night.hours(at_night.Parameters(**values)) == (22.0, 6.0)
    assert "every day from 22:00 to 06:00" in at_night.sentence(at_night.Parameters(**values))
