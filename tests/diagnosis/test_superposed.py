"""Claims about fits of a room's effects: they begin where its unknowns suit the record."""

from __future__ import annotations

import numpy as np
import pytest

from tests.diagnosis.realities import EFFECTS, belief, dataset, rows
from waxstudy.dataset.stand_ins import SUN
from waxstudy.diagnosis.diagnose import QUICK, record_of
from waxstudy.diagnosis.estimate.estimator import Estimator
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.partition import ALL, FIT
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.superposed import Superposed
from waxstudy.diagnosis.weights import WEIGHTS

DAYS, INTERVAL_S = 7, 300.0


@pytest.mark.slow
def test_no_effect_of_a_room_without_a_sun_misses_clearly_more_than_none() -> None:
    """Many numbers of an unrecorded sun are unknown, and so far from 0 that no straight line leads there."""
    record = record_of(dataset(rows("REAL", DAYS, without=(SUN,), interval_s=INTERVAL_S), "REAL"))
    believed = belief("REAL", record)
    room = next(each for each in segments(record, believed) if each.with_room and not each.is_supply)
    problem = SegmentProblem(room, record, believed, parts=np.full(len(record), FIT))
    estimator = Estimator(problem, QUICK, keeps=True)
    none = estimator.base
    assert np.abs(none.departures / problem.sd).max() > 1.0
    possible = [each for each in EFFECTS.values() if each.stage in room.stages and not each.hindrance(believed)]
    fits = list(Superposed(estimator, none).fits(possible, none, lambda name: None))
    assert len(fits) == len(possible) > 5
    gains = {each.names: 0.5 * (estimator.score(none, ALL) - estimator.score(each, ALL)) for each in fits}
    assert min(gains.values()) > -WEIGHTS.screened_room, gains
