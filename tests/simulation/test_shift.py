"""Claims about the search for the setpoint shift."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from waxstudy.plugin import FloatArray
from waxstudy.results.comfort import LIMIT_K
from waxstudy.simulation.shift import solve


@given(st.floats(-2.0, 2.0), st.floats(20.0, 800.0))
def test_a_smooth_curve_is_solved_to_half_an_hour(root_K: float, slope: float) -> None:
    def hours(shift_K: float) -> FloatArray:
        return np.clip(33.0 - slope * (shift_K - root_K) + np.array([-2.0, 2.0]), 0.0, 168.0)

    found = solve(hours, 33.0)
    assert abs(found.hours.mean() - 33.0) <= 0.5


@given(st.floats(-2.0, 2.0))
def test_where_the_curve_jumps_the_nearer_side_is_returned(root_K: float) -> None:
    def hours(shift_K: float) -> FloatArray:
        return np.full(3, 60.0 if shift_K < root_K else 30.0)

    found = solve(hours, 33.0)
    assert found.hours.mean() == 30.0
    assert found.shift_K == pytest.approx(root_K, abs=0.01)


def test_a_target_out_of_reach_ends_at_the_limit() -> None:
    assert solve(lambda shift_K: np.full(2, 100.0 - shift_K), 33.0).shift_K == LIMIT_K
    assert solve(lambda shift_K: np.full(2, 20.0 - shift_K), 33.0).shift_K == -LIMIT_K


def test_single_runs_would_have_shifted_by_their_own_hours() -> None:
    found = solve(lambda shift_K: 33.0 - 100.0 * shift_K + np.array([-10.0, 10.0]), 33.0)
    assert found.single_run_shifts_K(33.0) == pytest.approx([-0.1, 0.1], abs=0.01)
