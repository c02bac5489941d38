"""Claims about fits of a room's effects: they begin where its unknowns suit the record, and within their bounds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.diagnosis.realities import EFFECTS, belief, dataset, rows
from waxstudy.dataset.stand_ins import SUN
from waxstudy.diagnosis.diagnose import record_of
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.estimate.solver import within
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.partition import ALL, FIT
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.superposed import PROMISING, Superposed

DAYS, INTERVAL_S, QUICK = 7, 300.0, 0.25


@given(st.integers(1, 6), st.integers(0, 10_000))
def test_no_step_between_bounds_is_better_than_the_one_taken(count: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    root, best = random.normal(size=(count, count)), 3.0 * random.normal(size=count)
    low, high = -random.uniform(0.0, 2.0, count), random.uniform(0.1, 2.0, count)
    step = within(root, best, low, high)
    assert ((step >= low) & (step <= high)).all()

    def cost(each: np.ndarray) -> float:
        return float(np.sum((root @ (each - best)) ** 2))

    others = random.uniform(low, high, (50, count))
    near = np.clip(step + 1e-3 * random.normal(size=(50, count)), low, high)
    assert cost(step) <= min(cost(each) for each in (*others, *near, np.clip(best, low, high))) + 1e-9


def test_a_best_step_between_bounds_is_taken_as_it_is() -> None:
    best = np.array([0.5, -0.25])
    assert np.array_equal(within(np.eye(2), best, np.full(2, -1.0), np.ones(2)), best)


@pytest.mark.slow
def test_no_effect_of_a_room_misses_more_than_none_however_far_its_unknowns_are_from_what_is_believed() -> None:
    """Of a sun that nobody recorded 58 numbers are unknown; from 0 the best ones are no straight line away."""
    record = record_of(dataset(rows("REAL", DAYS, without=(SUN,), interval_s=INTERVAL_S), "REAL"))
    believed = belief("REAL", record)
    room = next(each for each in segments(record, believed) if each.with_room and not each.is_supply)
    problem = SegmentProblem(room, record, believed, parts=np.full(len(record), FIT))
    estimator = Estimator(problem, QUICK, keeps=True)
    none = estimator.settled(estimator.base)
    assert np.abs(none.departures / problem.sd).max() > 1.0
    possible = [each for each in EFFECTS.values() if each.stage in room.stages and not each.hindrance(believed)]
    fits = list(Superposed(estimator, none).fits(possible, none, lambda name: None))
    assert len(fits) == len(possible) > 5
    gains = {each.names: 0.5 * (estimator.score(none, ALL) - estimator.score(each, ALL)) for each in fits}
    assert min(gains.values()) > -PROMISING, gains
