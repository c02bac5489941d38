"""`waxstudy reality` as a user calls it."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pandas as pd
import pytest

from tests.cli.conftest import Entry
from tests.cli.folders import contents

USAGE, INVALID, FAILED = 2, 3, 6


def test_it_prints_where_the_truth_and_the_dataset_are(entry: Entry, small_study: Path) -> None:
    done = entry("reality", small_study, "--case", "O_WM", "--believed", "O_CP", "--days", 1, "--out", "data/room-7")
    assert (done.code, done.stderr) == (0, "")
    assert done.stdout.splitlines() == ["data/room-7-truth.json", "data/room-7"]
    assert len(pd.read_csv("data/room-7/data.csv")) == 1440
    assert json.loads(Path("data/room-7-truth.json").read_text())["steps"] == ["O_WM"]


def test_json_is_all_that_is_printed(entry: Entry, small_study: Path) -> None:
    done = entry("reality", small_study, "--case", "O_0", "--days", 1, "--out", "room", "--json")
    assert json.loads(done.stdout) == {"dataset": "room", "truth": "room-truth.json"}


def test_options_reach_the_instruments(entry: Entry, small_study: Path) -> None:
    options = ("--interval-s", 600, "--missing", 0.25, "--setpoint-shift", -0.5, "--without", "flow_L_h")
    figures = ("--noise", "air_temperature_C=0", "--resolution", "air_temperature_C=0.5", "--without", "displacement")
    weeks = ("--week", "january", "--week", "january", "--days", 9)
    done = entry("reality", small_study, "--case", "O_0", *weeks, *options, *figures, "--out", "room")
    assert done.code == 0, done.stderr
    data = pd.read_csv("room/data.csv")
    assert len(data) == 9 * 144
    assert not {"flow_L_h", "displacement"} & set(data.columns)
    assert data["air_temperature_C"].isna().sum() == 324
    assert (data["air_temperature_C"].dropna() % 0.5 == 0.0).all()
    assert set(data["setpoint_C"]) == {20.5}


MISTAKES = {
    "unknown case": (["--case", "O_MW"], "no case 'O_MW'; did you mean 'O_WM'? (there are: O_0, O_CP, O_WM)"),
    "unknown belief": (["--believed", "X"], "no case 'X'"),
    "unknown week": (["--week", "januray"], "no week 'januray'; did you mean 'january'?"),
    "unknown channel": (["--without", "flow"], "no channel 'flow'"),
    "unknown channel of noise": (["--noise", "air=1"], "no channel 'air'"),
    "noise without a figure": (["--noise", "flow_L_h"], "'flow_L_h' is not a channel, '=' and a number of 0 or more"),
    "negative noise": (["--noise", "flow_L_h=-1"], "is not a channel, '=' and a number of 0 or more"),
    "more missing than a half": (["--missing", "0.6"], "Invalid value for '--missing'"),
    "no number": (["--interval-s", "nan"], "nan is not a finite number"),
    "noise of what is known": (["--noise", "solar_gain_W=5"], "--noise solar_gain_W: the modeller knows this channel"),
    "no such days": (["--days", "8"], "the weather lasts 7 days, less than 8"),
    "no such interval": (["--interval-s", "7"], "no multiple of the study's step_s"),
    "only one interval": (["--interval-s", "604800"], "the record is shorter than two intervals"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_what_cannot_be_is_refused_and_nothing_is_written(entry: Entry, small_study: Path, mistake: str) -> None:
    options, said = MISTAKES[mistake]
    case = [] if "--case" in options else ["--case", "O_0"]
    done = entry("reality", small_study, *case, *options, "--out", "room")
    assert (done.code, done.stdout) == (USAGE, "")
    assert said in done.stderr
    assert [path.name for path in Path().iterdir()] == [small_study.name]


def test_a_truth_that_a_killed_command_left_without_its_dataset_stands_in_nobody_s_way(
    entry: Entry, small_study: Path
) -> None:
    command = ("reality", small_study, "--case", "O_0", "--days", "2", "--out", "room")
    assert entry(*command).code == 0
    before = contents(Path())
    shutil.rmtree("room")
    assert entry(*command).code == 0
    assert contents(Path()) == before
    shutil.rmtree("room")
    Path("room-truth.json").write_text("{}\n")  # of something else
    done = entry(*command)
    assert (done.code, done.stdout) == (USAGE, "")
    assert "room-truth.json: there is something of this name already" in done.stderr
    assert Path("room-truth.json").read_text() == "{}\n"


@pytest.mark.parametrize("there", ["room", "room-truth.json"])
def test_what_is_there_is_left_alone(entry: Entry, small_study: Path, there: str) -> None:
    Path(there).mkdir()
    (Path(there) / "mine").touch()
    done = entry("reality", small_study, "--case", "O_0", "--out", "room")
    assert (done.code, done.stdout) == (USAGE, "")
    assert f"{there}: there is something of this name already" in done.stderr
    assert sorted(path.name for path in Path().iterdir()) == sorted([there, small_study.name])
    assert (Path(there) / "mine").exists()


def test_a_study_with_a_mistake_is_invalid(entry: Entry, small_study: Path) -> None:
    small_study.write_text(small_study.read_text().replace("members = 2", "members = 0"))
    done = entry("reality", small_study, "--case", "O_0", "--out", "room")
    assert done.code == INVALID
    assert "[ensemble] members = 0: must be at least 1" in done.stderr


def test_a_place_that_cannot_be_written_is_told(entry: Entry, small_study: Path) -> None:
    Path("file").touch()
    done = entry("reality", small_study, "--case", "O_0", "--days", 1, "--out", "file/room")
    assert (done.code, done.stdout) == (FAILED, "")
    assert "cannot be written" in done.stderr


EFFECTS = {
    "unknown effect": (["--effect", "let-bu"], USAGE, "no effect 'let-bu'; did you mean 'let-by'?"),
    "unknown parameter": (["--effect", "let-by", "--set", "fractoin=1"], USAGE, "did you mean 'fraction'?"),
    "out of bounds": (["--effect", "let-by", "--set", "fraction=2"], USAGE, "'let-by': fraction: must be at most 1"),
    "no number": (["--effect", "let-by", "--set", "fraction=a"], USAGE, "'fraction=a' is not a parameter, '='"),
    "a parameter of none": (["--set", "fraction=0.1"], USAGE, "--set fraction: is of an effect: name one"),
    "twice": (["--effect", "let-by", "--effect", "let-by"], USAGE, "effect 'let-by' is asked for twice"),
    "of two": (
        ["--effect", "infiltration", "--effect", "solar-factor", "--set", "factor=2"],
        USAGE,
        "more than one effect has it; write infiltration.factor or solar-factor.factor",
    ),
    "hindered": (["--effect", "pwm-period"], INVALID, "effect 'pwm-period': no modulator with a period is believed"),
}


@pytest.mark.parametrize("mistake", EFFECTS)
def test_an_effect_that_cannot_be_is_refused_and_nothing_is_written(
    entry: Entry, small_study: Path, mistake: str
) -> None:
    options, code, said = EFFECTS[mistake]
    done = entry("reality", small_study, "--case", "O_0", *options, "--days", 1, "--out", "room")
    assert (done.code, done.stdout) == (code, "")
    assert said in done.stderr
    assert [path.name for path in Path().iterdir()] == [small_study.name]


def test_effects_go_into_the_reality_and_the_truth(entry: Entry, small_study: Path) -> None:
    asked = ("--effect", "infiltration", "--effect", "solar-factor", "--effect", "let-by")
    values = ("--set", "fraction=0.02", "--set", "infiltration.factor=8", "--set", "solar-factor.factor=0.6")
    done = entry("reality", small_study, "--case", "O_0", *asked, *values, "--days", 1, "--out", "room")
    assert (done.code, done.stderr) == (0, "")
    assert json.loads(Path("room-truth.json").read_text())["effects"] == [
        {"name": "infiltration", "parameters": {"factor": 8.0}},
        {"name": "solar-factor", "parameters": {"factor": 0.6}},
        {"name": "let-by", "parameters": {"fraction": 0.02}},
    ]


def test_an_effect_without_figures_is_told_to_have_its_defaults(entry: Entry, small_study: Path) -> None:
    done = entry("reality", small_study, "--case", "O_0", "--effect", "sensor-bias", "--days", 1, "--out", "room")
    assert (done.code, done.stderr) == (0, "warning: effect 'sensor-bias' has its defaults: bias_K = 0\n")
