"""What switches are weighed by: noise under the hypothesis that tells when they were thrown, not under a wrong one."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from tests.diagnosis.realities import EFFECTS, Effects, belief, effects, record
from waxstudy.diagnosis.model.room_response import Predicted
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.residuals.switching import Switching
from waxstudy.diagnosis.select.timing import best_timed, has_times

LIBRARY = [EFFECTS[name] for name in ("dead-band", "sensor-delay")]
OUTPUT = "control_output"


@cache
def problem(true: Effects = (), stage: int = 0) -> SegmentProblem:
    """A link of an on-off loop that is believed to have a dead band of 0.5 K; the first is up to its controller."""
    seen = record("IDEAL", days=6, effects=true, seed=4)
    believed = belief("IDEAL", seen)
    return SegmentProblem(segments(seen, believed)[stage], seen, believed, parts=np.full(len(seen), FIT))


def switches(judged: SegmentProblem) -> Switching:
    way = judged.judge.ways[OUTPUT]
    assert isinstance(way, Switching)
    return way


def typical_s(judged: SegmentProblem) -> float:
    return float(np.median(switches(judged).scale_s))


@pytest.mark.parametrize(("dead_band_K", "as_believed_s"), [(0.46, 1487.0), (0.35, 17.3)])
def test_switches_are_weighed_by_what_noise_does_where_they_are_thrown(
    dead_band_K: float, as_believed_s: float
) -> None:
    """Of peaks that barely reach a wrong threshold noise decides for hours; one that none reaches no noise moves."""
    believed = problem(effects(dead_band={"dead_band_K": dead_band_K}))
    best, *_ = best_timed(believed, LIBRARY, 1.0)
    ((effect, values),) = best.effects
    assert effect.name == "dead-band"
    assert values["dead_band_K"] == pytest.approx(dead_band_K, abs=0.01)
    assert typical_s(believed) == pytest.approx(as_believed_s, rel=0.1)
    assert typical_s(believed.timed_by([best])) == pytest.approx(137.0, rel=0.15)


def test_a_loop_as_believed_is_weighed_as_it_is_believed() -> None:
    believed = problem()
    best, *_ = best_timed(believed, LIBRARY, 1.0)
    assert typical_s(believed.timed_by([best])) == pytest.approx(typical_s(believed), rel=0.15)


def test_what_a_switch_drives_and_a_room_have_no_times_to_be_weighed_by() -> None:
    links = segments(problem().record, problem().belief)
    timed = {link.name: has_times(problem(stage=place)) for place, link in enumerate(links)}
    assert [name for name, has in timed.items() if has] == [problem().name]
    assert len(timed) > 3


def drawn(off_s: list[float]) -> Switching:
    """What so many draws of noise say, of which each moves all switches by so much but the first, which none moves."""
    seen, segment = problem().record, problem().segment
    still = Predicted({OUTPUT: np.zeros(len(seen))})
    way = Switching(OUTPUT, segment, seen, np.zeros(len(seen)), still)
    first = np.flatnonzero(np.diff(way.windows, prepend=0))
    for each in off_s:
        moved = np.zeros(len(seen))
        moved[first] = each / seen.interval_s
        way.see(Predicted({OUTPUT: moved}))
    return way


def test_a_switch_is_weighed_by_the_root_mean_square_of_what_draws_do_to_it() -> None:
    """Also by what one of many does: a switch that noise seldom throws hours away tells little."""
    assert drawn([30.0, 40.0] * 10).scale_s == pytest.approx(1250.0**0.5)
    assert drawn([60.0] * 19 + [7200.0]).scale_s == pytest.approx(((19 * 60.0**2 + 7200.0**2) / 20) ** 0.5)


def test_no_switch_is_surer_than_most_or_than_sampling_lets_it_be() -> None:
    way = drawn([100.0] * 10)
    assert way.scale_s[0] == way.scale_s[1]
    assert drawn([0.0] * 10).scale_s == pytest.approx(60.0 / np.sqrt(12.0))


def test_switches_that_are_an_exception_cost_what_is_as_likely_anywhere() -> None:
    way = drawn([100.0] * 10)
    none, some, far = (way.likelihood(np.full(len(way.scale_s), each)) for each in (0.0, 60.0, 7200.0))
    assert none > some > far
    assert far == pytest.approx(way.likelihood(np.full(len(way.scale_s), 9000.0)))
