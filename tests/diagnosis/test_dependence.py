"""Claims about `benchmarks.dependence`: what errors of a room go with."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.dependence import by_period, followed, gone_with, regressors
from tests.diagnosis.realities import record
from waxstudy.diagnosis.estimate.hypothesis import Residual


@pytest.mark.parametrize("drive", ["sun", "outdoor", "heating"])
def test_errors_that_follow_a_drive_go_with_it_in_another_record_too(drive: str) -> None:
    """And with no other drive alone."""
    one, other = record("REAL", 4), record("WAX", 4)
    count = len(one) // 15
    errors = [2.0 * regressors(each, count)[drive][:, 2] for each in (one, other)]
    known = np.full(count, True)

    def gone(name: str) -> float:
        pairs = [(each, known, regressors(of, count)[name]) for each, of in zip(errors, (one, other), strict=True)]
        return gone_with(*pairs)[1]

    assert gone(drive) > 0.99
    assert all(gone(name) < 0.9 for name in {"sun", "outdoor", "heating", "hour"} - {drive})


def test_what_does_not_change_is_followed_at_once() -> None:
    assert followed(np.full(50, 3.0), 3600.0, 900.0) == pytest.approx(3.0)


def test_white_errors_have_the_same_square_at_every_period_and_a_wave_stands_out_at_its_own() -> None:
    hour, white = 0.25 * np.arange(4000), np.random.default_rng(1).normal(size=4000)
    day, judged, known = (hour // 24.0).astype(int), np.full(4000, True), np.zeros(4000)
    told = [
        by_period(Residual("air_temperature_C", "K", known, values, judged, day, day, day, 1.0), 0.25)
        for values in (white, white + np.sin(2.0 * np.pi * hour / 10.0))
    ]
    assert told[0] == pytest.approx(1.0, abs=0.3)
    assert told[1] / told[0] == pytest.approx([1.0, 1.0, 9.0, 1.0], rel=0.2)  # 1000 h in 125 periods
