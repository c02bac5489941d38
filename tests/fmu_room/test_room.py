"""A room in an FMU of somebody else: the same as its equations, and every fault of it in words."""

from __future__ import annotations

import time
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import psutil
import pytest

from tests.cli.conftest import Entry, entry
from tests.conftest import SMALL, Waxstudy
from tests.fmu_room.house import CRASH, HANG, INPUTS, NAN, OUTPUTS, STEP_S, SUN, House, write_house
from waxstudy.conformance.outside import Clock, levels
from waxstudy.plugin import TRACE, BackendMissing, Choice, FloatArray, Refused, SimulationError, Stopped, WeatherRecord
from waxstudy.plugin.registry import installed
from waxstudy_fmu import package
from waxstudy_fmu.room import FmuRoom, facade_name

__all__ = ["entry"]

DAY_S = 86_400.0
WARM_STEPS = 7 * 1440
Made = Callable[..., Path]


@pytest.fixture(scope="session")
def house(tmp_path_factory: pytest.TempPathFactory) -> Made:
    known: dict[tuple[int, float], Path] = {}

    def made(fmi: int = 2, trouble: float = 0.0) -> Path:
        if (fmi, trouble) not in known:
            known[fmi, trouble] = write_house(tmp_path_factory.mktemp("house") / "house.fmu", fmi, trouble)
        return known[fmi, trouble]

    return made


def room(path: Path, **changes: Any) -> Choice:
    values = {"path": str(path), "inputs": INPUTS, "outputs": OUTPUTS, "sun": SUN, "floor_area_m2": 20.0, **changes}
    return Choice.of(installed().get("room", "fmu"), values)


def day(choice: Choice) -> WeatherRecord:
    facades = FmuRoom.build(choice.parameters).facades
    hours = np.arange(24.0)
    sun = {name: np.maximum(0.0, 300.0 - 10.0 * (hours - 12.0) ** 2) for name in facades}
    return WeatherRecord(3600.0, "2023-01-01", -5.0 + np.sin(hours), sun)


def record(choice: Choice, stop: Callable[[], bool] = lambda: False) -> FloatArray:
    where: dict[str, Any] = {"setpoint_C": 21.0, "step_s": STEP_S, "air_K": 0.5, "slab_K": -0.5, "stop": stop}
    return FmuRoom.simulate(choice.parameters, day(choice), Clock(STEP_S), **where)


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_record_is_what_the_rooms_equations_give_with_the_chain_at_every_step(house: Made, fmi: int) -> None:
    choice = room(house(fmi))
    found, weather = record(choice), day(choice)
    inputs, supply_C = FmuRoom.build(choice.parameters).drive(weather)
    here, expected = House(21.5, 22.5), []
    for n in range(-WARM_STEPS, 1440):
        hour = int(n * STEP_S % DAY_S // 3600.0)
        given = weather.outdoor_C[hour], inputs[hour, 2], weather.irradiance_W_m2[facade_name("180")][hour]
        flow = levels(n * STEP_S)[3]
        expected.append((*here.step(flow, supply_C[hour], *given), *levels(n * STEP_S)))
    columns = [TRACE.index(n) for n in ("air_C", "layer_C", "water_heat_W", "output", "signal", "opening")]
    there = found[:, [*columns, TRACE.index("flow_fraction")]]
    full_W_K = 140.0 / (FmuRoom.build(choice.parameters).full_flow_L_h / 3600.0 * 4161.0)
    there[:, 2] *= full_W_K  # the FMU's own full flow is another
    np.testing.assert_allclose(there, np.array(expected)[-1440:], rtol=0.0, atol=1e-6)
    assert np.array_equal(found[:, TRACE.index("operative_C")], found[:, TRACE.index("air_C")])


def test_what_results_depend_on_names_the_file_and_what_stands_for_what_it_does_not_give(house: Made) -> None:
    choice = room(house())
    said = FmuRoom.ready(choice.parameters, day(choice), STEP_S)
    assert said.startswith("house.fmu (FMI 2.0, sha256 ")
    assert f"FMPy {fmpy.__version__}, warmed up by time alone; air_C for operative_C; " in said


@pytest.mark.parametrize(
    ("changes", "key", "wrong"),
    [
        ({"inputs": {**INPUTS, "supply_C": "Tsupp"}}, "room.inputs.supply_C", "no such variable"),
        ({"inputs": {**INPUTS, "supply_C": "Tout"}}, "room.inputs.outdoor_C", "variable of supply_C already"),
        ({"inputs": {**INPUTS, "supply_C": "Tair"}}, "room.inputs.supply_C", "is an output variable"),
        ({"inputs": {**INPUTS, "flow": "Qint", "gains_W": "valve"}}, "room.inputs.flow", "is in W in the model"),
        ({"inputs": {**INPUTS, "supply_C": "bare"}}, "room.inputs.supply_C", "has no unit"),
        ({"inputs": {**INPUTS, "wind": "Tsup"}}, "room.inputs.wind", "is no role"),
        ({"inputs": {"outdoor_C": "Tout"}}, "room.inputs", "one of flow and heat_W"),
        ({"outputs": {"layer_C": "Tfloor"}}, "room.outputs", "air_C is needed"),
        ({"outputs": {"air_C": "Tair"}}, "room.outputs", "one of water_heat_W and return_C"),
    ],
)
def test_a_variable_that_the_fmu_does_not_have_so_is_refused_at_its_role(
    house: Made, changes: dict[str, Any], key: str, wrong: str
) -> None:
    choice = room(house(), **changes)
    with pytest.raises(Refused, match=wrong) as refused:
        FmuRoom.ready(choice.parameters, day(choice), STEP_S)
    assert refused.value.key == key


def edited(path: Path, to: Path, old: str, new: str) -> Path:
    """A copy of an FMU with another description or other names of its files."""
    with zipfile.ZipFile(path) as source, zipfile.ZipFile(to, "w") as target:
        for name in source.namelist():
            data = source.read(name)
            text = data.decode().replace(old, new).encode() if name.endswith(".xml") else data
            target.writestr(name.replace(old, new), text)
    return to


@pytest.mark.parametrize(
    ("old", "new", "wrong"),
    [
        ("binaries/linux64", "binaries/win64", "has no library for linux64; it has win64"),
        ("CoSimulation", "ModelExchange", "is not for co-simulation"),
        ("<ModelVariables>", "<", "is no FMU that can be read"),
        ('fmiVersion="2.0"', 'fmiVersion="7.0"', "FMU"),
    ],
)
def test_an_fmu_that_cannot_run_here_is_refused(house: Made, tmp_path: Path, old: str, new: str, wrong: str) -> None:
    choice = room(edited(house(), tmp_path / "other.fmu", old, new))
    with pytest.raises(Refused, match=wrong):
        FmuRoom.ready(choice.parameters, day(choice), STEP_S)


def test_without_fmpy_the_extra_is_named(house: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(package, "find_spec", lambda name: None)
    choice = room(house())
    with pytest.raises(BackendMissing, match=r'pip install "waxstudy\[fmu\]"'):
        FmuRoom.ready(choice.parameters, day(choice), STEP_S)


def processes() -> set[psutil.Process]:
    """What runs below this process; other tests may have left a helper of their own, such as a resource tracker."""
    return {each for each in psutil.Process().children() if each.status() != psutil.STATUS_ZOMBIE}


@pytest.mark.parametrize(
    ("trouble", "wrong"),
    [
        (NAN, "the FMU gave nan for air_C \\(variable Tair\\) at "),
        (HANG, "the FMU did not return from doStep within longest_silence_s = 1 s"),
        (CRASH, "the FMU's process ended by itself"),
    ],
)
def test_an_fmu_that_misbehaves_ends_the_run_in_words_and_leaves_no_process(
    house: Made, trouble: float, wrong: str
) -> None:
    before = processes()
    with pytest.raises(SimulationError, match=wrong):
        record(room(house(trouble=trouble), longest_silence_s=1.0))
    assert processes() <= before


def test_a_run_that_is_asked_to_stop_ends_soon_even_if_the_fmu_never_returns(house: Made) -> None:
    begin, before = time.monotonic(), processes()
    with pytest.raises(Stopped):
        record(room(house(trouble=HANG)), stop=lambda: time.monotonic() - begin > 1.0)
    assert processes() <= before


def study_of(folder: Path, fmu: Path, **changes: Any) -> Path:
    """Write a study of one case in the room of an FMU."""
    given = {"inputs": INPUTS, "outputs": OUTPUTS, "sun": SUN, **changes}
    tables = {name: value for name, value in given.items() if isinstance(value, dict)}
    lines = [f"{name} = {value!r}" for name, value in given.items() if name not in tables]
    lines += [f"{name} = {{ {', '.join(f'{k!r} = {v!r}' for k, v in t.items())} }}" for name, t in tables.items()]
    mine = "\n".join(['use = "fmu"', f'path = "{fmu}"', "floor_area_m2 = 20.0", *lines])
    text = SMALL.replace('use = "nzeb"', mine).replace("members = 2", "members = 1")
    text = text.replace('name = "small"', 'name = "small"\nstep_s = 60.0')
    text = text.replace('"O_WM"', '"O_0"', 1)
    steps = ("O_CP", "O_WM")
    path = folder / "study.toml"
    path.write_text("".join(x for x in text.splitlines(True) if not any(s in x for s in steps)))
    return path


@pytest.mark.slow
def test_a_study_runs_in_the_room_of_an_fmu(house: Made, tmp_path: Path, waxstudy: Waxstudy) -> None:
    write_house(tmp_path / "house.fmu")
    study_of(tmp_path, Path("house.fmu"))
    done = waxstudy("run", "study.toml", "--out", "run")
    assert done.returncode == 0, done.stderr
    assert "house.fmu (FMI 2.0" in (tmp_path / "run" / "run.json").read_text()


INVALID, BACKEND, FAILED = 3, 5, 6


@pytest.mark.parametrize(
    ("old", "new", "changes", "said"),
    [
        ("binaries/linux64", "binaries/win64", {}, "has no library for linux64; it has win64"),
        ("CoSimulation", "ModelExchange", {}, "is not for co-simulation"),
        ("", "", {"inputs": {**INPUTS, "supply_C": "Tsupp"}}, "no such variable"),
        ("", "", {"inputs": {**INPUTS, "supply_C": "bare"}}, "has no unit"),
        ("", "", {"inputs": {**INPUTS, "supply_C": "Tout"}}, "variable of supply_C already"),
    ],
)
def test_the_command_refuses_an_fmu_before_anything_runs(
    house: Made, entry: Entry, tmp_path: Path, old: str, new: str, changes: dict[str, Any], said: str
) -> None:
    fmu = edited(house(), tmp_path / "other.fmu", old, new) if old else house()
    done = entry("run", study_of(tmp_path, fmu, **changes), "--out", "run")
    assert done.code == INVALID
    assert "study.toml:" in done.stderr
    assert said in done.stderr
    assert not (tmp_path / "run").exists()


def test_the_command_names_the_extra_that_is_missing(
    house: Made, entry: Entry, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(package, "find_spec", lambda name: None)
    done = entry("run", study_of(tmp_path, house()), "--out", "run")
    assert done.code == BACKEND
    assert 'pip install "waxstudy[fmu]"' in done.stderr


@pytest.mark.parametrize(
    ("trouble", "said"), [(NAN, "the FMU gave nan for air_C"), (HANG, "did not return from doStep within")]
)
def test_the_command_ends_with_an_fmu_that_fails_and_leaves_nothing_behind(
    house: Made, entry: Entry, tmp_path: Path, trouble: float, said: str
) -> None:
    before = processes()
    done = entry("run", study_of(tmp_path, house(trouble=trouble), longest_silence_s=1.0), "--out", "run")
    assert done.code == FAILED
    assert said in done.stderr
    assert not list(tmp_path.glob("run/cases/*"))
    assert processes() <= before
