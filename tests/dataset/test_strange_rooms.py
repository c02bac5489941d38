"""Claims about datasets of a stranger's room: by its roles it is recorded, and what it lacks is refused or told."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest
import tomli_w

from tests.simulation.strange import InParts, Strange, without
from tests.synthetic.conftest import SETPOINT_C
from waxstudy.dataset.read import Dataset, read_dataset
from waxstudy.plugin import Choice, FloatArray, ModelError, Role, Room
from waxstudy.plugin.model_error import DOUBLED
from waxstudy.plugin.registry import Registry, installed
from waxstudy.simulation.engine import Loop
from waxstudy.study.model import Study
from waxstudy.study.problems import StudyError
from waxstudy.synthetic.effects import believed_inputs, with_effects
from waxstudy.synthetic.simulate import reality_loop, surroundings
from waxstudy_paper.room import NzebRoom

MODES_K = 0.005  # what the fewer modes of a room may leave: other inputs are reduced to other modes


def loop_of(study: Study, room: type[Room]) -> Loop:
    own = replace(study, room=Choice.of(room, {}))
    loop = reality_loop(own, own.cases["O_0"], ["january"], 1)
    assert isinstance(loop, Loop)
    return loop


@pytest.mark.parametrize("room", [Strange, InParts])
def test_a_stranger_s_room_shows_what_drives_it(study: Study, room: type[Room]) -> None:
    seen, ours = surroundings(loop_of(study, room)), surroundings(loop_of(study, NzebRoom))
    assert list(seen) == list(ours)
    assert {"internal_gain_W", "ventilation_supply_C"} < set(seen)
    for name, values in ours.items():
        assert seen[name] == pytest.approx(values, abs=1e-9), name
    inputs = believed_inputs(loop_of(study, room), SETPOINT_C)
    assert inputs.gains_W.mean() == pytest.approx(4.0 * 10.4, rel=1e-3)
    assert inputs.ventilation_C == pytest.approx(18.0)


@pytest.mark.parametrize(("room", "off_K"), [(Strange, 1e-9), (InParts, MODES_K)])
@pytest.mark.parametrize(("name", "values"), [("gain-shift", {"factor": 3.0}), ("window-opening", {"flow_L_s": 20.0})])
def test_effects_on_what_drives_it_reach_a_stranger_s_room(
    study: Study, room: type[Room], off_K: float, name: str, values: dict[str, float]
) -> None:
    chosen = [Choice.of(installed().components["effect", name].component, values)]

    def air_C(each: type[Room]) -> FloatArray:
        own = replace(study, room=Choice.of(each, {}))
        return with_effects(own, own.cases["O_0"], ["january"], 1, SETPOINT_C, chosen)[1].week.channels["air_C"]

    assert air_C(room) == pytest.approx(air_C(NzebRoom), abs=off_K)


# --- reading ---------------------------------------------------------------------------------------


class Sunless(Strange):
    """Its author has overlooked the sun."""

    name = "sunless"
    made = staticmethod(partial(without, role=Role.SUN))


class Unventilated(Strange):
    """And here the supply air."""

    name = "unventilated"
    made = staticmethod(partial(without, role=Role.SUPPLY_AIR))


class Named(Strange):
    """And here all roles."""

    name = "named"
    made = staticmethod(lambda room: replace(room, inputs=[f"u{n}" for n, _ in enumerate(room.inputs)]))


def read(folder: Path, believed: dict[str, Any], *channels: str, value: float = 5.0) -> Dataset:
    rows = [f"2020-01-01T00:{minute:02d}:00,21.0{f',{value}' * len(channels)}\n" for minute in range(1, 20)]
    (folder / "data.csv").write_text(f"{','.join(['time', 'air_temperature_C', *channels])}\n{''.join(rows)}")
    (folder / "dataset.toml").write_text(tomli_w.dumps({"nominal": {}, **believed}))
    registry = Registry()
    for room in (NzebRoom, Strange, Sunless, Unventilated, Named, Boastful):
        registry.add(room, "test", "1")
    return read_dataset(folder, registry)


def test_a_record_with_sun_of_a_room_without_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StudyError) as error:
        read(tmp_path, {"room": {"use": "sunless"}}, "solar_gain_W")
    assert "[room]: solar gains are recorded, 5 W on average, but no input with the role Role.SUN" in str(error.value)
    assert "leave them out of the record, or give a room that takes them" in str(error.value)


def test_the_same_of_a_building_without_windows(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match=r"\[building\]: solar gains are recorded"):
        read(tmp_path, {"building": {"floor_area_m2": 12.0, "facade_m": {"south": 4.0}}}, "solar_gain_W")


def test_a_sun_that_never_shone_is_no_loss(tmp_path: Path) -> None:
    assert read(tmp_path, {"room": {"use": "sunless"}}, "solar_gain_W", value=0.0).room


def test_supply_air_that_a_room_does_not_take_is_told(tmp_path: Path) -> None:
    channel = "ventilation_supply_temperature_C"
    told = f"{channel} is not used: no input of the room has the role Role.SUPPLY_AIR"
    assert told in read(tmp_path, {"room": {"use": "unventilated"}}, channel).warnings
    assert told not in read(tmp_path, {"room": {"use": "strange"}}, channel).warnings


def test_a_room_that_names_its_inputs_only_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match=r"room 'named': input 'u0' has no role: give RoomInput"):
        read(tmp_path, {"room": {"use": "named"}})


# --- the error of its model ------------------------------------------------------------------------


class Boastful(Strange):
    """Its author is wrong about its error."""

    name = "boastful"

    @classmethod
    def model_errors(cls, p: Any) -> Mapping[str, ModelError]:
        return {"air_C": ModelError(0.0, 0.0, "none")}


def test_what_is_assumed_of_a_room_that_states_no_error_is_said(tmp_path: Path) -> None:
    told = read(tmp_path, {"room": {"use": "strange"}})
    (said,) = (each for each in told.assumptions if "states no error" in each)
    assert said.startswith("Room 'strange' states no error of its model; assumed is 0.14 K of air_C (at most 0.36 K), ")
    assert said.endswith(f"{DOUBLED}.")
    assert not any("error" in each for each in read(tmp_path, {"room": {"use": "nzeb"}}).assumptions)


def test_a_dataset_may_widen_the_error_of_its_room_and_nothing_else_does(tmp_path: Path) -> None:
    factors = [
        read(tmp_path, {"dataset": about, "room": {"use": "nzeb"}}).believed(None).room_error_factor
        for about in ({}, {"room_tolerance": 4.0}, {"room_error_factor": 1.5})
    ]
    assert factors == [1.0, 1.0, 1.5]
    wider = read(tmp_path, {"dataset": {"room_error_factor": 1.5}, "room": {"use": "nzeb"}})
    assert "The error of the room's model is taken 1.5 times, as [dataset] room_error_factor says." in wider.assumptions
    with pytest.raises(StudyError, match=r"room_error_factor = 0\.5: must be at least 1"):
        read(tmp_path, {"dataset": {"room_error_factor": 0.5}, "room": {"use": "nzeb"}})


def test_an_error_that_cannot_be_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match=r"room 'boastful': model_errors: air_C needs 0 < typical_K"):
        read(tmp_path, {"room": {"use": "boastful"}})
