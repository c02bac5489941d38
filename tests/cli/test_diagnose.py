"""`waxstudy diagnose` as a user calls it, on small datasets that `waxstudy reality` makes."""

from __future__ import annotations

import json
import os
import pty
import signal
import subprocess
import sys
import time
import tomllib
from hashlib import sha256
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

import waxstudy as wx
from tests.cli.conftest import Entry, Plugin
from tests.conftest import SMALL, WAXSTUDY, Waxstudy, call
from tests.report.test_diagnosis import page_text, untraced
from tests.results.test_parquet import units_in
from waxstudy.dataset.channels import CHANNELS

USAGE, INVALID, PLUGIN, FAILED, INTERRUPTED = 2, 3, 4, 6, 130
FILES = ["diagnosis.json", "report.html", "traces.parquet"]
OF_ROOM = ("air_temperature_C", "operative_temperature_C", "floor_surface_temperature_C", "return_temperature_C")


def made(folder: Path, *left_out: str) -> Path:
    """Return four days of a loop with a wax motor and a quick-opening valve, of which the modeller knows neither."""
    (folder / "small.toml").write_text(SMALL)
    chosen = ("--case", "O_WM", "--believed", "O_CP", "--days", "4", "--interval-s", "120")
    without = [word for channel in (*OF_ROOM, *left_out) for word in ("--without", channel)]
    done = call(folder, "reality", "small.toml", *chosen, *without, "--out", "loop")
    assert done.returncode == 0, done.stderr
    return folder / "loop"


@pytest.fixture(scope="session")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return made(tmp_path_factory.mktemp("dataset"))


@pytest.fixture(scope="session")
def motor(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same loop, of which only the motor was recorded: quick to diagnose."""
    return made(tmp_path_factory.mktemp("motor"), "sensor_temperature_C", "flow_L_h", "supply_temperature_C")


# --- what it prints and writes -----------------------------------------------------------------------


def says_where_it_comes_from(told: dict[str, Any], dataset: Path) -> bool:
    source = told["provenance"]
    hashes = {name: sha256((dataset / name).read_bytes()).hexdigest() for name in ("dataset.toml", "data.csv")}
    assert (told["format"], source["seed"], source["data_sha256"]) == (1, 1, hashes)
    assert source["packages"]["waxstudy"] == source["plugins"]["waxstudy"] == wx.__version__
    believed = tomllib.loads((dataset / "dataset.toml").read_text())
    assert set(source["believed"]["chain"]) == set(believed["nominal"]) - {"setpoint_C"}
    assert source["believed"]["room"]["use"] == "nzeb"
    assert source["command"] == f"waxstudy diagnose {dataset} --quick"
    return True


@pytest.mark.slow
def test_it_prints_the_summary_and_writes_three_files(dataset: Path, entry: Entry) -> None:
    done = entry("diagnose", dataset, "--quick", "--out", "found/here")
    assert (done.code, done.stderr) == (0, "")
    printed = done.stdout.splitlines()
    assert printed[0].startswith("loop: ")
    assert printed[-1] == "found/here"
    assert max(map(len, printed)) <= 120
    assert sorted(path.name for path in Path("found/here").iterdir()) == FILES
    told = json.loads(Path("found/here/diagnosis.json").read_text())
    assert (told["dataset"], told["seed"], told["is_quick"]) == ("loop", 1, True)
    assert says_where_it_comes_from(told, dataset)
    assert told["summary"] in " ".join(done.stdout.split())
    page = Path("found/here/report.html").read_text(encoding="utf-8")
    assert page.startswith("<!DOCTYPE html>")
    assert untraced(done.stdout, told) + untraced(page_text(page), told) == []
    named = {name for effect in told["effects"] for name in effect["group"]}
    assert named
    assert all(bool(each["why"]) is (each["name"] not in named) for each in told["tried"])
    traces = pd.read_parquet("found/here/traces.parquet")
    assert len(traces) == len(pd.read_csv(dataset / "data.csv"))
    judged = {stage["channel"] for stage in told["stages"]}
    assert set(traces) == {f"{channel}_{what}" for channel in judged for what in ("measured", "before", "after")}
    assert (traces.index == pd.to_datetime(pd.read_csv(dataset / "data.csv")["time"])).all()
    told = units_in(Path("found/here/traces.parquet"))
    assert told.pop("time") == "local standard time"
    assert told == {name: CHANNELS[name.rpartition("_")[0]].unit for name in traces}


@pytest.mark.slow
def test_json_is_all_that_is_printed_and_the_file_holds_the_same_bytes(
    motor: Path, entry: Entry, waxstudy: Waxstudy, tmp_path: Path
) -> None:
    printed = entry("diagnose", motor, "--quick", "--json", "--seed", 7)
    assert (printed.code, printed.stderr) == (0, "")
    assert json.loads(printed.stdout)["seed"] == 7
    assert list(tmp_path.iterdir()) == []  # without --out nothing is written
    again = waxstudy("diagnose", motor, "--quick", "--json", "--seed", 7, "--out", "found")
    assert again.stdout == printed.stdout
    assert (tmp_path / "found" / "diagnosis.json").read_text() == printed.stdout


@pytest.mark.slow
def test_an_earlier_diagnosis_is_replaced_and_other_files_of_the_folder_stay(motor: Path, entry: Entry) -> None:
    Path("found").mkdir()
    Path("found/notes.txt").write_text("mine")
    Path("found/diagnosis.json").write_text("of last week")
    assert entry("diagnose", motor, "--quick", "--out", "found").code == 0
    assert sorted(path.name for path in Path("found").iterdir()) == sorted([*FILES, "notes.txt"])
    assert json.loads(Path("found/diagnosis.json").read_text())["dataset"] == "loop"


# --- progress and interruption -----------------------------------------------------------------------


def start(folder: Path, *arguments: object) -> tuple[subprocess.Popen[str], int]:
    """Start the command with a terminal for its stderr; return it and the end from which that is read."""
    reader, writer = pty.openpty()
    process = subprocess.Popen(
        [str(WAXSTUDY), *map(str, arguments)],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=writer,
        text=True,
        env={**os.environ, "TERM": "xterm", "COLUMNS": "120"},
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    os.close(writer)
    return process, reader


def read_until(reader: int, wanted: str) -> str:
    """Return what a terminal shows up to a text, or to its end."""
    text, until = "", time.monotonic() + 120.0
    while wanted not in text and time.monotonic() < until:
        try:
            piece = os.read(reader, 4096)
        except OSError:  # the program has ended
            break
        text += piece.decode(errors="replace")
    return text


@pytest.mark.slow
def test_progress_is_shown_on_a_terminal_unless_quiet(motor: Path, tmp_path: Path) -> None:
    process, reader = start(tmp_path, "diagnose", motor, "--quick", "--json")
    shown = read_until(reader, "100%")
    stdout, _ = process.communicate()
    assert "%" in shown
    assert json.loads(stdout)["dataset"] == "loop"
    process, reader = start(tmp_path, "diagnose", motor, "--quick", "--json", "--quiet")
    stdout, _ = process.communicate()
    assert read_until(reader, "%") == ""
    assert json.loads(stdout)["dataset"] == "loop"


@pytest.mark.slow
def test_ctrl_c_ends_it_with_a_true_sentence_and_without_files(dataset: Path, tmp_path: Path) -> None:
    process, reader = start(tmp_path, "diagnose", dataset, "--out", "found")
    read_until(reader, "%")
    process.send_signal(signal.SIGINT)
    stdout, _ = process.communicate(timeout=60)
    assert (process.returncode, stdout) == (INTERRUPTED, "")
    assert "interrupted; no file is half written, the same command begins anew" in read_until(reader, "anew")
    assert list(tmp_path.iterdir()) == []


# --- what goes wrong ---------------------------------------------------------------------------------


def test_a_folder_that_is_not_there_is_a_mistake_of_usage(entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for argument in ("nowhere", "file"):
        done = entry("diagnose", argument)
        assert (done.code, done.stdout) == (USAGE, "")
        assert argument in done.stderr


def test_a_folder_without_a_dataset_is_invalid(entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    done = entry("diagnose", "empty", "--out", "found")
    assert (done.code, done.stdout) == (INVALID, "")
    assert "empty/dataset.toml" in done.stderr
    assert not Path("found").exists()


def copied(dataset: Path, place: Path, **replaced: str) -> Path:
    place.mkdir()
    for path in dataset.iterdir():
        (place / path.name).write_text(path.read_text())
    for old, new in replaced.items():
        description = place / "dataset.toml"
        assert old in description.read_text()
        description.write_text(description.read_text().replace(old, new))
    return place


def test_wrong_units_are_refused_with_the_channel_and_all_problems_at_once(
    dataset: Path, entry: Entry, tmp_path: Path
) -> None:
    broken = copied(dataset, tmp_path / "kelvin")
    data = pd.read_csv(broken / "data.csv")
    data["sensor_temperature_C"] += 273.15
    data["outdoor_temperature_C"] += 273.15
    data.to_csv(broken / "data.csv", index=False)
    done = entry("diagnose", "kelvin")
    assert (done.code, done.stdout) == (INVALID, "")
    assert "sensor_temperature_C" in done.stderr
    assert "outdoor_temperature_C" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_belief_that_no_component_has_is_told_with_its_line(dataset: Path, entry: Entry, tmp_path: Path) -> None:
    copied(dataset, tmp_path / "odd", **{'"on-off"': '"on-of"'})
    done = entry("diagnose", "odd")
    assert done.code == INVALID
    assert "odd/dataset.toml:" in done.stderr
    assert "did you mean 'on-off'?" in done.stderr


def test_a_broken_plugin_that_the_belief_names_is_to_blame(
    dataset: Path, waxstudy: Waxstudy, plugin: Plugin, tmp_path: Path
) -> None:
    copied(dataset, tmp_path / "odd", **{'"on-off"': '"stranger"'})
    done = waxstudy("diagnose", "odd", env=plugin("stranger", "raise ImportError('gone')\n"))
    assert (done.returncode, done.stdout) == (PLUGIN, "")
    assert "stranger" in done.stderr


@pytest.mark.parametrize("out", ["file", "file/found"])
def test_a_place_that_cannot_be_written_is_told_before_the_work(dataset: Path, entry: Entry, out: str) -> None:
    Path("file").touch()
    done = entry("diagnose", dataset, "--out", out)
    assert (done.code, done.stdout) == (USAGE, "")
    assert out in done.stderr


@pytest.mark.parametrize(
    ("given", "seen"),
    [({}, ["1", "1", "1"]), ({"OMP_NUM_THREADS": "4"}, [None, "4", None])],
    ids=["nothing said", "the user has chosen"],
)
def test_small_matrices_get_one_thread_unless_the_user_has_chosen(
    given: dict[str, str], seen: list[str | None], tmp_path: Path
) -> None:
    program = (
        "import os, sys\nfrom waxstudy.cli import main\n"
        f"try: main(['diagnose', {str(tmp_path)!r}])\n"
        "finally:\n"
        "  from waxstudy.simulation.threads import ONE_THREAD\n"
        "  print([os.environ.get(name) for name in ONE_THREAD])"
    )
    environment = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")} | given
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == INVALID
    assert done.stdout.strip() == str(seen)
