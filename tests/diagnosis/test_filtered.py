"""A sensor that is late and one that lags, told apart where noise is as large as what tells them apart."""

from __future__ import annotations

import numpy as np
import pytest

from tests.diagnosis.realities import EFFECTS, belief, dataset, effects, rows
from waxstudy.diagnosis.calibration.calibrate import calibrate
from waxstudy.diagnosis.diagnose import record_of
from waxstudy.diagnosis.model.segments import segments
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.diagnosis.select.posterior import posterior
from waxstudy.diagnosis.select.weigh import Weighing

LIBRARY = [EFFECTS["sensor-delay"], EFFECTS["sensor-lag"]]
LATE = {
    "sensor-delay": {"sensor_delay": {"delay_s": 1400.0}},
    "sensor-lag": {"sensor_lag": {"time_constant_s": 1400.0}},
}


def recorded(true: dict[str, dict[str, float]], seed: int) -> Record:
    data = rows("IDEAL", 6, effects(**true), seed=seed, interval_s=300.0)
    return record_of(dataset(data[["time", "air_temperature_C", "sensor_temperature_C", "control_output"]], "IDEAL"))


@pytest.mark.parametrize("true", LATE)
def test_a_lag_gains_nothing_by_the_noise_that_it_smooths(true: str) -> None:
    healthy, record = recorded({}, 2), recorded(LATE[true], 3)
    known, documented = calibrate(healthy, belief("IDEAL", healthy), LIBRARY), belief("IDEAL", record)
    (sensor,) = segments(record, documented)
    problem = SegmentProblem(sensor, record, documented, as_built=known.as_built, parts=np.full(len(record), FIT))
    weighing = Weighing(problem, LIBRARY, known.healthy[sensor.name], 1.0, lambda name: None)
    beliefs = posterior(weighing.weighed())
    assert beliefs[true] > 0.8
