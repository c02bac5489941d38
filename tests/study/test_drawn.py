"""Claims about weeks that have several weathers."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest
import tomli_w

from tests.conftest import Waxstudy
from waxstudy.plugin.registry import installed
from waxstudy.study.read import StudyError, read_study

STUDY = """\
[study]
name = "drawn"
[room]
use = "nzeb"
[weather.january]
use = "tallinn-week"
month = "january"
[ensemble]
members = 2
[ensemble.weather.january]
{lists}
[ladder.pi]
reference = "P_1"
steps = [{{ id = "P_1", sensor = {{ use = "delay" }} }}]
[ladder.pi.start]
id = "P_0"
controller = {{ use = "pi", gain = 18.0, integration_time_s = 2300.0 }}
valve = {{ use = "linear" }}
"""
SEEDS = "seed = [1, 2, 3]"

# what the table says -> the only line that is printed
WRONG = {
    "another key": ("sead = [1, 2]", "x.toml:11: [ensemble.weather.january] sead: unknown key; did you mean 'seed'?"),
    "one value": ("seed = 3", "x.toml:11: [ensemble.weather.january] seed = 3: must be a list of 2 to 100 values"),
    "a list of one": ("seed = [3]", "x.toml:11: [ensemble.weather.january] seed: must be a list of 2 to 100 values"),
    "lists of other lengths": (
        "seed = [1, 2]\nlinke_turbidity = [2.0, 2.5, 3.0]",
        "x.toml:10: [ensemble.weather.january]: its lists are of different lengths: seed 2, linke_turbidity 3",
    ),
    "a value beyond its bound": (
        "seed = [1, -2]",
        "x.toml:11: [ensemble.weather.january] seed[1] = -2: must be at least 0",
    ),
    "another week": (
        "seed = [1, 2]\n[ensemble.weather.januray]\nseed = [1, 2]",
        "x.toml:12: [ensemble.weather.januray]: no [weather.NAME] of this name; did you mean 'january'?",
    ),
}


def written(folder: Path, lists: str = SEEDS) -> Path:
    path = folder / "x.toml"
    path.write_text(STUDY.format(lists=lists))
    return path


def test_a_week_has_the_weathers_that_its_lists_say(tmp_path: Path) -> None:
    study = read_study(written(tmp_path, SEEDS + "\nlinke_turbidity = [2.0, 2.5, 3.0]"), installed())
    told = [(choice.parameters.seed, choice.parameters.linke_turbidity) for choice in study.weathers("january")]
    assert told == [(1, 2.0), (2, 2.5), (3, 3.0)]


def test_a_resolved_study_reads_as_the_same(tmp_path: Path) -> None:
    study = read_study(written(tmp_path), installed())
    again = tmp_path / "again.toml"
    again.write_bytes(tomli_w.dumps(study.described()).encode())
    assert read_study(again, installed()).described() == study.described()


@pytest.mark.parametrize("name", WRONG)
def test_what_is_wrong_is_said_with_its_line(tmp_path: Path, name: str) -> None:
    lists, line = WRONG[name]
    with pytest.raises(StudyError) as error:
        read_study(written(tmp_path, lists), installed())
    (problem,) = error.value.problems
    assert str(problem).removeprefix(f"{tmp_path}/").startswith(line)


def test_every_start_is_run_in_every_weather_at_one_shift(waxstudy: Waxstudy, tmp_path: Path) -> None:
    written(tmp_path)
    assert waxstudy("run", "x.toml", "--out", "run", "--quiet").returncode == 0
    kpis = pd.read_csv(tmp_path / "run" / "kpis.csv")
    one = kpis[kpis["case"] == "P_0"]
    assert one[["member", "weather"]].to_numpy().tolist() == [[0, 0], [1, 0], [2, 1], [3, 1], [4, 2], [5, 2]]
    assert one["setpoint_shift_K"].nunique() == 1
    assert one["hours_below_per_week"].mean() == pytest.approx(33.0, abs=0.5)
    told = json.loads(waxstudy("report", "run", "--format", "json").stdout)
    (mae,) = [each for each in told["spread"] if (each["case"], each["figure"]) == ("P_0", "MAE")]
    # a continuous controller forgets its start, and no weather
    assert mae["weather_share"] > 0.99
    table = waxstudy("report", "run").stdout
    assert "6 members (2 starts in each of 3 weathers)" in table
    assert "what single runs differ by" in table


def test_weathers_of_other_lengths_are_refused(waxstudy: Waxstudy, tmp_path: Path) -> None:
    written(tmp_path, "interval_s = [3600.0, 1800.0]")
    done = waxstudy("run", "x.toml", "--out", "run")
    assert done.returncode == 3
    assert "x.toml:10: [ensemble.weather.january]: its weathers are not equally long" in done.stderr


def test_sunny_days_are_drawn_and_keep_the_gain(tmp_path: Path) -> None:
    study = read_study(written(tmp_path, "sunny_days_seed = [1, 2, 3]"), installed())
    facades = study.room.component.build(study.room.parameters).facades  # type: ignore[attr-defined]
    suns = [choice.component.load(choice.parameters, facades) for choice in study.weathers("january")]  # type: ignore[attr-defined]
    south = [record.irradiance_W_m2["azimuth 180 tilt 90"] for record in suns]
    assert not (south[0] == south[1]).all()
    assert [one.sum() for one in south] == pytest.approx([south[0].sum()] * 3, rel=0.03)
