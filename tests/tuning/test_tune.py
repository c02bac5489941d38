"""Claims about `waxstudy tune`: it finds better settings, tests them elsewhere, and loses nothing that was finished."""

from __future__ import annotations

import json
import subprocess
import time
import tomllib
from pathlib import Path

import pandas as pd
import pytest

from tests.cli.conftest import Entry
from tests.cli.conftest import entry as entry
from tests.conftest import WAXSTUDY, Waxstudy, call
from tests.simulation.lumped import Lumped
from tests.simulation.test_outside import study_of
from waxstudy.plugin.registry import installed
from waxstudy.simulation.run import Progress
from waxstudy.study.read import read_study
from waxstudy.tuning.evaluate import Evaluator, Weather
from waxstudy.tuning.objectives import Goal, NoObjective

USAGE, INVALID, FAILED = 2, 3, 6
STUDY = """\
[study]
name = "tiny"
step_s = 60

[room]
use = "nzeb"

[weather.january]
use = "tallinn-week"
month = "january"

[weather.february]
use = "tallinn-week"
month = "february"

[ensemble]
members = 1

[ladder.pi]
reference = "P_MC"
start = { id = "P_CP", controller = { use = "pi", gain = 18.0, integration_time_s = 2300.0 } }
steps = [{ id = "P_MC", modulator = { use = "pwm" } }]
"""
TUNE = ("tune", "tiny.toml", "--case", "P_MC", "--workers", "1")


@pytest.fixture
def study(tmp_path: Path) -> Path:
    path = tmp_path / "tiny.toml"
    path.write_text(STUDY)
    return path


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, int]]:
    """A tuning that was killed after some evaluations, and when they were written."""
    folder = tmp_path_factory.mktemp("killed")
    (folder / "tiny.toml").write_text(STUDY)
    command = [str(WAXSTUDY), *TUNE, "--budget", "40", "--out", "tuned"]
    process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and len(written(folder)) < 5:
        time.sleep(0.02)
    process.kill()
    process.wait()
    return folder, written(folder)


def written(folder: Path) -> dict[str, int]:
    return {file.name: file.stat().st_mtime_ns for file in (folder / "tuned" / "evaluations").glob("[!.]*.parquet")}


@pytest.mark.slow
def test_a_killed_tuning_goes_on_finds_better_settings_and_tests_them(killed: tuple[Path, dict[str, int]]) -> None:
    folder, before = killed
    assert 5 <= len(before) < 30
    done = call(folder, *TUNE, "--budget", "40", "--out", "tuned", "--json")
    assert done.returncode == 0, done.stderr
    assert before.items() <= written(folder).items(), "a finished evaluation was computed again"
    found = json.loads(done.stdout)
    assert found == json.loads((folder / "tuned" / "tuning.json").read_text())
    stands, tuned, *others = found["settings"]
    assert stands["name"] == "as it stands (Table 4, adapted)"
    assert [each["name"] for each in others] == ["default", "Ziegler-Nichols", "SIMC", "lambda"]
    assert stands["values"] == {"controller.gain": 18.0, "controller.integration_time_s": 2300.0}
    # the paper's setting is far from what suits a modulated signal
    assert tuned["score"] == min(each["score"] for each in found["evaluations"]) < 0.6
    assert tuned["tuned"]["january"]["mae_K"] < 0.6 * stands["tuned"]["january"]["mae_K"]
    assert set(tuned["tested"]) == {"february"}
    assert tuned["tested_score"] < 1.0
    assert abs(tuned["tuned"]["january"]["hours_below_per_week"] - 33.0) < 1.0
    page = (folder / "tuned" / "report.html").read_text()
    assert "figure-landscape" in page
    assert "Not drawn" not in page
    # a study takes the fragment, and is at the very point that was found
    (folder / "taken.toml").write_text(
        STUDY.replace('use = "pi", gain = 18.0, integration_time_s = 2300.0', 'from = "tuned/tuned.toml"')
    )
    taken = read_study(folder / "taken.toml", installed()).cases["P_MC"].blocks["controller"].described()
    assert {f"controller.{name}": taken[name] for name in ("gain", "integration_time_s")} == tuned["values"]
    assert tomllib.loads((folder / "tuned" / "tuned.toml").read_text())["tuning"]["tested_on"] == "february"


@pytest.mark.parametrize(
    ("options", "code", "told"),
    [
        (["--case", "P_MX"], USAGE, "--case P_MX: there is none; did you mean 'P_MC'?"),
        (["--objective", "trackin"], USAGE, "--objective trackin: there is none; did you mean 'tracking'?"),
        (["--objective", "tracking=-1"], USAGE, "the weight must be a number above 0"),
        (["--week", "march"], USAGE, "--week march: there is none"),
        (["--vary", "controller.gain=5"], USAGE, "is not KEY=LOW..HIGH"),
        (
            ["--vary", "controller.gain=20..30"],
            INVALID,
            "tiny.toml:21: case P_MC: controller.gain = 18.0: lies outside the bounds 20 to 30",
        ),
        (
            ["--vary", "controller.gian=1..30"],
            INVALID,
            "case P_MC: controller.gian: no number among the parameters of this case; did you mean 'controller.gain'?",
        ),
        (["--vary", "controller.gain=1..5000"], INVALID, "the bound 5000 is refused"),
        (["--vary", "controller.tracking_time_s"], INVALID, "declares no bounds for it"),
    ],
)
def test_what_cannot_be_tuned_is_told(
    waxstudy: Waxstudy, study: Path, tmp_path: Path, options: list[str], code: int, told: str
) -> None:
    case = [] if "--case" in options else ["--case", "P_MC"]
    done = waxstudy("tune", "tiny.toml", *case, *options)
    assert (done.returncode, told in done.stderr) == (code, True), done.stderr
    assert not (tmp_path / "results").exists()


def test_a_case_that_has_nothing_of_an_objective_is_told(waxstudy: Waxstudy, study: Path) -> None:
    done = waxstudy("tune", "tiny.toml", "--case", "P_CP", "--objective", "switches")
    assert done.returncode == USAGE
    assert "objective switches: of the case as it stands it is not known; a continuous signal has no switches" in (
        done.stderr
    )


def test_what_a_mild_test_week_cannot_tell_is_a_warning_and_no_tuning_is_lost(
    entry: Entry, study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    refuse, asked = Goal.refuse, []

    def of_the_second(goal: Goal, start: pd.DataFrame) -> None:
        asked.append(start)
        if len(asked) > 1:
            raise NoObjective("objective switches: of the case as it stands it is 0")
        refuse(goal, start)

    monkeypatch.setattr(Goal, "refuse", of_the_second)
    done = entry(*TUNE, "--budget", "40", "--out", "tuned")
    assert (done.code, len(asked)) == (0, 2), done.stderr
    assert "not tested in february: objective switches: of the case as it stands it is 0" in done.stderr
    assert (study.parent / "tuned" / "tuned.toml").is_file()


def test_what_another_version_of_a_room_s_engine_gave_is_not_taken_for_an_evaluation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    study, evaluator = study_of(tmp_path / "small.toml", Lumped), Evaluator("O_CP", tmp_path, 1, Progress())
    first = evaluator._file(study, Weather.of(study, jit=False))
    assert evaluator._file(study, Weather.of(study, jit=False)) == first
    monkeypatch.setattr(Lumped, "engine", "Lumped 1.1")
    assert evaluator._file(study, Weather.of(study, jit=False)) != first


def test_a_folder_of_something_else_is_left_alone(waxstudy: Waxstudy, study: Path, tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    done = waxstudy(*TUNE, "--out", "mine")
    assert (done.returncode, "in use" in done.stderr) == (FAILED, True)


def test_the_loop_of_the_adapted_pi_is_beyond_its_limit(waxstudy: Waxstudy, tmp_path: Path) -> None:
    """Gain 18 is about twice what this room bears with 2300 s: half of it would just swing, with 1.5 h."""
    (tmp_path / "tiny.toml").write_text(STUDY.replace("step_s = 60", "step_s = 5"))
    done = waxstudy("loop", "tiny.toml", "--case", "P_CP", "--week", "january", "--json", "--out", "loops.html")
    assert done.returncode == 0, done.stderr
    (found,) = json.loads(done.stdout)["loops"]
    assert found["stable"] is False
    assert found["gain_margin"] == pytest.approx(0.52, abs=0.03)
    assert found["phase_margin_deg"] == pytest.approx(-17.0, abs=1.5)
    assert found["limit_gain"] == pytest.approx(9.4, abs=0.4)
    assert found["limit_period_h"] == pytest.approx(1.46, abs=0.03)
    assert found["minimum_duty"] < 0.01
    assert "figure-bode" in (tmp_path / "loops.html").read_text()


def test_what_got_worse_is_told_as_more() -> None:
    from waxstudy.report.tuning.tables import _less

    assert [_less(score) for score in (0.7, 1.0, 2.03)] == ["30 % less", "0 % less", "103 % more"]


def test_a_warning_is_told_when_it_comes_and_not_again_below_the_tables() -> None:
    from waxstudy.report.tuning.tables import notes
    from waxstudy.tuning.tune import Setting, Tuned

    stands = Setting("as it stands", {}, 1.0, pd.DataFrame())
    found = Tuned(None, None, None, [], None, 1, 40, [], [stands, stands], ["no weather is left"])  # type: ignore[arg-type]
    assert notes(found) == []
