"""Traces: what a model predicts of a mean stands at the samples of that mean."""

from __future__ import annotations

import numpy as np
import pytest

from waxstudy.diagnosis.model.room_response import merging
from waxstudy.diagnosis.traces import held


@pytest.mark.parametrize(("interval_s", "count"), [(60.0, 20170), (300.0, 2020), (600.0, 1009), (3600.0, 335)])
def test_a_mean_is_held_over_its_own_samples_though_the_last_has_fewer(interval_s: float, count: int) -> None:
    steps, merged = merging(interval_s)
    means = -(-count // (steps * merged))
    found = held(np.arange(means, dtype=float), count, interval_s)
    begins = np.arange(means) * steps * merged
    np.testing.assert_array_equal(found[begins], np.arange(means))
    assert found[steps * merged - 1] == 0.0
    assert len(found) == count


def test_a_prediction_of_every_sample_stays_as_it_is() -> None:
    values = np.linspace(0.0, 1.0, 7)
    assert held(values, 7, 60.0) is values
