"""Claims about the error of a room's model: the room states it, and one that does not is taken for worse."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import pytest

from waxstudy.conformance import check
from waxstudy.plugin import Choice, LinearRoom, ModelError, Room
from waxstudy.plugin.model_error import ASSUMED, model_errors
from waxstudy.plugin.registry import installed
from waxstudy_paper.room import NzebRoom

FLOOR = ModelError(0.05, 0.1, "held against a test room of two summers")


class Silent(Room):
    """A stranger's, who says nothing of its error."""

    name = "silent"
    api_version = "1.0"

    @classmethod
    def build(cls, p: Any) -> LinearRoom:
        return NzebRoom.build(NzebRoom.Parameters())


class Partly(Silent):
    """And one whose author has looked at the floor."""

    name = "partly"

    @classmethod
    def model_errors(cls, p: Any) -> Mapping[str, ModelError]:
        return {"floor_surface_C": FLOOR}


@pytest.mark.parametrize("name", ["nzeb", "surfaces", "nzeb-energyplus", "surfaces-energyplus"])
def test_our_rooms_state_what_other_engines_differ_by(name: str) -> None:
    component = installed().components["room", name].component
    found = model_errors(Choice.of(component, next(iter(component.examples.values()))))
    assert {output: (error.typical_K, error.most_K) for output, error in found.items()} == {
        "air_C": (0.07, 0.18),
        "operative_C": (0.07, 0.18),
        "floor_surface_C": (0.08, 0.16),
        "return_C": (0.15, 0.5),
    }
    assert all("another engine" in error.source for error in found.values())


def test_of_a_room_that_states_none_twice_as_much_is_assumed() -> None:
    ours = model_errors(Choice.of(NzebRoom, {}))
    assumed = model_errors(Choice.of(Silent, {}))
    assert assumed == ASSUMED
    for output, error in assumed.items():
        assert (error.typical_K, error.most_K) == pytest.approx((2 * ours[output].typical_K, 2 * ours[output].most_K))


def test_what_a_room_states_stands_beside_what_is_assumed_of_the_rest() -> None:
    assert model_errors(Choice.of(Partly, {})) == {**ASSUMED, "floor_surface_C": FLOOR}


@pytest.mark.parametrize(
    ("stated", "says"),
    [
        ({"floor_C": FLOOR}, "'floor_C' is not judged; outputs are air_C, operative_C, floor_surface_C, return_C"),
        ({"air_C": 0.1}, "that of air_C is 0.1, not a ModelError(typical_K, most_K, source)"),
        ({"air_C": replace(FLOOR, most_K=0.01)}, "air_C needs 0 < typical_K <= most_K, not 0.05 and 0.01"),
        ({"air_C": replace(FLOOR, source=" ")}, "air_C has no source: say what the model was held against"),
        (None, "model_errors must give a table of outputs and ModelErrors"),
    ],
)
def test_the_kit_says_what_is_wrong_with_a_stated_error(stated: Any, says: str) -> None:
    class Wrong(Silent):
        """Made for a test."""

        @classmethod
        def model_errors(cls, p: Any) -> Mapping[str, ModelError]:
            found: Mapping[str, ModelError] = stated
            return found

    (outcome,) = (each for each in check(Wrong) if each.stage == "model-errors")
    assert outcome.status == "failed"
    assert says in outcome.messages[0]
    assert {each.status for each in check(Partly)} == {"passed"}
