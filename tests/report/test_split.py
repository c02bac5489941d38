"""Claims about what single runs differ by."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from waxstudy.report.comparison import estimate
from waxstudy.report.split import Split

SD = {"start": 1.0, "weather": 2.0, "rest": 0.5}


def drawn(random: np.random.Generator, weathers: int, starts: int, **sd: float) -> np.ndarray:
    of = SD | sd
    of_weather = of["weather"] * random.standard_normal((weathers, 1))
    return (
        of_weather
        + of["start"] * random.standard_normal(starts)
        + of["rest"] * random.standard_normal((weathers, starts))
    )


def test_variances_are_found_without_bias() -> None:
    random = np.random.default_rng(1)
    splits = [Split.of(drawn(random, 8, 8)) for _ in range(2000)]
    for name, sd in SD.items():
        assert np.mean([getattr(split, name) for split in splits]) == pytest.approx(sd**2, rel=0.06)


@pytest.mark.parametrize(("weathers", "starts"), [(4, 16), (16, 4), (6, 6)])
@pytest.mark.parametrize("changed", [{}, {"weather": 0.0}, {"start": 0.0}, {"start": 0.0, "weather": 0.0}])
def test_its_interval_holds_the_mean_of_all_weathers_and_starts(
    weathers: int, starts: int, changed: dict[str, float]
) -> None:
    random = np.random.default_rng(2)
    found = [estimate(drawn(random, weathers, starts, **changed)) for _ in range(1000)]
    assert np.mean([each.low <= 0.0 <= each.high for each in found]) >= 0.935


def test_members_as_if_they_were_independent_would_hold_it_too_seldom() -> None:
    random = np.random.default_rng(3)
    found = [estimate(drawn(random, 4, 16).ravel()) for _ in range(500)]
    assert np.mean([each.low <= 0.0 <= each.high for each in found]) < 0.5


@given(st.integers(2, 6), st.integers(1, 6), st.floats(-10.0, 10.0), st.integers(0, 99))
@example(2, 2, 0.0, 71)  # starts and weathers both differ by less than the rest lets them
@example(4, 3, 0.0, 29)
def test_shares_sum_to_one_and_an_offset_changes_nothing(weathers: int, starts: int, offset: float, seed: int) -> None:
    values = drawn(np.random.default_rng(seed), weathers, starts)
    one, moved = Split.of(values), Split.of(values + offset)
    assert sum(one.share(name) for name in SD) == pytest.approx(1.0)
    assert moved.mean_error == pytest.approx(one.mean_error, rel=1e-6)
    assert 1.0 <= one.runs <= values.size * (1.0 + 1e-9)
    of_mean = one.start / starts + one.weather / weathers + one.rest / values.size
    assert one.mean_error**2 == pytest.approx(of_mean)


def test_runs_that_differ_by_weather_alone_are_worth_one_for_each() -> None:
    split = Split.of(np.repeat([[1.0], [2.0], [4.0]], 5, axis=1))
    assert split.share("weather") == 1.0
    assert split.runs == pytest.approx(3.0)


def test_runs_that_are_all_the_same_have_no_shares() -> None:
    assert np.isnan(Split.of(np.ones((2, 3))).share("start"))
