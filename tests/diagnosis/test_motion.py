"""Claims about motors and valves beside a healthy record: each motion is weighed by what it leaves there."""

from __future__ import annotations

import shutil
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.conftest import DATA
from tests.diagnosis.realities import EFFECTS, Effects, belief, effects, plain, planted, record
from waxstudy.api.diagnosing import diagnose
from waxstudy.diagnosis.calibration.calibrate import Calibration, calibrate
from waxstudy.diagnosis.estimate.hypothesis import MOTIONS, Residual, motions_of
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.continuous import Continuous
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.posterior import posterior
from waxstudy.diagnosis.select.weigh import Weighing
from waxstudy.plugin import Belief

PAIRS = DATA / "baselines"
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
    whole = SegmentProblem(segment, seen, believed, as_built=known.as_built, parts=np.full(len(seen), FIT))
    named = [EFFECTS[name] for name in ("low-authority", "max-flow", "limited-travel", "let-by")]
    of_link = [each for each in named if each.stage in segment.stages]
    return posterior(Weighing(whole, of_link, known.healthy[segment.name], 1.0, lambda name: None).weighed())


def test_a_valve_s_curve_is_found_that_shows_in_its_moves_only_where_the_flow_wanders_at_rest() -> None:
    assert later(FLOW, effects(low_authority={"authority": 0.5}))["low-authority"] > 0.8


def test_a_motor_that_opens_less_is_found_where_its_moves_are_of_another_form() -> None:
    assert later(STROKE, effects(limited_travel={"opening": 0.93}))["limited-travel"] > 0.8


def test_a_small_leak_is_found_whose_meter_runs_all_the_time_where_the_healthy_one_stood() -> None:
    """It brings the meter's noise, and not what the flow wanders by while the valve is open."""
    assert later(FLOW, effects(let_by={"fraction": 0.005}))["let-by"] > 0.8


@pytest.mark.parametrize("interval_s", [30.0, 60.0, 300.0])
def test_a_stroke_is_a_move_however_often_it_is_sampled(interval_s: float) -> None:
    """Of a stroke of three minutes; a sample beside one that moved belongs to it."""
    time_s = np.arange(0.0, 7200.0, interval_s)
    stroke = np.interp(time_s, [3600.0, 3780.0], [0.0, 1.0]) + np.random.default_rng(1).normal(0.0, 0.01, len(time_s))
    seen = plain({STROKE: stroke}, interval_s, stated_noise={STROKE: 0.01})
    segment = Segment(("actuator",), "heating_signal", (STROKE,))
    way = Continuous(STROKE, segment, seen, np.zeros(len(time_s)), None, left=(1.0, 1.0))
    assert way.motion is not None
    moves = time_s[way.motion == MOTIONS.index("moving")]
    assert 3600.0 - max(60.0, interval_s) <= moves.min() <= 3600.0
    assert 3780.0 - interval_s <= moves.max() <= 3780.0 + max(60.0, interval_s)


@pytest.mark.parametrize(("factor", "is_named"), [(1.15, False), (2.0, True)])
def test_a_motor_strays_from_itself_by_as_much_as_its_model_is_known_to_miss(factor: float, is_named: bool) -> None:
    """Pauses and pulses of other lengths make other strokes, which one healthy record does not tell."""
    some = [EFFECTS[name] for name in ("slow-actuator", "limited-travel")]
    before, seen = house(STROKE, seed=2), house(STROKE, effects(slow_actuator={"factor": factor}))
    segment, believed = link(seen, STROKE)
    known = calibrate(before, believed, some)
    whole = SegmentProblem(segment, seen, believed, as_built=known.as_built, parts=np.full(len(seen), FIT))
    found = posterior(Weighing(whole, some, known.healthy[segment.name], 1.0, lambda name: None).weighed())
    assert found["slow-actuator" if is_named else "none"] > 0.8


@pytest.mark.slow
@pytest.mark.skipif(not PAIRS.is_dir(), reason=f"{PAIRS} is not there; WAXSTUDY_DATA names the folder of the data")
def test_a_motor_of_another_form_that_may_as_well_be_as_it_was_has_no_name(tmp_path: Path) -> None:
    """Both records together leave the pace of this motor, an enthalpy model, open from 0.5 to 1.1 times."""
    for name in ("p05", "p05-baseline"):
        shutil.copytree(PAIRS / name, tmp_path / name)
        chain = pd.read_csv(tmp_path / name / "data.csv")[["time", "heating_signal", STROKE]]
        chain.to_csv(tmp_path / name / "data.csv", index=False)
    found = diagnose(tmp_path / "p05", quick=True)
    assert found.verdict == "none"
    assert found.posterior["none"] > 0.8


@pytest.mark.parametrize("channel", [FLOW, STROKE])
def test_where_nothing_changed_nothing_is_found(channel: str) -> None:
    assert later(channel, ())["none"] > 0.8


def test_rest_and_moves_are_told_apart_beside_a_healthy_record_only() -> None:
    seen = house(FLOW)
    segment, believed = link(seen, FLOW)
    known = healthy(FLOW).as_built
    without_link = replace(known, conventions={})
    for as_built, names in ((None, [FLOW]), (without_link, [FLOW]), (known, motions_of(FLOW))):
        problem = SegmentProblem(segment, seen, believed, as_built=as_built)
        found = problem.at((), np.zeros(0), segment.conventions[0])
        assert found
        assert [each.channel for each in found.by_motion] == names


def test_a_motion_is_weighed_by_what_is_left_of_it() -> None:
    """A flow wanders while the valve rests; of its strokes less is left than is chosen."""
    resting, moving = (healthy(FLOW).as_built.left[name].whitened for name in motions_of(FLOW))
    assert moving < 0.5
    assert resting > 1.0


@given(st.lists(st.tuples(st.floats(-3.0, 3.0), st.booleans(), st.integers(0, 1)), min_size=1, max_size=40))
def test_rest_and_moves_add_up_to_the_whole(samples: list[tuple[float, bool, int]]) -> None:
    missed, judged, motion = (np.array(each) for each in zip(*samples, strict=True))
    none = np.zeros(len(missed), dtype=int)
    whole = Residual(FLOW, "L/h", 2.0 * missed, missed, judged, none, none, none, motion=motion)
    assert sum(each.loss() for each in whole.by_motion) == pytest.approx(whole.loss())
    assert sum(each.judged.sum() for each in whole.by_motion) == judged.sum()
    share = dict(zip(motions_of(FLOW), (4.0, 9.0), strict=True))
    weighed = missed * whole.weights(share)
    assert weighed @ weighed == pytest.approx(sum(each.loss() / share[each.channel] for each in whole.by_motion))
