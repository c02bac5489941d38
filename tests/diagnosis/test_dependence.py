"""Claims about `benchmarks.dependence`: what errors of a room go with."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.dependence import followed, gone_with, regressors
from tests.diagnosis.realities import record


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
