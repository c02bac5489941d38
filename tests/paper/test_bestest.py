"""The room against ANSI/ASHRAE 140 (BESTEST); the reference data is not part of this repository."""

from __future__ import annotations

import subprocess
import sys
from math import isnan
from pathlib import Path

import numpy as np
import pytest

from benchmarks.bestest import EXTREMES, LOADS, RESULTS, WEATHER, Line, default_folder, figures, lines
from benchmarks.bestest_cases import FLOOR_M2, case
from benchmarks.ideal_air import STEP_S, hold_air
from waxstudy.plugin import LinearRoom, Role, WeatherRecord
from waxstudy_paper.room import SurfacesRoom

HEATING, COOLING, PEAK_HEATING, PEAK_COOLING = LOADS
FREE_FLOAT_K = 3.0
COLD_DAYS = 5


# --- the cases and the ideal heater and cooler, without the data -------------------------------------


def weather(room: LinearRoom, outdoor_C: float) -> WeatherRecord:
    hours = 24 * COLD_DAYS
    dark = {name: np.zeros(hours) for name in room.facades}
    return WeatherRecord(3600.0, "2021-01-01", np.full(hours, outdoor_C), dark, np.full(hours, outdoor_C))


@pytest.mark.parametrize("name", ["600", "900"])
def test_both_rooms_lose_what_their_constructions_say(name: str) -> None:
    room = case(name)
    films = {"wall": 1 / (2.5 + 5.13), "ceiling": 1 / (5.0 + 5.13), "floor": 1 / (0.7 + 5.13)}
    u_values = {
        s.name: 1 / (films[s.facing] + sum(layer.resistance_m2K_W for layer in s.layers) + 0.04) for s in room.surfaces
    }
    # the standard's own films, 8.29 inside and 29.3 outside, give 0.514, 0.318 and 0.039 W/(m2 K)
    assert u_values["south wall"] == pytest.approx(0.514, abs=0.015)
    assert u_values["roof"] == pytest.approx(0.318, abs=0.01)
    assert u_values["floor"] == pytest.approx(0.039, abs=0.0005)
    assert room.air.infiltration_L_s == pytest.approx(0.5 * 129.6 / 3.6 * 0.822)
    assert sum(s.area_m2 for s in room.surfaces) == pytest.approx(2 * FLOOR_M2 + 28 * 2.7 - 12.0)


def test_in_steady_cold_the_heater_gives_what_the_room_loses_and_the_air_stays_at_the_setpoint() -> None:
    room = SurfacesRoom.build(case("600"))
    held = hold_air(room, weather(room, -10.0), lowest_C=20.0, highest_C=27.0)
    assert held.air_C == pytest.approx(np.full(24 * COLD_DAYS, 20.0))
    u = np.array([{Role.GAINS: 200.0, Role.SUN: 0.0}.get(each.role, -10.0) for each in room.inputs])
    u[room.places(Role.SUPPLY_AIR)] = 18.0  # nothing is ventilated
    to_air = np.array([float(name == "air") for name in room.nodes])
    per_W, free_C = np.linalg.solve(room.conductance_W_K, np.column_stack([to_air, room.input_matrix @ u])).T
    air = list(room.nodes).index("air")
    assert held.heat_W[-1] == pytest.approx((20.0 - free_C[air]) / per_W[air], rel=1e-6)


def test_between_the_setpoints_nothing_is_heated_or_cooled_and_heat_is_cooled_away_above() -> None:
    room = SurfacesRoom.build(case("600"))
    mild, hot = (hold_air(room, weather(room, outdoor_C), 20.0, 27.0) for outdoor_C in (20.0, 40.0))
    assert (mild.heat_W == 0.0).all()
    assert (hot.heat_W < 0.0).all()
    assert hot.air_C == pytest.approx(np.full(24 * COLD_DAYS, 27.0))


def test_the_step_of_the_ideal_heater_divides_the_hour() -> None:
    assert 3600.0 % STEP_S == 0.0


def test_without_the_data_the_command_says_what_is_missing_and_where_to_name_it(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "benchmarks.bestest", "--data", str(tmp_path)]
    done = subprocess.run(command, cwd=Path(__file__).parents[2], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr == f"{tmp_path}: no {RESULTS} and no {WEATHER}: say where with --data or WAXSTUDY_DATA\n"


# --- against the reference results -----------------------------------------------------------------


@pytest.fixture(scope="module")
def folder() -> Path:
    folder = default_folder()
    if not (folder / RESULTS).is_file() or not (folder / WEATHER).is_file():
        pytest.skip("no bestest folder with results and weather in WAXSTUDY_DATA")
    return folder


@pytest.fixture(scope="module")
def table(folder: Path) -> dict[tuple[str, str], Line]:
    return {(line.quantity, line.case): line for line in lines(folder)}


@pytest.mark.parametrize("name", ["600", "900"])
def test_annual_heating_is_within_the_acceptance_limits_and_between_the_programs(
    table: dict[tuple[str, str], Line], name: str
) -> None:
    line = table[HEATING, name]
    assert line.lower <= line.ours <= line.upper
    assert line.outside_programs == 0.0


@pytest.mark.parametrize("name", ["600FF", "900FF"])
@pytest.mark.parametrize("quantity", EXTREMES)
def test_free_floating_extremes_are_within_3_K_of_the_programs(
    table: dict[tuple[str, str], Line], quantity: str, name: str
) -> None:
    line = table[quantity, name]
    assert abs(line.outside_programs) <= FREE_FLOAT_K
    assert isnan(line.lower)  # the standard has no limits for them


@pytest.mark.parametrize("name", ["600", "900"])
def test_peak_loads_lie_between_the_programs(table: dict[tuple[str, str], Line], name: str) -> None:
    assert table[PEAK_HEATING, name].outside_programs == 0.0
    assert table[PEAK_COOLING, name].outside_programs == 0.0


def test_annual_cooling_is_within_the_limits_but_for_case_900_which_is_at_most_0_2_MWh_above(
    table: dict[tuple[str, str], Line],
) -> None:
    assert table[COOLING, "600"].outside_limits == 0.0
    assert 0.0 < table[COOLING, "900"].outside_limits < 0.2
    assert table[COOLING, "900"].outside_programs < 0.1


def test_with_the_window_of_the_editions_before_2020_heating_lies_above_every_program(
    folder: Path, table: dict[tuple[str, str], Line]
) -> None:
    before = figures(folder, "600", windows={"U_W_m2K": 3.0, "g": 0.789})
    assert before[HEATING] > table[HEATING, "600"].programs.max() + 0.2
    assert before[PEAK_HEATING] > table[PEAK_HEATING, "600"].programs.max() + 0.1


def test_angle_and_sky_are_what_brings_the_heavy_room_between_the_programs(
    folder: Path, table: dict[tuple[str, str], Line]
) -> None:
    constant_g = figures(folder, "900", windows={"panes": 0})
    warm_sky = figures(folder, "900", films={"sky_W_m2K": 0.0})
    programs = table[COOLING, "900"].programs
    assert constant_g[COOLING] > programs.max() + 1.0
    assert warm_sky[COOLING] > programs.max() + 0.3
    assert warm_sky[HEATING] < table[HEATING, "900"].programs.min()
