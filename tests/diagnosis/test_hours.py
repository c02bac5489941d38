"""Hours between which an effect of a room acts: looked for over the whole day, and fitted to minutes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from waxstudy.diagnosis.estimate.solver import MOST_SD, LeastSquares
from waxstudy.diagnosis.select.day import BINS, DAY_H, parts_of_day, promising
from waxstudy.plugin import FloatArray

SAMPLES, NUISANCES = 200, 3
edges = st.integers(0, BINS - 1)


def a_day(seed: int = 1) -> tuple[FloatArray, FloatArray]:
    """Return what an effect does in each part of the day, and what nuisances take, as a basis."""
    random = np.random.default_rng(seed)
    return random.normal(size=(SAMPLES, BINS)), np.linalg.qr(random.normal(size=(SAMPLES, NUISANCES)))[0]


def free(values: FloatArray, basis: FloatArray) -> FloatArray:
    return np.asarray(values - basis @ (basis.T @ values))


def test_the_parts_of_a_day_follow_each_other_round_the_clock() -> None:
    parts = parts_of_day()
    assert len(parts) == BINS
    assert all(end == start for (_, end), (start, _) in zip(parts, parts[1:] + parts[:1], strict=True))


@given(edges, st.integers(1, BINS - 1), st.floats(0.1, 5.0))
@settings(deadline=None)
def test_the_hours_of_what_acted_are_the_most_promising_over_midnight_too(first: int, long: int, strong: float) -> None:
    changes, basis = a_day()
    acted = free(strong * changes[:, np.arange(first, first + long) % BINS].sum(axis=1), basis)
    best = promising(-acted, changes, basis, False, 3)[0]
    assert best.from_h == pytest.approx(first * DAY_H / BINS)
    assert best.to_h == pytest.approx((first + long) % BINS * DAY_H / BINS)
    assert best.gain == pytest.approx(0.5 * acted @ acted)  # all of it would go


def test_what_gives_heat_is_found_only_of_an_effect_that_may() -> None:
    changes, basis = a_day()
    gave = free(changes[:, 10:14].sum(axis=1), basis)
    heater, window = (promising(gave, changes, basis, may, 1)[0] for may in (True, False))
    assert (heater.from_h, heater.to_h) == (5.0, 7.0)
    assert window.gain < 0.5 * heater.gain


def test_spans_worth_a_closer_look_are_not_all_the_same_one() -> None:
    changes, basis = a_day()
    changes = np.cumsum(changes, axis=1)  # neighbours do much the same
    acted = free(changes[:, 20:30].sum(axis=1), basis)
    found = promising(-acted, changes, basis, False, 3)
    assert len(found) == 3
    assert all(not one.is_near(other) for one in found for other in found if one is not other)
    assert found[0].gain >= found[1].gain >= found[2].gain


class Departing:
    """As much of a problem as a step asks for: departures alone."""

    sd = np.ones(NUISANCES)


@given(st.integers(0, 200))
@settings(deadline=None, max_examples=60)
def test_no_step_within_the_bounds_is_better_than_the_one_taken(seed: int) -> None:
    random = np.random.default_rng(seed)
    slopes, missed = random.normal(size=(20, NUISANCES)), 30.0 * random.normal(size=20)
    slopes[:, 1] = slopes[:, 0] + 0.05 * slopes[:, 1]  # two that do nearly the same, as films of a room do
    x = random.uniform(-MOST_SD, MOST_SD, NUISANCES)
    solver = LeastSquares(Departing(), (), None, ())  # type: ignore[arg-type]
    step = solver.step(slopes, missed, 0.0, x)
    assert np.all(np.abs(x + step) <= MOST_SD + 1e-9)
    others = random.uniform(-MOST_SD, MOST_SD, (2000, NUISANCES)) - x
    near = np.clip(x + step + 0.1 * random.normal(size=(2000, NUISANCES)), -MOST_SD, MOST_SD) - x
    left = np.linalg.norm(missed + np.vstack((others, near)) @ slopes.T, axis=1)
    assert np.linalg.norm(missed + slopes @ step) <= left.min() + 1e-6
