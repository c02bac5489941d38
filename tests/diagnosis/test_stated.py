"""Claims about what rules state: probabilities that sum to one, of what they said and of what they may have missed."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Any, cast

import pytest

from waxstudy.diagnosis.result import Unexplained
from waxstudy.diagnosis.select.search import Selection
from waxstudy.diagnosis.select.stated import stated

OPEN = Unexplained("room", 1.0, 0.1, 0.001)
TRIED = ("let-by", "max-flow", "stuck-open")


def selection(*groups: Sequence[str], is_supply: bool = False) -> Selection:
    named: Any = SimpleNamespace(
        segment=SimpleNamespace(is_supply=is_supply),
        tried=[SimpleNamespace(effect=SimpleNamespace(name=name)) for name in TRIED],
        found=[SimpleNamespace(group=tuple(group)) for group in groups],
    )
    return cast(Selection, named)


@pytest.mark.parametrize("remains", [(), (OPEN,)])
@pytest.mark.parametrize("groups", [(), (("let-by",),), (("let-by", "stuck-open"), ("max-flow",))])
def test_what_rules_state_sums_to_one(groups: Any, remains: Any) -> None:
    told = stated(selection(*groups), remains)
    assert sum(told.values()) == pytest.approx(1.0)
    assert all(0.0 <= each <= 1.0 for each in told.values())


def test_what_is_named_is_the_likeliest_and_its_group_shares_that_evenly() -> None:
    told = stated(selection(("let-by", "stuck-open"), ("max-flow",)), ())
    assert told["let-by+max-flow"] == told["max-flow+stuck-open"] == max(told.values())
    assert stated(selection(("let-by",)), (OPEN,))["let-by+unknown"] > 0.8


def test_where_nothing_is_named_an_effect_may_still_be_there() -> None:
    told = stated(selection(), ())
    assert told["none"] > 0.9
    assert told["let-by"] == told["max-flow"] > 0.0
    assert stated(selection(), (OPEN,))["unknown"] > 0.5


def test_what_would_not_show_counts_at_the_room_and_not_again_at_its_supply() -> None:
    assert stated(selection(is_supply=True), ()) == {"none": 1.0}
    assert stated(selection(is_supply=True), (OPEN,))["unknown"] > 0.5
    assert stated(selection(("supply-offset",), is_supply=True), ())["supply-offset"] > 0.9
