"""What switches are weighed by: noise under the hypothesis that tells when they were thrown, not under a wrong one."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from tests.diagnosis.realities import EFFECTS, Effects, belief, effects, record
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.residuals.switching import Switching
from waxstudy.diagnosis.select.timing import best_timed

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


@pytest.mark.parametrize(("dead_band_K", "as_believed_s"), [(0.46, 1472.0), (0.35, 17.3)])
def test_switches_are_weighed_by_what_noise_does_where_they_are_thrown(
    dead_band_K: float, as_believed_s: float
) -> None:
    """Of peaks that barely reach a wrong threshold noise decides for hours; one that none reaches no noise moves."""
    believed = problem(effects(dead_band={"dead_band_K": dead_band_K}))
    best = best_timed(believed, LIBRARY, 1.0)
    assert best
    ((effect, values),) = best.effects
    assert effect.name == "dead-band"
    assert values["dead_band_K"] == pytest.approx(dead_band_K, abs=0.01)
    assert switches(believed).typical_s == pytest.approx(as_believed_s, rel=0.3)
    assert switches(believed.timed_by(best)).typical_s == pytest.approx(155.0, rel=0.15)


def test_a_loop_as_believed_is_weighed_as_it_is_believed() -> None:
    believed = problem()
    best = best_timed(believed, LIBRARY, 1.0)
    assert best
    assert switches(believed.timed_by(best)).typical_s == pytest.approx(switches(believed).typical_s, rel=0.15)


def test_what_a_switch_drives_and_a_room_have_no_times_to_be_weighed_by() -> None:
    seen = problem().record
    for place, segment in enumerate(segments(seen, problem().belief)):
        if OUTPUT not in segment.judged:
            assert best_timed(problem(stage=place), LIBRARY, 1.0) is None


def test_a_switch_that_no_draw_moved_is_weighed_by_a_share_of_what_they_move_others() -> None:
    way = switches(problem(effects(dead_band={"dead_band_K": 0.42})))
    squares, draws = way._squares, way._draws
    unmoved = squares == 0.0
    assert draws > 30
    assert unmoved.any()
    assert not unmoved.all()
    pooled = np.sqrt(squares.mean() / draws / (draws + 1))
    assert way.scale_s[unmoved] == pytest.approx(max(pooled, way.record.interval_s / np.sqrt(12.0)))
    most = squares.argmax()
    assert way.scale_s[most] == pytest.approx(np.sqrt(squares[most] / draws), rel=0.02)
