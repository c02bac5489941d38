"""Claims about how far an effect is from what is believed."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.diagnosis.realities import EFFECTS, study
from waxstudy.diagnosis.result import Interval
from waxstudy.diagnosis.select.departure import departure, distinct, steps
from waxstudy.plugin import Belief, Prior

BELIEVED = Belief(study().cases["REAL"].blocks, study().room)


@given(st.integers(-20, 20), st.floats(0.5, 5.0), st.floats(1.01, 1.5), st.booleans())
def test_a_step_is_what_the_effect_calls_noticeable_either_way(
    count: int, still: float, noticeable: float, is_log: bool
) -> None:
    prior = Prior(1e-3, 1e3, is_log=is_log, noticeable=noticeable)
    value = still * noticeable**count if is_log else still + count * noticeable
    assert steps(prior, value, still) == pytest.approx(abs(count), abs=1e-9)


@given(st.floats(0.35, 3.9))
def test_what_is_distinct_departs_and_what_may_be_what_is_believed_is_not_distinct(factor: float) -> None:
    slow = EFFECTS["slow-actuator"]
    departed = departure(slow, {"factor": factor}, BELIEVED)
    sharp, blurred = (
        distinct(slow, {"factor": Interval(factor, low, high)}, BELIEVED)
        for low, high in ((factor, factor), (min(factor, 1.0), max(factor, 1.0)))
    )
    assert sharp == departed
    assert blurred == 0.0


def test_another_kind_of_block_departs_without_bounds() -> None:
    believed = Belief(study().cases["IDEAL"].blocks, study().room)
    motor = EFFECTS["wax-motor"]
    assert motor.neutral(believed) is None
    assert departure(motor, {}, believed) == distinct(motor, {}, believed) == math.inf
