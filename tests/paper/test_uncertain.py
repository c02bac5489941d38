"""What nobody knows of a room: each edit starts from what is believed, and never leads to an impossible room."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from waxstudy.plugin import Choice, LinearRoom, Room, Uncertainty
from waxstudy.plugin.shapes import physics_problems, room_problems
from waxstudy_paper.room import NzebRoom, RoomDescription, SurfacesRoom
from waxstudy_paper.room.corner import described
from waxstudy_paper.room.uncertain import moved_share, water_m2K_W

CIRCUITS = {
    "nominal": {},
    "pipe": {"exchange": "pipe"},
    "stated": {"exchange": "stated", "water_to_surface_m2K_W": 0.2},
}
ROOMS = {name: Choice.of(NzebRoom, {"circuit": circuit}) for name, circuit in CIRCUITS.items()}
ROOMS["surfaces"] = Choice(SurfacesRoom, described(ROOMS["nominal"]))


def unknowns(room: Choice) -> dict[str, Uncertainty]:
    assert issubclass(room.component, Room)
    return {unknown.name: unknown for unknown in room.component.uncertainties(room.parameters)}


def built(room: Choice) -> LinearRoom:
    assert issubclass(room.component, Room)
    return room.component.build(room.parameters)


def edited(name: str, departure: float, room: Choice = ROOMS["nominal"]) -> RoomDescription:
    return described(unknowns(room)[name].apply(room, departure))


@pytest.mark.parametrize("room", ROOMS.values(), ids=ROOMS)
def test_about_ten_things_are_uncertain_and_no_departure_is_what_is_believed(room: Choice) -> None:
    found = unknowns(room)
    assert 8 <= len(found) <= 12
    for unknown in found.values():
        assert unknown.sd > 0.0
        assert described(unknown.apply(room, 0.0)) == described(room)


@settings(max_examples=100)
@given(st.data())
def test_any_departures_together_give_a_room_that_is_stable_and_loses_no_heat(data: st.DataObject) -> None:
    room = data.draw(st.sampled_from(list(ROOMS.values())))
    for unknown in unknowns(room).values():
        room = unknown.apply(room, unknown.sd * data.draw(st.floats(-6.0, 6.0)))
    made = built(room)
    assert list(room_problems(made)) == []
    assert list(physics_problems(made)) == []


def measures(room: Choice) -> list[float]:
    """Air and floor at a steady watt of heat to the floor, all capacities, the exchange at full flow."""
    made = built(room)
    steady = made.output_matrix @ np.linalg.solve(made.conductance_W_K, made.floor_heat_share)
    return [*steady[:5], float(made.capacity_J_K.sum()), float(made.floor_conductance_W_K(np.ones(1))[0])]


@pytest.mark.parametrize("name", list(unknowns(ROOMS["nominal"])))
def test_a_small_departure_changes_the_room_by_little_so_that_a_fit_can_follow(name: str) -> None:
    room = ROOMS["stated"]
    assert measures(unknowns(room)[name].apply(room, 1e-4)) == pytest.approx(measures(room), rel=1e-3)


def test_heat_loss_scales_what_a_steady_room_loses() -> None:
    def loss_W_K(room: RoomDescription) -> float:
        made = SurfacesRoom.build(room)
        temperatures = np.linalg.solve(made.conductance_W_K, made.floor_heat_share)
        return 1.0 / float(made.output_matrix[3] @ temperatures)

    assert loss_W_K(edited("heat-loss", np.log(1.2))) == pytest.approx(
        1.2 * loss_W_K(edited("heat-loss", 0.0)), rel=0.01
    )


def test_films_fall_far_and_rise_little() -> None:
    films = [edited("film-floor", departure).films.floor_W_m2K for departure in (-1.0, 0.0, 1.0)]
    assert films == pytest.approx([5.0 * np.exp(-1.0), 5.0, 5.0 * np.exp(0.2)])


def test_the_resistance_from_water_to_surface_stays_when_a_part_of_it_moves_above_the_pipes() -> None:
    rooms = [edited("above-pipes", departure, ROOMS["stated"]) for departure in (-1.0, 0.0, 0.5, 1.5)]
    assert [water_m2K_W(room) + room.above_m2K_W for room in rooms] == pytest.approx([0.2] * 4)
    above = [room.above_m2K_W for room in rooms]
    assert above == sorted(above)
    assert [room.circuit.exchange_factor for room in rooms[1:]] == pytest.approx(np.exp([0.0, 0.5, 1.5]))
    mass = [sum(layer.capacity_J_m2K for layer in room.floor.layers) for room in rooms]
    assert mass == pytest.approx([mass[1]] * 4)


@given(st.floats(0.0, 1.0), st.floats(-20.0, 20.0))
def test_a_moved_share_stays_a_share(share: float, departure: float) -> None:
    assert 0.0 <= moved_share(share, departure) <= 1.0


def test_a_circuit_of_twice_the_exchange_gives_more_heat_at_full_flow() -> None:
    rooms = [Choice.of(NzebRoom, {"circuit": {"exchange_factor": factor}}) for factor in (1.0, 2.0)]
    once, twice = (built(room).floor_conductance_W_K(np.ones(1))[0] for room in rooms)
    assert once < twice < 2.0 * once
