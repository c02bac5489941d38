"""Claims about motors and valves beside a healthy record: rest and moves are weighed each by what it leaves of them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.diagnosis.realities import EFFECTS, Effects, belief, effects, planted, record
from waxstudy.diagnosis.calibration.calibrate import Calibration, calibrate
from waxstudy.diagnosis.estimate.hypothesis import Residual, on_the_move
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.posterior import posterior
from waxstudy.diagnosis.select.weigh import Weighing
from waxstudy.plugin import Belief

FLOW, STROKE = "flow_L_h", "displacement"
NO_ROOM = ("air_temperature_C", "operative_temperature_C", "floor_surface_temperature_C", "return_temperature_C")


def link(seen: Record, judged: str) -> tuple[Segment, Belief]:
    believed = belief("REAL", seen)
    return next(each for each in segments(seen, believed) if each.judged == (judged,)), believed


def wandering(seen: Record, share: float) -> Record:
    """A record whose flow wanders over hours, as other circuits of a house take theirs."""
    hours = np.arange(len(seen)) * seen.interval_s / 3600.0
    return replace(seen, values={**seen.values, FLOW: seen.values[FLOW] * (1.0 + share * np.sin(hours))})


@cache
def house(channel: str, true: Effects = (), seed: int = 1) -> Record:
    """Four days of a house whose valve, or motor, does what is believed with some effects."""
    seen = record("REAL", without=NO_ROOM)
    segment, believed = link(seen, channel)
    made = planted(segment, seen, believed, true, seed)
    return wandering(made, 0.03) if channel == FLOW else made


@cache
def healthy(channel: str) -> Calibration:
    """What a healthy record of it says; the healthy motor takes longer than any effect that is looked for can tell."""
    built = effects(slow_actuator={"factor": 1.3}) if channel == STROKE else ()
    seen = house(channel, built, seed=2)
    some = [EFFECTS[name] for name in ("low-authority", "max-flow", "limited-travel", "let-by")]
    return calibrate(seen, link(seen, channel)[1], some)


def later(channel: str, true: Effects) -> dict[str, float]:
    """How probable each hypothesis of a later record is."""
    known = healthy(channel)
    built = effects(slow_actuator={"factor": 1.3}) if channel == STROKE else ()
    seen = house(channel, (*built, *true))
    segment, believed = link(seen, channel)
    about = segment, seen, known.as_built.believed(believed)
    whole = SegmentProblem(*about, as_built=known.as_built, parts=np.full(len(seen), FIT))
    named = [EFFECTS[name] for name in ("low-authority", "max-flow", "limited-travel", "let-by")]
    of_link = [each for each in named if each.stage in segment.stages]
    return posterior(Weighing(whole, of_link, known.healthy[segment.name], 1.0, lambda name: None).weighed())


def test_a_valve_s_curve_is_found_that_shows_in_its_moves_only_where_the_flow_wanders_at_rest() -> None:
    assert later(FLOW, effects(low_authority={"authority": 0.5}))["low-authority"] > 0.8


def test_a_motor_that_opens_less_is_found_where_its_moves_are_of_another_form() -> None:
    assert later(STROKE, effects(limited_travel={"opening": 0.93}))["limited-travel"] > 0.8


@pytest.mark.parametrize("channel", [FLOW, STROKE])
def test_where_nothing_changed_nothing_is_found(channel: str) -> None:
    assert later(channel, ())["none"] > 0.8


def test_rest_and_moves_are_told_apart_beside_a_healthy_record_only() -> None:
    seen = house(FLOW)
    segment, believed = link(seen, FLOW)
    known = healthy(FLOW).as_built
    (alone,), (beside,) = (
        SegmentProblem(segment, seen, believed, as_built=each).at((), np.zeros(0), segment.conventions[0]).regimes[1:]  # type: ignore[union-attr]
        or (None,)
        for each in (None, known)
    )
    assert alone is None
    assert beside
    assert beside.channel == on_the_move(FLOW)


def test_a_healthy_valve_on_the_move_is_weighed_by_what_it_leaves_there_and_not_by_what_is_chosen() -> None:
    left = healthy(FLOW).as_built.left
    assert left[on_the_move(FLOW)].whitened < 0.5
    assert left[FLOW].whitened > 1.0


@given(st.lists(st.tuples(st.floats(-3.0, 3.0), st.booleans(), st.booleans()), min_size=1, max_size=40))
def test_rest_and_moves_add_up_to_the_whole(samples: list[tuple[float, bool, bool]]) -> None:
    missed, judged, moves = (np.array(each) for each in zip(*samples, strict=True))
    count = len(missed)
    whole = Residual(
        FLOW, "L/h", 2.0 * missed, missed, judged, np.zeros(count, int), np.zeros(count, int), np.arange(count),
        moves=moves,
    )  # fmt: skip
    rest, moving = whole.regimes
    assert rest.loss() + moving.loss() == pytest.approx(whole.loss())
    assert rest.judged.sum() + moving.judged.sum() == judged.sum()
    share = {rest.channel: 4.0, moving.channel: 9.0}
    weighed = missed * whole.weights(share)
    assert weighed @ weighed == pytest.approx(rest.loss() / 4.0 + moving.loss() / 9.0)
