"""Each effect of emitter and room does to the room what its name says."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from tests.effects.believed import EFFECTS, belief, choice, day, response, with_effect, with_inputs
from tests.effects.hut import Hut, Lodge
from waxstudy.conformance import check
from waxstudy.plugin import Belief, Choice, FloatArray, LinearRoom, Room, open_share
from waxstudy_effects.description import description
from waxstudy_effects.emitter import after_pipe_C

HOUR = (np.arange(1440) + 0.5) / 60.0


def end(of: Belief, channel: str) -> float:
    return float(response(of)[channel][-1])


def extra_W(of: Belief) -> FloatArray:
    assert of.inputs
    assert of.inputs.extra_W is not None
    return of.inputs.extra_W


# --- emitter -------------------------------------------------------------------------------------------


def test_max_flow_is_a_factor_on_the_flow_with_the_valve_open() -> None:
    def full(of: Belief) -> float:
        assert of.room
        assert issubclass(of.room.component, Room)
        return of.room.component.build(of.room.parameters).full_flow_L_h

    assert full(with_effect("max-flow", belief(), factor=0.6)) == pytest.approx(0.6 * full(belief()))


def test_a_positive_supply_offset_heats_the_room_more() -> None:
    warmer = with_effect("supply-offset", belief(), offset_K=2.0)
    assert warmer.inputs
    assert (warmer.inputs.supply_C == 34.0).all()
    assert end(warmer, "air_C") > end(belief(), "air_C") + 1.0


def test_a_front_of_warm_water_arrives_when_the_pipe_has_been_filled_anew() -> None:
    front = day(supply_C=np.where(HOUR < 12.0, 25.0, 35.0), air_C=25.0, flow_L_h=60.0)
    arrived_C = after_pipe_C(front, volume_L=10.5)  # ten and a half minutes at 60 L/h
    warm_K = 10.0 * np.exp(-630.0 / 3600.0)
    assert arrived_C[720:730] == pytest.approx(25.0)
    assert arrived_C[730] == pytest.approx(25.0 + 0.5 * warm_K, abs=0.05)  # in the middle of an interval
    assert arrived_C[731:] == pytest.approx(25.0 + warm_K)


def test_a_pipe_that_holds_next_to_nothing_changes_next_to_nothing() -> None:
    rising = day(900.0, supply_C=25.0 + 0.1 * np.arange(96), air_C=25.0, flow_L_h=60.0)
    assert after_pipe_C(rising, volume_L=1e-6) == pytest.approx(rising.supply_C, abs=1e-4)


def test_standing_water_cools_towards_the_room() -> None:
    still = day(supply_C=35.0, air_C=21.0, flow_L_h=np.where((HOUR > 6.0) & (HOUR < 12.0), 0.0, 120.0))
    cooled_C = after_pipe_C(still, volume_L=2.0) - 21.0
    stood = cooled_C[361:719]
    assert (np.diff(stood) < 0.0).all()
    assert stood[300] / stood[240] == pytest.approx(np.exp(-1.0), rel=1e-6)
    assert cooled_C[-1] == pytest.approx(14.0 * np.exp(-60.0 / 3600.0))


def test_pipe_delay_needs_a_recorded_flow() -> None:
    blind = Belief({}, inputs=day())
    assert EFFECTS["pipe-delay"].hindrance(blind) == ""
    assert EFFECTS["pipe-delay"].hindrance(with_inputs(blind, flow_L_h=None)) == "no flow is recorded"


@pytest.mark.parametrize("exchange", ["nominal", "pipe"])
def test_a_floor_cover_keeps_heat_in_the_floor_and_leaves_the_pipes_as_they_are(exchange: str) -> None:
    room = choice("room", {"use": "nzeb", "circuit": {"exchange": exchange}})
    bare = Belief({}, room, day())
    covered = with_effect("floor-cover", bare, resistance_m2K_W=0.1)
    before, after = response(bare), response(covered)
    assert after["floor_surface_C"][-1] < before["floor_surface_C"][-1] - 0.3
    assert after["layer_C"][-1] > before["layer_C"][-1] + 0.1
    flow = np.linspace(0.0, 1.0, 5)
    k = [r.component.build(r.parameters).floor_conductance_W_K(flow) for r in (bare.room, covered.room)]  # type: ignore[union-attr]
    assert k[0] == pytest.approx(k[1])


# --- room ----------------------------------------------------------------------------------------------


def test_infiltration_changes_the_leaks_and_nothing_else_of_the_air() -> None:
    before, leaky = belief(), with_effect("infiltration", belief(), factor=10.0)
    air = description(before).air
    assert description(leaky).air == air.model_copy(update={"infiltration_L_s": 10.0 * air.infiltration_L_s})
    assert end(leaky, "air_C") < end(before, "air_C") - 0.3


def test_an_open_window_takes_the_heat_of_its_air_while_it_is_open() -> None:
    aired = with_effect("window-opening", belief(), flow_L_s=20.0, from_h=7.0, to_h=7.75)
    heat_W = extra_W(aired)
    open_W = 20.0 * 1.206 * (-5.0 - 21.0)
    assert heat_W[(HOUR > 7.0) & (HOUR < 7.75)] == pytest.approx(open_W)
    assert heat_W.sum() * 60.0 == pytest.approx(open_W * 0.75 * 3600.0)


@given(st.floats(0.0, 24.0), st.floats(0.0, 24.0), st.sampled_from([60.0, 900.0, 3600.0]))
@example(0.0, 24.0, 900.0)
@example(14.5, 14.25, 3600.0)  # both ends of the pause within one interval
@example(1e-300, 24.0, 60.0)  # a whole day but for what no number of hours can tell
def test_a_window_is_open_for_as_long_as_its_hours_say_over_midnight_too(
    from_h: float, to_h: float, interval_s: float
) -> None:
    share = open_share(day(interval_s), from_h, to_h)
    lasting_h = to_h - from_h if to_h >= from_h else 24.0 - (from_h - to_h)
    assert share.sum() * interval_s / 3600.0 == pytest.approx(lasting_h, abs=1e-6)
    assert share.min() >= 0.0
    assert share.max() <= 1.0 + 1e-9


def test_a_solar_factor_multiplies_the_sun() -> None:
    sunny = belief(inputs=day(solar_W=np.clip(np.sin((HOUR - 6.0) / 3.8), 0.0, None) * 400.0))
    shaded = with_effect("solar-factor", sunny, factor=0.5)
    assert shaded.inputs
    assert sunny.inputs
    assert shaded.inputs.solar_W == pytest.approx(0.5 * sunny.inputs.solar_W)
    assert response(shaded)["air_C"].max() < response(sunny)["air_C"].max() - 0.3


def test_gains_are_shifted_within_their_day_and_keep_their_sum() -> None:
    evening = belief(inputs=day(gains_W=np.where((HOUR > 18.0) & (HOUR < 20.0), 120.0, 20.0)))
    shifted = with_effect("gain-shift", evening, shift_h=5.0, factor=2.0)
    assert shifted.inputs
    assert evening.inputs
    later = (HOUR > 23.0) | (HOUR < 1.0)
    assert shifted.inputs.gains_W[later] == pytest.approx(240.0)
    assert shifted.inputs.gains_W[~later] == pytest.approx(40.0)
    assert shifted.inputs.gains_W.sum() == pytest.approx(2.0 * evening.inputs.gains_W.sum())


def test_more_thermal_mass_damps_the_swings_and_leaves_the_mean() -> None:
    swinging = belief(inputs=day(solar_W=np.clip(np.sin((HOUR - 6.0) / 3.8), 0.0, None) * 400.0))
    light, heavy = response(swinging)["air_C"], response(with_effect("thermal-mass", swinging, factor=3.0))["air_C"]
    assert np.ptp(heavy) < 0.8 * np.ptp(light)
    assert heavy.mean() == pytest.approx(light.mean(), abs=0.15)


def test_thermal_mass_leaves_the_heated_floor_and_all_resistances() -> None:
    before, after = description(belief()), description(with_effect("thermal-mass", belief(), factor=3.0))
    assert after.floor == before.floor
    for old, new in zip(before.surfaces, after.surfaces, strict=True):
        assert [layer.resistance_m2K_W for layer in new.layers] == [layer.resistance_m2K_W for layer in old.layers]


@pytest.mark.parametrize(("neighbour_C", "heats"), [(None, True), (15.0, False)])
def test_a_warmer_neighbour_heats_and_a_colder_one_cools(neighbour_C: float | None, heats: bool) -> None:
    inputs = day(air_C=19.0) if neighbour_C is None else day(air_C=19.0, neighbour_C=neighbour_C)
    joined = with_effect("neighbour-heat", belief(inputs=inputs), conductance_W_K=5.0)
    assert extra_W(joined) == pytest.approx(5.0 * ((21.0 if neighbour_C is None else 15.0) - 19.0))
    assert (end(joined, "air_C") > end(belief(inputs=inputs), "air_C")) is heats


@given(heat_W=st.floats(-500.0, 2000.0), radiant_share=st.floats(0.0, 1.0))
def test_extra_heat_is_all_there_and_the_share_that_radiates_reaches_surfaces(
    heat_W: float, radiant_share: float
) -> None:
    before = belief()
    after = with_effect("extra-heat", before, heat_W=heat_W, radiant_share=radiant_share)
    assert before.inputs
    assert after.inputs
    gains_W = after.inputs.gains_W - before.inputs.gains_W
    assert gains_W + extra_W(after) == pytest.approx(heat_W)
    assert gains_W * description(before).gains.radiant_share == pytest.approx(heat_W * radiant_share)


def test_heat_that_radiates_warms_the_floor_more_and_the_air_less() -> None:
    fan, panel = (with_effect("extra-heat", belief(), heat_W=200.0, radiant_share=share) for share in (0.0, 1.0))
    assert end(belief(), "air_C") < end(panel, "air_C") < end(fan, "air_C")
    assert end(panel, "floor_surface_C") > end(fan, "floor_surface_C") > end(belief(), "floor_surface_C")


def test_heat_of_several_effects_adds_up() -> None:
    both = with_effect("neighbour-heat", belief(inputs=day(air_C=19.0)), conductance_W_K=5.0)
    both = with_effect("window-opening", both, flow_L_s=1.0, from_h=0.0, to_h=12.0)
    assert extra_W(both)[0] == pytest.approx(10.0 + 1.206 * -24.0)


@pytest.mark.parametrize("name", ["max-flow", "floor-cover", "infiltration", "thermal-mass"])
def test_a_room_that_is_not_made_of_surfaces_says_so(name: str) -> None:
    class Box(Room):
        """A stranger's."""

        name = "box"

        @classmethod
        def build(cls, p: object) -> LinearRoom:
            raise NotImplementedError

    strange = Belief({}, Choice(Box, Box.Parameters()), day())
    assert EFFECTS[name].hindrance(strange) == "this room cannot be described by surfaces"
    assert EFFECTS[name].hindrance(Belief({})) == "no room is believed"


OF_DESCRIPTION = {
    "max-flow": {"factor": 0.5},
    "floor-cover": {"resistance_m2K_W": 0.1},
    "infiltration": {"factor": 8.0},
    "thermal-mass": {"factor": 3.0},
}


def numbers(of: Belief) -> FloatArray:
    """What a room is made of, all in a row."""
    assert of.room
    assert issubclass(of.room.component, Room)
    made = of.room.component.build(of.room.parameters)
    tables = made.capacity_J_K, made.conductance_W_K, made.input_matrix
    return np.concatenate([*(table.ravel() for table in tables), [made.full_flow_L_h]])


@pytest.mark.parametrize("name", OF_DESCRIPTION)
def test_a_stranger_s_room_that_can_be_described_has_the_room_s_effects(name: str) -> None:
    """And stays his: what he has beside the description is kept."""
    theirs = Belief({}, Choice.of(Hut, {"glycol_J_L_K": 3700.0}), day())
    ours = Belief({}, choice("room", {"use": "nzeb"}), day())
    changed, as_ours = (with_effect(name, each, **OF_DESCRIPTION[name]) for each in (theirs, ours))
    assert changed.room
    assert changed.room.component is Hut
    assert changed.room.parameters.glycol_J_L_K == 3700.0  # type: ignore[attr-defined]
    assert numbers(changed) == pytest.approx(numbers(as_ours))
    before = numbers(theirs)
    assert len(before) != len(numbers(changed)) or before != pytest.approx(numbers(changed))


def test_a_description_in_other_words_is_none_of_the_effects() -> None:
    class Tale(Hut):
        """A room that is told as a text."""

        @classmethod
        def description(cls, p: object) -> str:
            return "a hut in the woods"

    told = Belief({}, Choice.of(Tale, {}), day())
    assert EFFECTS["infiltration"].hindrance(told) == "this room cannot be described by surfaces"


def test_the_kit_holds_a_room_against_its_own_description() -> None:
    (kept,) = (each for each in check(Hut) if each.stage == "description")
    (lost,) = (each for each in check(Lodge) if each.stage == "description")
    assert kept.status == "passed"
    says = "of_description, given the room's own description, makes another room: capacity_J_K differ"
    assert (lost.status, lost.messages) == ("failed", [f"example 'default': {says}"])
