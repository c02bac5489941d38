"""Claims about the search for the setpoint shift."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from waxstudy.plugin import FloatArray
from waxstudy.results.comfort import LIMIT_K
from waxstudy.simulation.shift import Shift, solve


@given(st.floats(-2.0, 2.0), st.floats(20.0, 800.0))
def test_a_smooth_curve_is_solved_to_a_quarter_of_an_hour(root_K: float, slope: float) -> None:
    def hours(shift_K: float) -> FloatArray:
        return np.clip(33.0 - slope * (shift_K - root_K) + np.array([-2.0, 2.0]), 0.0, 168.0)

    found = solve(hours, 33.0)
    assert abs(found.hours.mean() - 33.0) <= 0.25


@given(st.floats(-2.0, 2.0))
def test_where_the_curve_jumps_the_nearer_side_is_returned(root_K: float) -> None:
    def hours(shift_K: float) -> FloatArray:
        return np.full(3, 60.0 if shift_K < root_K else 30.0)

    found = solve(hours, 33.0)
    assert found.hours.mean() == 30.0
    assert found.shift_K == pytest.approx(root_K, abs=2e-4)
    assert -30.0 / 0.01 < found.slope_h_K <= 0.0  # of points that are far enough apart to tell


def test_a_target_out_of_reach_ends_at_the_limit() -> None:
    assert solve(lambda shift_K: np.full(2, 100.0 - shift_K), 33.0).shift_K == LIMIT_K
    assert solve(lambda shift_K: np.full(2, 20.0 - shift_K), 33.0).shift_K == -LIMIT_K


def asked_for(curve: Callable[[float], float], **how: float) -> tuple[list[float], Shift]:
    """The shifts that a search looks at, in order, and what it finds."""
    asked: list[float] = []

    def hours(shift_K: float) -> FloatArray:
        asked.append(shift_K)
        return curve(shift_K) + np.array([-1.0, 1.0])

    return asked, solve(hours, 33.0, **how)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_search_goes_away_from_where_it_begins_in_steps_that_double_and_asks_for_no_shift_twice(sign: float) -> None:
    asked, _ = asked_for(lambda shift_K: 33.0 + sign * 100.0 - 100.0 * shift_K)
    assert asked[:5] == pytest.approx([0.0, *(sign * np.array([0.1, 0.3, 0.7, 1.5]))])
    assert all(0.7 <= sign * shift_K <= 1.5 for shift_K in asked[3:])
    assert len(set(asked)) == len(asked)
    asked, _ = asked_for(lambda shift_K: 33.0 + sign * 60.0 - 100.0 * shift_K, near_K=sign * 0.2, step_K=0.15)
    assert asked[:3] == pytest.approx(sign * np.array([0.2, 0.35, 0.65]))


def test_a_target_that_two_steps_just_miss_lies_between_them() -> None:
    asked, found = asked_for(lambda shift_K: 33.3 - 6.0 * shift_K)
    assert (min(asked), max(asked)) == (0.0, 0.1)
    assert abs(found.hours.mean() - 33.0) <= 0.25


def test_what_is_on_target_at_once_has_the_slope_to_the_next_step() -> None:
    asked, found = asked_for(lambda shift_K: 33.2 - 100.0 * shift_K - 50.0 * shift_K**2)
    assert asked == pytest.approx([0.0, 0.1])
    assert (found.shift_K, found.slope_h_K) == (0.0, pytest.approx(-105.0))
    assert found.hours.tolist() == pytest.approx([32.2, 34.2])


def test_a_slope_is_that_to_the_nearest_shift_that_was_looked_at() -> None:
    asked, found = asked_for(lambda shift_K: 33.0 - 100.0 * shift_K - 50.0 * shift_K**2, near_K=-0.3)
    assert asked == pytest.approx([-0.3, -0.2, 0.0])
    assert found.slope_h_K == pytest.approx(-90.0)


@pytest.mark.parametrize(("rise_h_K", "step_K"), [(0.0, 0.1), (50.0, 0.1), (-50.0, 0.005)])
def test_where_no_slope_falls_or_none_is_known_every_run_has_the_same_shift(rise_h_K: float, step_K: float) -> None:
    _, found = asked_for(lambda shift_K: 33.0 + rise_h_K * shift_K, step_K=step_K, near_K=0.0)
    assert found.slope_h_K == 0.0
    assert found.single_run_shifts_K(33.0).tolist() == [0.0, 0.0]


def test_single_runs_would_have_shifted_by_their_own_hours() -> None:
    found = solve(lambda shift_K: 33.0 - 100.0 * shift_K + np.array([-10.0, 10.0]), 33.0)
    assert found.single_run_shifts_K(33.0) == pytest.approx([-0.1, 0.1], abs=0.01)
