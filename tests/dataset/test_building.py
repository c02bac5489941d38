"""Claims about [building]: numbers as people have them become the parameters of room nzeb."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomli_w
from hypothesis import given
from hypothesis import strategies as st

from tests.study.conftest import COMPONENTS
from waxstudy.dataset.read import Dataset, read_dataset
from waxstudy.plugin import LinearRoom, Parameters, Role, parameter
from waxstudy.plugin.registry import Registry
from waxstudy.study.problems import StudyError
from waxstudy_paper.room import NzebRoom, SurfacesRoom
from waxstudy_paper.room.building import NzebBuilding, parameters_of
from waxstudy_paper.room.corner import NzebParameters, describe

CORNER: dict[str, Any] = {
    "floor_area_m2": 10.4,
    "height_m": 2.6,
    "facade_m": {"south": 4.0, "west": 2.6},
    "window_area_m2": {"south": 3.0, "west": 3.0},
    "window_U_W_m2K": 0.75,
    "window_g": 0.30,
    "wall_U_W_m2K": 0.12,
    "thermal_bridge_W_m2K": 0.031,
    "floor_U_W_m2K": 0.08,
    "screed_W_mK": 1.2,
    "screed_J_m3K": 2.0e6,
    "concrete_J_m3K": 2.07e6,
    "partitions": "adiabatic: gypsum on both sides of wool",
    "pipe": {"outer_mm": 20.0, "wall_mm": 2.0, "spacing_mm": 300.0, "conductivity_W_mK": 0.35},
    "air_capacity_multiplier": 3.2,
    "infiltration_L_s": 0.0048 * (6.6 * 2.6 + 10.4),
    "ventilation_L_s": 5.2,
    "gain_radiant_share": 0.6,
    "nominal_flow_L_h": 122.0,
    "heating_curve_C": [[-22.0, 34.0], [20.0, 22.0]],
}


def of(**changes: Any) -> NzebParameters:
    """The parameters of the corner room with some keys changed; None leaves one out."""
    told = {key: value for key, value in {**CORNER, **changes}.items() if value is not None and key != "partitions"}
    parameters, _ = parameters_of(NzebBuilding.model_validate(told))
    return NzebParameters.model_validate(parameters)


def read(folder: Path, building: dict[str, Any], registry: Registry | None = None) -> Dataset:
    (folder / "data.csv").write_text("time,air_temperature_C\n2020-01-01T00:01:00,21.0\n2020-01-01T00:02:00,21.1\n")
    about = {"nominal": {}, "building": building}
    (folder / "dataset.toml").write_text(tomli_w.dumps(about), encoding="utf-8")
    return read_dataset(folder, registry)


def problems(folder: Path, **changes: Any) -> str:
    with pytest.raises(StudyError) as error:
        read(folder, {**CORNER, **changes})
    return str(error.value).replace(f"{folder}/", "")


def test_the_room_of_table_3_told_in_numbers_is_the_room_of_table_3() -> None:
    ours = describe(NzebParameters(circuit={"exchange": "pipe", "full_flow_L_h": 122.0}))  # type: ignore[arg-type]
    theirs = describe(of())
    assert theirs.air.model_dump() == pytest.approx(ours.air.model_dump())
    assert theirs.model_copy(update={"air": ours.air}) == ours


def steady(room: LinearRoom, supply_C: float) -> dict[str, float]:
    """The room in steady state at 0 C outside, with full flow and nothing else."""
    flow = np.ones(1)
    conductance = float(room.floor_conductance_W_K(flow)[0])
    layer = room.output_matrix[1]
    held = np.zeros(len(room.inputs))
    held[room.places(Role.SUPPLY_AIR)] = 18.0
    # G T = B u + f K (T_supply - T_layer), with T_layer = H T
    matrix = room.conductance_W_K + conductance * np.outer(room.floor_heat_share, layer)
    nodes = np.linalg.solve(matrix, room.input_matrix @ held + conductance * supply_C * room.floor_heat_share)
    layer_C = float(layer @ nodes)
    heat_W = conductance * (supply_C - layer_C)
    stream_W_K = room.full_flow_L_h / 3600.0 * room.water_J_L_K
    warm, cold = supply_C - layer_C, supply_C - heat_W / stream_W_K - layer_C
    return {
        "heat_W_m2": heat_W / room.floor_area_m2,
        "water_C": layer_C + (warm - cold) / np.log(warm / cold),
        "surface_C": float(room.output_matrix[4] @ nodes),
        "layer_C": layer_C,
    }


@given(st.floats(0.05, 0.5))
def test_a_stated_resistance_lies_between_water_and_floor_surface(resistance: float) -> None:
    state = steady(NzebRoom.build(of(water_to_surface_resistance_m2K_W=resistance)), 35.0)
    to_layer = (state["water_C"] - state["layer_C"]) / state["heat_W_m2"]
    assert to_layer + 0.040 / 1.2 == pytest.approx(resistance, rel=1e-6)
    # what goes downwards does not pass the screed above the pipes
    seen = (state["water_C"] - state["surface_C"]) / state["heat_W_m2"]
    assert 0.0 < resistance - seen < 0.15 * 0.040 / 1.2


def test_a_resistance_below_that_of_the_screed_is_refused(tmp_path: Path) -> None:
    said = problems(tmp_path, water_to_surface_resistance_m2K_W=0.03)
    assert "water_to_surface_m2K_W = 0.03 is not above the 0.0333 of the layers over the pipes" in said


def test_closer_pipes_give_more_heat() -> None:
    outputs = [
        steady(NzebRoom.build(of(pipe={"spacing_mm": spacing})), 35.0)["heat_W_m2"] for spacing in (300.0, 200.0, 100.0)
    ]
    assert outputs[0] < outputs[1] < outputs[2]


def test_a_room_with_a_south_facade_only_has_one_outer_wall_and_one_window() -> None:
    room = describe(of(facade_m={"south": 4.0}, window_area_m2={"south": 3.0}, floor_area_m2=16.0))
    outdoors = {surface.name for surface in room.surfaces if surface.boundary == "outdoors"}
    assert outdoors == {"south wall", "floor"}
    assert [window.name for window in room.windows] == ["south window"]
    assert room.floor.area_m2 == pytest.approx(16.0)
    assert sum(part.operative_weight or 0.0 for part in room.parts) == pytest.approx(4.0 * np.pi)
    assert room.air.infiltration_L_s == pytest.approx(CORNER["infiltration_L_s"])
    assert room.air.ventilation_L_s == pytest.approx(5.2)


def test_windows_may_face_any_side() -> None:
    room = describe(of(facade_m={"north": 4.0, "east": 2.6}, window_area_m2={"north": 2.0, "east": 1.0}))
    assert {window.name: window.azimuth_deg for window in room.windows} == {"north window": 0.0, "east window": 90.0}
    assert {s.name for s in room.surfaces if "partition" in s.name} == {"south partition", "west partition"}


def test_a_room_inside_the_house_has_no_outer_wall() -> None:
    room = describe(of(facade_m={}, window_area_m2=None))
    assert room.windows == ()
    assert sum(surface.boundary == "outdoors" for surface in room.surfaces) == 1


@given(st.floats(6.0, 60.0), st.floats(0.8, 1.25))
def test_the_floor_area_is_the_one_told(area: float, misfit: float) -> None:
    south = np.sqrt(area * 1.5)
    assert of(facade_m={"south": south}, window_area_m2=None, floor_area_m2=area).floor_area_m2 == pytest.approx(area)
    west = area / south * misfit
    both = of(facade_m={"south": south, "west": west}, window_area_m2=None, floor_area_m2=area)
    assert both.floor_area_m2 == pytest.approx(area, rel=0.021)


def test_a_floor_that_the_facades_cannot_have_is_refused(tmp_path: Path) -> None:
    assert "floor_area_m2 = 30 contradicts facade_m, which gives 10.4 m2" in problems(tmp_path, floor_area_m2=30.0)
    assert "south and north of a rectangular room are equal" in problems(
        tmp_path, facade_m={"south": 4.0, "north": 3.0, "west": 2.6}
    )


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("window_g", "0.3", 'window_g = "0.3": must be a number'),
        ("wall_U_W_m2K", -0.1, "wall_U_W_m2K = -0.1: must be greater than 0"),
        ("pipe", 3.0, "pipe = 3.0: must be a table"),
        ("pipe", {"outer_cm": 2.0}, "pipe.outer_cm: unknown key; did you mean 'outer_mm'?"),
        ("heating_curve_C", [[20.0, 22.0], [-22.0, 34.0]], "heating_curve_C: outdoor temperatures must rise"),
        ("window_area_m2", {"east": 2.0}, "window_area_m2.east = 2, but east is not among outer_walls"),
        ("window_area_m2", {"south": 12.0}, "window_area_m2.south = 12 does not fit"),
        ("infiltration_L_s", 5000.0, "infiltration_L_s_m2"),
    ],
)
def test_what_cannot_be_is_refused_with_its_line(tmp_path: Path, key: str, value: object, said: str) -> None:
    message = problems(tmp_path, **{key: value})
    assert said in message
    assert message.startswith("dataset.toml:")


def test_a_number_that_is_not_known_is_told_with_the_nearest_key(tmp_path: Path) -> None:
    told = read(tmp_path, {**CORNER, "window_gg": 0.5, "colour": "white"})
    (warning,) = [each for each in told.warnings if "window_gg" in each]
    assert warning.endswith("[building] window_gg is not known and not read; did you mean 'window_g'?")
    assert re.match(r"\S*dataset\.toml:[1-9]\d*: ", warning)
    assert any("not read: partitions, colour" in sentence for sentence in told.assumptions)


def test_what_is_not_told_is_as_in_table_3_and_said(tmp_path: Path) -> None:
    told = read(tmp_path, {"floor_area_m2": 20.0})
    assert told.room is not None
    assert told.room.component is NzebRoom
    assert told.room.parameters.floor_area_m2 == pytest.approx(20.0)  # type: ignore[attr-defined]
    assert any("so as in Table 3: height_m, window_U_W_m2K" in sentence for sentence in told.assumptions)


def test_without_a_room_that_can_be_told_the_user_is_asked_for_one(tmp_path: Path) -> None:
    registry = Registry()
    for component in COMPONENTS:
        registry.add(component, "test", "1")
    with pytest.raises(StudyError, match=r"\[building\]: no room is installed that can be told"):
        read(tmp_path, CORNER, registry)


# --- which room ------------------------------------------------------------------------------------


class Cabin(Parameters):
    """A cabin in words and numbers."""

    floor_area_m2: float = parameter(unit="m2", description="floor area", source="as built", gt=0, le=100)


class CabinRoom(NzebRoom):
    """A stranger's room that can be told in numbers too."""

    name = "cabin"
    Building = Cabin

    @classmethod
    def of_building(cls, building: Cabin) -> tuple[Mapping[str, Any], Sequence[str]]:
        south_m = 4.0
        return {"facade_m": {"south": south_m, "west": building.floor_area_m2 / south_m}}, ["A cabin is 4 m wide."]


def two_rooms() -> Registry:
    registry = Registry()
    for component in (NzebRoom, CabinRoom, SurfacesRoom):
        registry.add(component, "test", "1")
    return registry


@pytest.mark.parametrize(
    ("name", "room", "says"),
    [("cabin", CabinRoom, "A cabin is 4 m wide."), ("nzeb", NzebRoom, "so as in Table 3: height_m, window_U_W_m2K")],
)
def test_the_room_that_is_named_is_built(tmp_path: Path, name: str, room: type[NzebRoom], says: str) -> None:
    told = read(tmp_path, {"use": name, "floor_area_m2": 12.0}, two_rooms())
    assert told.room is not None
    assert told.room.component is room
    assert told.room.parameters.floor_area_m2 == pytest.approx(12.0)  # type: ignore[attr-defined]
    assert f"The room is '{name}' with the numbers of [building]." in told.assumptions
    assert any(says in sentence for sentence in told.assumptions)
    assert not any("not read" in sentence for sentence in (*told.warnings, *told.assumptions))


def test_of_several_rooms_one_must_be_named(tmp_path: Path) -> None:
    with pytest.raises(StudyError) as error:
        read(tmp_path, {"floor_area_m2": 12.0}, two_rooms())
    assert "[building] use: several rooms can be told in words and numbers, and none is named" in str(error.value)
    assert "give one of nzeb, cabin" in str(error.value)


@pytest.mark.parametrize(
    ("use", "near"), [("nzep", "; did you mean 'nzeb'?"), ("surfaces", ""), (3, "")], ids=["a slip", "by [room]", "no"]
)
def test_a_name_that_cannot_be_is_refused(tmp_path: Path, use: object, near: str) -> None:
    with pytest.raises(StudyError) as error:
        read(tmp_path, {"use": use, "floor_area_m2": 12.0}, two_rooms())
    assert f"no room of this name can be told in words and numbers{near}" in str(error.value)
    assert "rooms that can: nzeb, cabin" in str(error.value)
