"""A thermostat that once does not switch where its reading says so, and one whose reading stood where it switches."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import pandas as pd
import pytest

from tests.diagnosis.realities import EFFECTS, SETPOINT_C, belief, dataset
from waxstudy.diagnosis.calibration.calibrate import calibrate
from waxstudy.diagnosis.diagnose import record_of
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.posterior import posterior
from waxstudy.diagnosis.select.thermostat import when_past_switch
from waxstudy.diagnosis.select.weigh import Weighing

LIBRARY = [EFFECTS[name] for name in ("dead-band", "sensor-bias", "sensor-lag")]
MINUTES, HALF_BAND_K = 8 * 1440, 0.25
K_MIN, LAG_MIN = 0.005, 20.0  # how fast the room warms or cools, and how late that turns
HELD = range(3000, 3360)  # minutes


AGAIN = range(7000, 7400)


def recorded(seed: int, held: Sequence[range] = (), stands_K: float | None = None) -> Record:
    """A room that warms while its thermostat is on and cools else; locked off, or standing near where that switches."""
    air_C, is_on, rate_K_min, rows = SETPOINT_C, 0.0, 0.0, []
    random = np.random.default_rng(seed)
    for minute in range(MINUTES):
        edge_C = SETPOINT_C - HALF_BAND_K
        if air_C < edge_C and not any(minute in each for each in held):
            is_on = 1.0
        elif air_C > SETPOINT_C + HALF_BAND_K:
            is_on = 0.0
        rows.append((air_C, air_C, is_on))
        rate_K_min += ((K_MIN if is_on else -K_MIN) - rate_K_min) / LAG_MIN
        air_C += rate_K_min
        if stands_K is not None and minute in HELD and not is_on:
            air_C = max(air_C, edge_C + stands_K)
    values = np.array(rows)
    values[:, :2] += random.normal(0.0, 0.02, (MINUTES, 2))
    time = pd.date_range("2023-01-02 00:01", periods=MINUTES, freq="min").astype(str)
    table = pd.DataFrame(values, columns=["air_temperature_C", "sensor_temperature_C", "control_output"])
    return record_of(dataset(table.assign(time=time), "IDEAL"))


def weighing(record: Record) -> Weighing:
    healthy = recorded(1)
    known, documented = calibrate(healthy, belief("IDEAL", healthy), LIBRARY), belief("IDEAL", record)
    (link,) = segments(record, documented)
    problem = SegmentProblem(link, record, documented, as_built=known.as_built, parts=np.full(len(record), FIT))
    return Weighing(problem, LIBRARY, known.healthy[link.name], 1.0, lambda name: None)


def test_a_switch_past_which_the_reading_went_on_is_something_unknown_at_that_time() -> None:
    locked = weighing(recorded(2, (HELD,)))
    assert posterior(locked.weighed())["unknown"] > 0.9
    when = when_past_switch(locked.problem, locked.none)
    assert when
    assert when.spans_h[0][1] == pytest.approx(HELD.stop / 60.0, abs=0.05)
    words = r"from day 3 0\d:\d\d to 08:0\d, when its reading went on \d.\d K past where it switches"
    assert re.fullmatch(words, when.pattern)


def test_each_time_that_a_reading_went_on_is_told() -> None:
    twice = weighing(recorded(2, (HELD, AGAIN)))
    when = when_past_switch(twice.problem, twice.none)
    assert when
    assert [end for _, end in when.spans_h] == pytest.approx([HELD.stop / 60.0, AGAIN.stop / 60.0], abs=0.1)
    words = (
        r"from day 3 0\d:\d\d to 08:0\d, from day 6 00:\d\d to 03:2\d, when its reading went on up to \d.\d K past .*"
    )
    assert re.fullmatch(words, when.pattern)


@pytest.mark.parametrize("stands_K", [None, 0.02, 0.005])
def test_a_switch_that_noise_throws_by_hours_is_not(stands_K: float | None) -> None:
    standing = weighing(recorded(2, stands_K=stands_K))
    assert posterior(standing.weighed())["none"] > 0.8
    assert when_past_switch(standing.problem, standing.none) is None
