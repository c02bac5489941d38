"""What makes an average over all orders a fair share: the axioms, with and without steps that must keep their order."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from waxstudy.plugin import FloatArray
from waxstudy.report.attribution.shapley import Placement, Subset, closed_sets, order_count, placements, shapley
from waxstudy.report.attribution.shares import difference

MEMBERS = 3
Values = Mapping[Subset, FloatArray]


@st.composite
def orders(draw: st.DrawFn) -> list[Subset]:
    """Up to five steps, some of which must stay after earlier ones."""
    n = draw(st.integers(1, 5))
    return [frozenset(i for i in range(j) if draw(st.booleans()) and draw(st.booleans())) for j in range(n)]


@st.composite
def games(draw: st.DrawFn) -> tuple[list[Subset], Values]:
    """Steps, and a figure of each member for every set of them that makes sense."""
    needs = draw(orders())
    return needs, draw(values_for(needs))


def values_for(needs: Sequence[Subset]) -> st.SearchStrategy[Values]:
    figures = st.lists(st.floats(-100.0, 100.0), min_size=MEMBERS, max_size=MEMBERS).map(np.array)
    return st.fixed_dictionaries({chosen: figures for chosen in closed_sets(needs)})


def shares(values: Values) -> dict[int, FloatArray]:
    return shapley(placements(list(values)), values)


def by_every_order(needs: Sequence[Subset], values: Values) -> dict[int, FloatArray]:
    """The definition: the mean of what each step adds over every order that keeps what must be kept."""
    steps = range(len(needs))
    kept = [order for order in permutations(steps) if all(needs[s] <= set(order[: order.index(s)]) for s in steps)]
    total = {step: np.zeros(MEMBERS) for step in steps}
    for order in kept:
        for place, step in enumerate(order):
            before = frozenset(order[:place])
            total[step] += values[before | {step}] - values[before]
    return {step: value / len(kept) for step, value in total.items()}


@given(games())
def test_shares_are_the_mean_over_every_order_that_keeps_what_must_be_kept(game: tuple[list[Subset], Values]) -> None:
    needs, values = game
    expected = by_every_order(needs, values)
    found = shares(values)
    assert list(found) == list(expected)
    for step in expected:
        assert found[step] == pytest.approx(expected[step], abs=1e-9)


@given(games())
def test_efficiency_the_shares_sum_to_the_total_difference(game: tuple[list[Subset], Values]) -> None:
    needs, values = game
    everything = frozenset(range(len(needs)))
    assert sum(shares(values).values()) == pytest.approx(values[everything] - values[frozenset()], abs=1e-9)


@given(games(), st.data())
def test_additivity_the_shares_in_a_sum_are_the_sums_of_the_shares(
    game: tuple[list[Subset], Values], data: st.DataObject
) -> None:
    needs, values = game
    other = data.draw(values_for(needs))
    both, one, two = shares({s: values[s] + other[s] for s in values}), shares(values), shares(other)
    for step in both:
        assert both[step] == pytest.approx(one[step] + two[step], abs=1e-9)


@given(games(), st.data())
def test_a_dummy_step_that_adds_the_same_everywhere_has_that_as_its_share(
    game: tuple[list[Subset], Values], data: st.DataObject
) -> None:
    needs, _ = game
    dummy = data.draw(st.integers(0, len(needs) - 1))
    needs = [frozenset() if step == dummy else before - {dummy} for step, before in enumerate(needs)]
    adds = data.draw(st.sampled_from([0.0, 4.0]))
    free = {chosen: data.draw(st.integers(-64, 64)) for chosen in closed_sets(needs) if dummy not in chosen}
    with_it = {s: np.full(MEMBERS, free[s - {dummy}] + adds * (dummy in s)) for s in closed_sets(needs)}
    assert shares(with_it)[dummy] == pytest.approx(np.full(MEMBERS, adds), abs=1e-12)
    if adds == 0.0:
        assert (shares(with_it)[dummy] == 0.0).all()


@given(st.integers(2, 5), st.data())
def test_symmetry_steps_that_add_the_same_to_every_set_share_alike(n: int, data: st.DataObject) -> None:
    def renamed(chosen: Subset) -> Subset:
        return frozenset({0: 1, 1: 0}.get(step, step) for step in chosen)

    drawn = data.draw(values_for([frozenset()] * n))
    values = {chosen: drawn[chosen] + drawn[renamed(chosen)] for chosen in drawn}
    assert shares(values)[0] == pytest.approx(shares(values)[1], abs=1e-9)


@given(st.integers(1, 6))
def test_where_every_set_makes_sense_the_weights_are_shapley_s(n: int) -> None:
    family = closed_sets([frozenset()] * n)
    places = placements(family)
    assert len(family) == 2**n
    assert order_count(family) == math.factorial(n)
    assert len(places) == n * 2 ** (n - 1)
    for place in places:
        size = len(place.after)
        assert place.weight == math.factorial(size) * math.factorial(n - size - 1) / math.factorial(n)


def test_a_step_that_needs_another_never_comes_before_it() -> None:
    family = closed_sets([frozenset(), frozenset({0}), frozenset()])
    assert order_count(family) == 3
    assert all(0 in place.after for place in placements(family) if place.step == 1)


def test_a_chain_of_needs_leaves_the_ladder_s_own_order() -> None:
    family = closed_sets([frozenset(range(step)) for step in range(4)])
    assert placements(family) == [Placement(frozenset(range(step)), step, 1.0) for step in range(4)]


def test_a_set_that_is_missing_takes_its_orders_away() -> None:
    family = [chosen for chosen in closed_sets([frozenset()] * 3) if chosen != frozenset({2})]
    assert order_count(family) == 4
    assert sum(place.weight for place in placements(family) if place.step == 2) == pytest.approx(1.0)


def test_steps_that_do_not_lead_on_are_refused() -> None:
    with pytest.raises(ValueError, match="no order of the steps"):
        placements([frozenset(), frozenset({0, 1})])


@given(games())
def test_a_step_s_share_lies_between_the_least_and_the_most_that_it_adds(game: tuple[list[Subset], Values]) -> None:
    needs, values = game
    found = difference("mae_K", [str(step) for step in range(len(needs))], placements(list(values)), values)
    for share in found.shares:
        assert share.least - 1e-9 <= share.order_free.mean <= share.most + 1e-9
        assert share.least - 1e-9 <= share.in_ladder.mean <= share.most + 1e-9
        place = share.in_ladder.mean - share.order_free.mean
        assert share.of_its_place.mean == pytest.approx(place, abs=1e-9)
    assert abs(found.remainder) < 1e-9
