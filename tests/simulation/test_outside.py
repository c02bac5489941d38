"""Claims about a room whose own engine owns time: asked before anything runs, and part of what results depend on."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from tests.conftest import SMALL
from tests.simulation import lumped
from tests.simulation.lumped import Elsewhere, Lumped
from waxstudy.conformance import assert_conforms, check
from waxstudy.plugin import BackendMissing, Facade, OutsideRoom, SimulationError, Valve, Weather, WeatherRecord
from waxstudy.plugin.registry import PluginError, Registered, installed
from waxstudy.simulation.run import InputError, prepare, provenance
from waxstudy.study.model import Choice, Study
from waxstudy.study.read import problem_at, read_study
from waxstudy.synthetic.instruments import Instruments
from waxstudy.synthetic.simulate import reality_loop, simulate
from waxstudy.synthetic.write import Telling, truth_of
from waxstudy_paper.valves import LinearValve


class Still(Weather):
    """A day of one temperature, for a test."""

    name = "still"
    api_version = "1.0"
    interval_s: ClassVar[float] = 3600.0
    sky_C: ClassVar[float | None] = None

    @classmethod
    def load(cls, p: Any, facades: dict[str, Facade]) -> WeatherRecord:
        n = round(86400.0 / cls.interval_s)
        sun = {name: np.zeros(n) for name in facades}
        sky_C = None if cls.sky_C is None else np.full(n, cls.sky_C)
        return WeatherRecord(cls.interval_s, "2023-01-01", np.full(n, -3.0), sun, sky_C)


def study_of(path: Path, room: type[OutsideRoom], weather: type[Weather] = Still, step_s: float = 60.0) -> Study:
    path.write_text(SMALL)
    still = {"january": Choice(weather, weather.Parameters())}
    study = read_study(path, installed())
    return replace(study, room=Choice(room, room.Parameters()), weeks=still, step_s=step_s)


def keys(study: Study) -> set[str]:
    return {job.key for job in prepare(study).jobs()}


def test_what_an_engine_cannot_take_is_refused_with_the_key_and_its_value(tmp_path: Path) -> None:
    class Quick(Still):
        interval_s = 1800.0

    path = tmp_path / "small.toml"
    with pytest.raises(InputError, match="must be an hour") as weather:
        prepare(study_of(path, Lumped, Quick))
    with pytest.raises(InputError, match="must be at most 300") as step:
        prepare(study_of(path, Lumped, step_s=600.0))
    places = [(refused.value.table, refused.value.key, refused.value.value) for refused in (weather, step)]
    assert places == [("weather.january", "interval_s", 1800.0), ("study", "step_s", 600.0)]


def test_a_problem_is_told_at_the_line_of_its_key_or_of_the_table_around_it(tmp_path: Path) -> None:
    path = tmp_path / "small.toml"
    path.write_text(SMALL)
    told = [str(problem_at(path, ("weather", "january"), "is wrong", key, 8.0)) for key in ("month", "interval_s")]
    assert told == [
        f"{path}:9: [weather.january] month = 8.0: is wrong",
        f"{path}:7: [weather.january] interval_s = 8.0: is wrong",
    ]


def test_a_missing_engine_is_told_before_any_case_runs(tmp_path: Path) -> None:
    with pytest.raises(BackendMissing, match="pip install lumped"):
        prepare(study_of(tmp_path / "small.toml", lumped.Absent))


def test_an_engine_must_say_which_it_is(tmp_path: Path) -> None:
    with pytest.raises(PluginError, match="ready must return the engine with its version as a text, not ''"):
        prepare(study_of(tmp_path / "small.toml", lumped.Nameless))


def test_results_depend_on_the_engine_s_version_and_on_the_weather_as_it_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study = study_of(tmp_path / "small.toml", Lumped)
    found = [keys(study)]
    assert keys(study) == found[0]
    for where, name, value in ((Lumped, "engine", "Lumped 1.1"), (Still, "sky_C", -9.0), (Still, "sky_C", -8.0)):
        monkeypatch.setattr(where, name, value)
        found.append(keys(study))
    assert len(set.union(*found)) == len(found) * len(study.cases)


def test_provenance_and_the_truth_of_a_dataset_name_the_engine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for component in (Lumped, Still):
        place = (component.kind, component.name)
        monkeypatch.setitem(installed().components, place, Registered(component, "of this test", "1.0"))
    study = study_of(tmp_path / "small.toml", Lumped)
    assert provenance(prepare(study), [])["engine"] == "Lumped 1.0"
    case = study.cases["O_CP"]
    reality = simulate(reality_loop(study, case, ["january"], None), study, 21.0)
    truth = truth_of("a", Telling(study, case, case, ["january"], 21.0), reality, Instruments())
    assert json.loads(json.dumps(truth))["versions"]["engine"] == "Lumped 1.0"


# --- the conformance kit ----------------------------------------------------------------------------


def test_a_room_that_keeps_the_contract_conforms() -> None:
    assert_conforms(Lumped)


BROKEN = {
    lumped.Nameless: ("simulate", "ready must return the engine with its version"),
    lumped.Hurried: ("simulate", "advance was called for the 60 s from 0 s on, where 60 s from -604800 s on were due"),
    lumped.Short: ("simulate", "its record has the shape (1439, 10), (1440, 10) is needed"),
    lumped.Mixed: ("simulate", "columns output, signal, opening, flow_fraction are not what advance returned"),
    lumped.Deaf: ("stop", "ask stop() every few steps"),
    lumped.Swallowing: ("stop", "advance raised a SimulationError and nothing came out"),
}


@pytest.mark.parametrize("room", BROKEN, ids=lambda room: room.__name__)
def test_the_kit_finds_what_an_outside_room_does_wrong(room: type[OutsideRoom]) -> None:
    stage, says = BROKEN[room]
    failed = {outcome.stage: " ".join(outcome.messages) for outcome in check(room) if outcome.status == "failed"}
    assert list(failed) == [stage]
    assert says in failed[stage]


def test_without_the_engine_the_kit_says_what_did_not_run_and_why() -> None:
    outcomes = {outcome.stage: outcome for outcome in check(lumped.Absent)}
    assert (outcomes["simulate"].status, outcomes["stop"].status) == ("not run", "not run")
    assert "pip install lumped" in outcomes["simulate"].messages[0]
    assert "failed" not in {outcome.status for outcome in outcomes.values()}


class Tired(Valve):
    """A valve for a test: it divides by nothing on the second day of the warm-up."""

    name = "tired"
    api_version = "1.0"
    Parameters = LinearValve.Parameters
    State = LinearValve.State
    input, output = LinearValve.input, LinearValve.output

    @staticmethod
    def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
        return u if t < -6 * 86400.0 else u / (u - u)


def test_python_tells_what_machine_code_could_not_of_a_block_that_fails(tmp_path: Path) -> None:
    study = study_of(tmp_path / "small.toml", Elsewhere)
    case = replace(
        study.cases["O_WM"], blocks={**study.cases["O_WM"].blocks, "valve": Choice(Tired, Tired.Parameters())}
    )
    loop = reality_loop(study, case, ["january"], None)
    with pytest.raises(SimulationError, match=r"(?s)valve 'tired' failed at .*ZeroDivisionError.*u / \(u - u\)"):
        simulate(loop, study, 21.0)
