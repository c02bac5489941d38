"""Claims about the numbers that the criteria are asked of."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.diagnosis.realities import EFFECTS, study
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis, Residual
from waxstudy.diagnosis.model.conventions import PLAIN
from waxstudy.diagnosis.observations.partition import FIT, SELECT, SHRINK
from waxstudy.diagnosis.residuals.noise_floor import NoiseFloor
from waxstudy.diagnosis.result import Interval
from waxstudy.diagnosis.select.evidence import (
    AirLeft,
    Kept,
    Late,
    departure,
    distinct,
    steps,
    strongest,
)
from waxstudy.plugin import Belief, Prior

pytestmark = pytest.mark.quick

PARTS = np.repeat([FIT, SELECT, SHRINK], 10)
CHANNEL = "flow_L_h"
BELIEVED = Belief(study().cases["REAL"].blocks, study().room)
SIZE = st.floats(0.01, 100.0)


def residual(sizes: tuple[float, float, float], channel: str = CHANNEL, form: float = 0.0, sd: float = 1.0) -> Residual:
    """What is missed by one size in each part, over a standard deviation."""
    error = np.repeat(sizes, 10)
    every, at = np.ones(30, dtype=bool), np.arange(30)
    return Residual(channel, "L/h", error, error / sd, every, at, PARTS, at, form)


def model(*residuals: Residual) -> Hypothesis:
    return Hypothesis((), PLAIN, np.zeros(0), list(residuals))


def floor(size: float, *channels: str) -> NoiseFloor:
    return NoiseFloor(dict.fromkeys(channels, size), dict.fromkeys(channels, size))


# --- kept ------------------------------------------------------------------------------------------------


@given(SIZE, st.floats(0.0, 2.0))
def test_what_the_last_days_confirm_is_the_share_of_their_squared_gap(size: float, left: float) -> None:
    before, after = model(residual((1.0, 1.0, size))), model(residual((5.0, 5.0, left * size)))
    kept = Kept.of(EFFECTS["max-flow"], CHANNEL, before, after)
    assert kept.fresh_share == pytest.approx(1.0 - left**2)
    assert (kept.stage, kept.parameters) == ("valve", 1)
    assert kept.whole_share == kept.distinct == math.inf


@pytest.mark.parametrize(("left", "share"), [(0.0, math.inf), (0.1, -math.inf)])
def test_last_days_without_a_gap_are_confirmed_by_what_makes_none(left: float, share: float) -> None:
    pair = model(residual((1.0, 1.0, 0.0))), model(residual((1.0, 1.0, left)))
    assert Kept.of(EFFECTS["max-flow"], CHANNEL, *pair).fresh_share == share


def test_without_last_days_there_is_nothing_to_confirm() -> None:
    missed, every, part = np.ones(20), np.ones(20, dtype=bool), PARTS[:20]
    short = model(Residual(CHANNEL, "L/h", missed, missed, every, part, part, np.arange(20)))
    assert Kept.of(EFFECTS["max-flow"], CHANNEL, short, short).fresh_share == math.inf


@given(SIZE, st.floats(0.0, 1.0))
def test_the_share_of_the_whole_record_is_that_above_the_floor(size: float, left: float) -> None:
    """What is left within the floor is all explained."""
    least, *gaps = 0.6, 0.6 + size, 0.6 + left * size
    before, after = (model(residual((each,) * 3)) for each in gaps)
    kept = Kept.of(EFFECTS["max-flow"], CHANNEL, before, after, floor(least, CHANNEL))
    excess = (gaps[1] ** 2 - least**2) / (gaps[0] ** 2 - least**2)
    assert kept.whole_share == pytest.approx(1.0 - excess, abs=1e-9)


# --- rooms and last days ---------------------------------------------------------------------------------


@given(SIZE, SIZE, SIZE)
def test_what_stays_of_the_air_is_told_by_the_form_and_by_what_there_was(
    before: float, after: float, form: float
) -> None:
    left = AirLeft.of(residual((before,) * 3, form=form), residual((after,) * 3, form=form))
    assert left.over_form == pytest.approx(after / form)
    assert left.share_left == pytest.approx(after / before)


@given(SIZE, SIZE, SIZE)
def test_late_is_what_grows_over_the_worse_of_the_parts_before(fit: float, select: float, last: float) -> None:
    late = Late.of(residual((fit, select, last), form=2.0), 4.0)
    expected = last / max(fit, select), last / 4.0, last / 2.0
    assert (late.growth, late.over, late.over_form) == pytest.approx(expected)


# --- noticeable steps ------------------------------------------------------------------------------------


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


# --- the gap that an effect explains ---------------------------------------------------------------------


@given(st.lists(SIZE, min_size=2, max_size=4, unique=True))
def test_an_effect_acts_where_it_gains_most(sizes: list[float]) -> None:
    names = [f"channel {place}" for place in range(len(sizes))]
    before = model(*(residual((size,) * 3, name) for name, size in zip(names, sizes, strict=True)))
    after = model(*(residual((0.0,) * 3, name) for name in names))
    channel, share, left = strongest(before, after, floor(0.001, *names))
    assert channel == names[int(np.argmax(sizes))]
    assert share == pytest.approx(1.0)
    assert left == 0.0
