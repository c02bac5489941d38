"""Claims about what effects do to a room's inputs: each change reaches the room, or is refused."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from tests.simulation.strange import Strange, without
from tests.synthetic.conftest import SETPOINT_C
from waxstudy.plugin import Belief, Choice, Effect, Inputs, LinearRoom, Parameters, Role, Room
from waxstudy.plugin.registry import PluginError, installed
from waxstudy.study.model import Study
from waxstudy.synthetic.effects import believed_inputs, with_effects
from waxstudy.synthetic.simulate import RealityError, reality_loop, surroundings
from waxstudy_paper.room import NzebRoom


class Gainless(NzebRoom):
    """Its gains have no role, so that no record could be applied to it."""

    name = "gainless"

    @classmethod
    def build(cls, p: Any) -> LinearRoom:
        return without(NzebRoom.build(p), Role.GAINS)


class Unventilated(Strange):
    name = "unventilated"
    made = staticmethod(partial(without, role=Role.SUPPLY_AIR))


class Sunless(Strange):
    name = "sunless"
    made = staticmethod(partial(without, role=Role.SUN))


class Edit(Effect):
    """A stranger's effect, which changes inputs as it likes."""

    name = "edit"
    api_version = "1.0"
    stage = "room"
    Parameters = Parameters
    edits: dict[str, float | None]

    @classmethod
    def apply(cls, belief: Belief, p: Any) -> Belief:
        assert belief.inputs
        shape, scalars = belief.inputs.outdoor_C.shape, ("start_K",)
        edits = {n: v if v is None or n in scalars else np.full(shape, v) for n, v in cls.edits.items()}
        changed: Any = replace(belief.inputs, **edits)  # type: ignore[arg-type]
        return replace(belief, inputs=changed)


def edit(**edits: float | None) -> Choice:
    return Choice.of(type("Edit", (Edit,), {"edits": edits}), {})


def happens(study: Study, room: type[Room], chosen: Choice) -> None:
    own = replace(study, room=Choice.of(room, {}))
    with_effects(own, own.cases["O_0"], ["january"], 1, SETPOINT_C, [chosen])


def inputs_of(study: Study, room: type[Room]) -> Inputs:
    own = replace(study, room=Choice.of(room, {}))
    return believed_inputs(reality_loop(own, own.cases["O_0"], ["january"], 1), SETPOINT_C)


def test_heat_to_surfaces_of_a_room_without_gains_is_refused(study: Study) -> None:
    """Its radiant part is given as gains: the air would lose that part, and no surface would have it."""
    extra = installed().components["effect", "extra-heat"].component
    happens(study, Gainless, Choice.of(extra, {"heat_W": 40.0}))
    wrong = "an effect changes gains_W, which no input of the room takes.*Role.GAINS"
    with pytest.raises(RealityError, match=wrong):
        happens(study, Gainless, Choice.of(extra, {"heat_W": 40.0, "radiant_share": 0.5}))


@pytest.mark.parametrize("air_C", [0.0, 18.0])
def test_supply_air_for_a_room_that_takes_none_is_refused(study: Study, air_C: float) -> None:
    wrong = "an effect changes ventilation_C, which no input of the room takes.*Role.SUPPLY_AIR"
    with pytest.raises(RealityError, match=wrong):
        happens(study, Unventilated, edit(ventilation_C=air_C))


def test_an_input_that_an_effect_leaves_out_is_not_at_0_C(study: Study) -> None:
    with pytest.raises(RealityError, match="an effect leaves out ventilation_C, which the room takes"):
        happens(study, NzebRoom, edit(ventilation_C=None))


@pytest.mark.parametrize("name", ["start_K", "signal", "flow_L_h", "added_flow_L_h"])
def test_what_a_simulated_room_has_from_itself_is_not_to_be_changed(study: Study, name: str) -> None:
    with pytest.raises(RealityError, match=rf"an effect changes {name}, .* \(allowed: .*gains_W.*supply_C\)"):
        happens(study, NzebRoom, edit(**{name: 1.0}))


def test_a_room_whose_sun_has_no_role_is_told_to_give_it_one(study: Study) -> None:
    with pytest.raises(PluginError, match=r"\[room\] with effects: .*no input with the role Role.SUN takes them"):
        happens(study, Sunless, edit(gains_W=1.0))


def test_what_a_room_does_not_take_is_not_recorded_either(study: Study) -> None:
    own = replace(study, room=Choice.of(Gainless, {}))
    assert "internal_gain_W" not in surroundings(reality_loop(own, own.cases["O_0"], ["january"], 1))
    assert not inputs_of(study, Gainless).gains_W.any()  # nothing would take any
    assert inputs_of(study, Unventilated).ventilation_C is None
