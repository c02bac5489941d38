"""Claims about the files: the format of section "Format" of docs/datasets.md, and a truth that stays apart."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
import tomli_w

from tests.conftest import DATA
from tests.synthetic.conftest import Simulated, described, written
from waxstudy.dataset.channels import CHANNELS
from waxstudy.plugin.registry import installed
from waxstudy.study.model import Study
from waxstudy.study.read import read_study
from waxstudy.synthetic.write import truth_beside

EXAMPLE = DATA / "realities" / "r01"


def truth(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(truth_beside(folder).read_text(encoding="utf-8"))
    return found


def test_the_folder_holds_data_and_description_and_the_truth_lies_beside_it(
    folder: Path, study: Study, simulated: Simulated
) -> None:
    written(folder, study, simulated, "O_WM", "O_CP")
    assert sorted(path.name for path in folder.iterdir()) == ["data.csv", "dataset.toml"]
    assert sorted(path.name for path in folder.parent.iterdir()) == ["room-7", "room-7-truth.json"]


def test_the_description_is_the_same_whatever_the_truth(tmp_path: Path, study: Study, simulated: Simulated) -> None:
    texts = set()
    for case in ("O_0", "O_D", "O_WM"):
        (tmp_path / case).mkdir()
        folder = written(tmp_path / case / "room-7", study, simulated, case, "O_0")
        texts.add((folder / "dataset.toml").read_bytes())
    assert len(texts) == 1


def test_the_truth_names_the_steps_between_belief_and_reality_and_what_they_change(
    folder: Path, study: Study, simulated: Simulated
) -> None:
    told = truth(written(folder, study, simulated, "O_WM", "O_CP", seed=5))
    assert (told["case"], told["believed"], told["steps"]) == ("O_WM", "O_CP", ["O_D", "O_WM"])
    assert set(told["differences"]) == {"sensor", "actuator", "valve"}
    assert told["differences"]["sensor"] == {"believed": None, "true": {"use": "delay", "delay_s": 600.0}}
    assert told["differences"]["valve"]["believed"] == {"use": "linear"}
    assert told["instruments"]["seed"] == 5
    assert told["figures"] == simulated("O_WM").figures()
    assert {"waxstudy", "numba", "python"} <= set(told["versions"])


def test_without_another_belief_there_is_no_gap(folder: Path, study: Study, simulated: Simulated) -> None:
    told = truth(written(folder, study, simulated, "O_CP", "O_CP"))
    assert (told["steps"], told["differences"]) == ([], {})


def test_the_same_seed_gives_the_same_bytes(tmp_path: Path, study: Study, simulated: Simulated) -> None:
    first, again = (
        written(tmp_path / name / "room-7", study, simulated, "O_D", "O_CP", missing=0.01) for name in ("a", "b")
    )
    for name in ("data.csv", "dataset.toml"):
        assert (first / name).read_bytes() == (again / name).read_bytes()
    assert truth_beside(first).read_bytes() == truth_beside(again).read_bytes()


def test_belief_and_room_are_in_the_study_file_s_words(
    folder: Path, tmp_path: Path, study: Study, simulated: Simulated
) -> None:
    about = described(written(folder, study, simulated, "O_WM", "O_D"))
    setpoint_C = about["nominal"].pop("setpoint_C")
    made = {
        "study": {"name": "again"},
        "room": about["room"],
        "weather": {"week": {"use": "tallinn-week", "month": "january"}},
        "comfort": {"setpoint_C": setpoint_C},
        "ladder": {"believed": {"reference": "B", "start": {"id": "B", **about["nominal"]}}},
    }
    path = tmp_path / "again.toml"
    path.write_bytes(tomli_w.dumps(made).encode())
    again = read_study(path, installed())
    assert again.room == study.room
    assert again.cases["B"].blocks == study.cases["O_D"].blocks


def test_lost_samples_are_blank_and_noise_is_stated_for_the_channels_that_have_it(
    folder: Path, study: Study, simulated: Simulated
) -> None:
    left_out = ["operative_temperature_C"]
    written(folder, study, simulated, "O_WM", "O_D", missing=0.2, noise={"air_temperature_C": 0.5}, without=left_out)
    rows = (folder / "data.csv").read_text(encoding="utf-8").splitlines()
    assert sum(",,," in row for row in rows) == 576
    noise = described(folder)["noise"]
    assert noise["air_temperature_C"] == 0.5
    assert set(noise) < set(rows[0].split(","))


@pytest.mark.skipif(not EXAMPLE.exists(), reason=f"{EXAMPLE} is not there; WAXSTUDY_DATA names the folder of the data")
def test_the_format_is_that_of_the_measured_examples(folder: Path, study: Study, simulated: Simulated) -> None:
    written(folder, study, simulated, "O_CP", "O_CP")
    ours, theirs = (pd.read_csv(place / "data.csv") for place in (folder, EXAMPLE))
    assert [name for name in ours.columns if name in theirs.columns] == list(theirs.columns)
    assert set(ours.columns) <= {"time", *CHANNELS}
    for data in (ours, theirs):
        times = pd.to_datetime(data["time"], format="%Y-%m-%dT%H:%M:%S")
        assert set(times.diff().dropna().dt.total_seconds()) == {60.0}
    about, example = described(folder), described(EXAMPLE)
    assert set(about["dataset"]) == set(example["dataset"])
    assert about["dataset"]["inputs"] == example["dataset"]["inputs"]
    assert about["dataset"]["interval_s"] == example["dataset"]["interval_s"]
    assert about["nominal"]["controller"] == example["nominal"]["controller"]
    assert about["nominal"]["setpoint_C"] == example["nominal"]["setpoint_C"]
