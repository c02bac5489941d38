"""Claims about roles: a record drives a room by what its inputs are, whatever they are called and however many."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.simulation.strange import divided, nzeb, renamed, without
from waxstudy.plugin import FloatArray, Inputs, LinearRoom, Role
from waxstudy.simulation.recorded import RECORDED, driven_by, recorded_room, respond, weather_of
from waxstudy_paper.room import NzebRoom

COUNT = 48 * 12  # two days


def recorded(**channels: FloatArray) -> Inputs:
    hour = np.arange(COUNT) / 12.0
    day = np.sin(2.0 * np.pi * hour / 24.0)
    values: dict[str, Any] = {
        "outdoor_C": -3.0 + day,
        "supply_C": 30.0 - day,
        "solar_W": 200.0 * np.clip(day, 0.0, None),
        "gains_W": 50.0 + 30.0 * day,
        "air_C": np.full(COUNT, 21.0),
        "ventilation_C": 17.0 + day,
    }
    return Inputs(300.0, 0.0, **{**values, **channels})


def response(room: LinearRoom, inputs: Inputs) -> FloatArray:
    """Air, operative and floor temperature under a record."""
    found = respond(driven_by(room, inputs), inputs, np.full(COUNT, 60.0))
    return np.array([found[name] for name in ("air_C", "operative_C", "floor_surface_C", "return_C")])


def test_a_room_answers_a_record_alike_whatever_its_inputs_are_called() -> None:
    assert np.array_equal(response(renamed(nzeb()), recorded()), response(nzeb(), recorded()))


@pytest.mark.parametrize(
    ("name", "least_K"), [("solar_W", 0.02), ("gains_W", 0.02), ("outdoor_C", 0.02), ("ventilation_C", 0.02)]
)
def test_each_role_of_a_record_warms_a_stranger_s_room(name: str, least_K: float) -> None:
    plain = recorded()
    warmer = replace(plain, **{name: getattr(plain, name) + 10.0})
    assert np.all(response(renamed(nzeb()), warmer)[0] - response(renamed(nzeb()), plain)[0] > least_K)


@pytest.mark.parametrize("role", [Role.OUTDOOR, Role.SUPPLY_AIR, Role.GAINS])
def test_several_inputs_of_a_role_share_what_was_recorded(role: Role) -> None:
    """Temperatures hold at each, gains are shared out as the means of the room's own."""
    one, two = nzeb(), divided(nzeb(), role)
    assert response(two, recorded()) == pytest.approx(response(one, recorded()), abs=1e-9)
    names = [each.name for each in recorded_room(two, recorded()).inputs]
    assert names.count(RECORDED[role]) == 1


def test_gains_of_a_room_that_has_none_of_its_own_are_shared_out_evenly() -> None:
    room = divided(NzebRoom.build(NzebRoom.Parameters.model_validate({"gains": {"mean_W_m2": 0.0}})), Role.GAINS)
    assert response(room, recorded()) == pytest.approx(response(nzeb(), recorded()), abs=1e-9)


def test_what_no_record_has_stays_as_each_input_of_its_role_had_it() -> None:
    room, inputs = divided(nzeb(), Role.SUPPLY_AIR), recorded(ventilation_C=None)  # type: ignore[arg-type]
    assert response(room, inputs) == pytest.approx(response(nzeb(), inputs), abs=1e-9)
    assert [each.name for each in recorded_room(room, inputs).inputs[-4:]] == ["one", "other", "solar_W", "extra_W"]


def test_a_neighbour_is_as_warm_as_was_recorded() -> None:
    room = nzeb()
    beside = replace(room, inputs=[replace(i, role=Role.NEIGHBOUR) if "ventil" in i.name else i for i in room.inputs])
    neighbour_C = recorded().ventilation_C
    assert neighbour_C is not None
    other = recorded(ventilation_C=neighbour_C + 9.0, neighbour_C=neighbour_C)
    assert response(beside, other) == pytest.approx(response(room, recorded()), abs=1e-9)


@pytest.mark.parametrize(
    ("role", "says"),
    [
        (Role.SUN, "solar gains are recorded, 63.7 W on average, but no input with the role Role.SUN takes them"),
        (Role.GAINS, "internal gains are recorded, 50 W on average, but no input with the role Role.GAINS takes them"),
        (Role.OUTDOOR, "no input has the role Role.OUTDOOR"),
    ],
)
def test_what_was_recorded_and_would_be_lost_is_refused(role: Role, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        recorded_room(without(nzeb(), role), recorded())


def test_sun_through_no_pane_is_lost_too() -> None:
    room = nzeb()
    places = room.places(Role.SUN)
    blind = replace(room, input_matrix=np.where(np.isin(np.arange(len(room.inputs)), places), 0.0, room.input_matrix))
    with pytest.raises(ValueError, match=r"Role\.SUN takes them"):
        recorded_room(blind, recorded())


def test_a_room_without_sun_or_gains_takes_a_record_without_them() -> None:
    dark = recorded(solar_W=np.zeros(COUNT), gains_W=np.zeros(COUNT))
    assert np.isfinite(response(without(without(nzeb(), Role.SUN), Role.GAINS), dark)[0]).all()


def test_names_for_inputs_instead_of_roles_are_refused() -> None:
    names: Any = ["outdoor_C", "gains_W"]
    with pytest.raises(ValueError, match=r"input 'outdoor_C' has no role: give RoomInput\(name, role\)"):
        recorded_room(replace(nzeb(), inputs=names), recorded())


def test_a_stranger_s_room_asks_its_own_drive_for_what_no_record_has() -> None:
    drive = recorded_room(without(renamed(nzeb()), Role.SUPPLY_AIR), recorded()).drive
    own, _ = drive(weather_of(recorded()))
    assert (own[:, 1] == 18.0).all()
