"""`waxstudy run`: what it prints, what it writes, and what it does not compute twice."""

from __future__ import annotations

import json
import os
import pty
import subprocess
from pathlib import Path

import pytest

from tests.cli.conftest import Entry
from tests.cli.folders import computed_at, contents, results
from tests.conftest import ONE_CASE, SMALL, WAXSTUDY, Waxstudy

CASES = ("O_0", "O_CP", "O_WM")
SINGLE = ONE_CASE.replace("members = 2", "members = 1")


def test_a_run_prints_the_comparison_and_last_the_folder_that_it_wrote(waxstudy: Waxstudy, small_study: Path) -> None:
    done = waxstudy("run", small_study)
    assert (done.returncode, done.stderr) == (0, "")
    assert all(case in done.stdout for case in CASES)
    assert done.stdout.splitlines()[-1] == "results/small"
    folder = small_study.parent / "results" / "small"
    files = {"run.json", "study.toml", "kpis.csv", "SHA256SUMS", "origin.json"}
    assert {path.name for path in folder.iterdir()} == {*files, "cases"}
    cases = list((folder / "cases").iterdir())
    assert sorted(case.name.rpartition("_")[0] for case in cases) == [f"{case}_january" for case in sorted(CASES)]
    for case in cases:
        assert {path.name for path in case.iterdir()} == {
            "kpis.csv",
            "durations.parquet",
            "traces.parquet",
            "SHA256SUMS",
        }


def test_with_json_stdout_holds_json_and_nothing_else(entry: Entry, small_study: Path, small_run: Path) -> None:
    done = entry("run", small_study, "--out", "run", "--json")
    assert (done.code, done.stderr) == (0, "")
    printed = json.loads(done.stdout)
    assert printed["run"] == "run"
    assert [row["case"] for row in printed["rows"]] == list(CASES)


def test_with_json_a_failure_leaves_stdout_empty(entry: Entry, small_study: Path) -> None:
    small_study.write_text(SMALL.replace("members = 2", "members = 0"))
    done = entry("run", small_study, "--json")
    assert (done.code, done.stdout) == (3, "")


def stderr_on_a_terminal(*arguments: object, folder: Path) -> str:
    """Run the command with stderr, and nothing else, on a terminal."""
    reader, terminal = pty.openpty()
    command = [str(WAXSTUDY), *map(str, arguments)]
    environment = {**os.environ, "TERM": "xterm"}
    done = subprocess.run(command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=terminal, check=True)
    os.close(terminal)
    seen = b""
    try:
        while part := os.read(reader, 65536):
            seen += part
    except OSError:  # how Linux says that the terminal has been closed
        pass
    os.close(reader)
    assert b"\x1b" not in done.stdout
    return seen.decode()


def test_progress_is_shown_on_a_terminal_and_not_with_quiet(small_study: Path, small_run: Path) -> None:
    shown = stderr_on_a_terminal("run", small_study, "--out", "run", folder=small_study.parent)
    assert "cases" in shown
    assert "3/3" in shown
    assert stderr_on_a_terminal("run", small_study, "--out", "run", "--quiet", folder=small_study.parent) == ""


def test_the_resolved_study_gives_the_same_key_figures_byte_for_byte(entry: Entry, small_run: Path) -> None:
    done = entry("run", small_run / "study.toml", "--out", "again")
    assert done.code == 0, done.stderr
    first, again = results(small_run), results(small_run.parent / "again")
    assert again["kpis.csv"] == first["kpis.csv"]
    assert again["study.toml"] == first["study.toml"]
    assert again == first


@pytest.mark.slow
def test_interpreted_blocks_give_the_same_key_figures_byte_for_byte(waxstudy: Waxstudy, tmp_path: Path) -> None:
    (tmp_path / "single.toml").write_text(SINGLE.replace('"small"\n', '"small"\nstep_s = 60\n'))
    for name, options in (("compiled", ()), ("interpreted", ("--no-jit",))):
        done = waxstudy("run", "single.toml", "--out", name, *options)
        assert done.returncode == 0, done.stderr
    assert contents(tmp_path / "interpreted") == contents(tmp_path / "compiled")


def test_what_has_not_changed_is_not_computed_again(entry: Entry, small_study: Path, small_run: Path) -> None:
    before, files = computed_at(small_run), contents(small_run)
    assert entry("run", small_study, "--out", "run").code == 0
    assert computed_at(small_run) == before
    assert contents(small_run) == files


def test_a_changed_parameter_computes_its_case_and_those_that_inherit_it(
    entry: Entry, small_study: Path, small_run: Path
) -> None:
    before = computed_at(small_run)
    small_study.write_text(SMALL.replace("dead_band_K = 0.5", "dead_band_K = 0.6"))
    assert entry("run", small_study, "--out", "run").code == 0
    after = computed_at(small_run)
    assert after.keys() == before.keys()  # those of the old dead band are gone
    same = {name.split("_january")[0] for name in before if after[name] == before[name]}
    changed = {name.split("_january")[0] for name in before if after[name] != before[name]}
    assert (same, changed) == ({"O_0"}, {"O_CP", "O_WM"})


def test_one_more_case_changes_no_figure_of_the_others(entry: Entry, small_study: Path, small_run: Path) -> None:
    before, rows = computed_at(small_run), (small_run / "kpis.csv").read_text().splitlines()
    small_study.write_text(SMALL.removesuffix("]\n") + '  { id = "O_D", sensor = { use = "delay" } },\n]\n')
    assert entry("run", small_study, "--out", "run").code == 0
    after = computed_at(small_run)
    assert {name: after[name] for name in before} == before
    grown = (small_run / "kpis.csv").read_text().splitlines()
    assert grown[: len(rows)] == rows
    assert [row.split(",")[0] for row in grown[len(rows) :]] == ["O_D", "O_D"]


@pytest.mark.parametrize(
    ("first", "second", "week"), [("1", "01", "2023"), ("NA", "nan", "january"), ("True", "1e5", "null")]
)
def test_names_that_look_like_figures_stay_names(entry: Entry, first: str, second: str, week: str) -> None:
    text = SMALL.replace("O_0", first).replace("O_CP", second).replace("weather.january", f"weather.{week}")
    Path("names.toml").write_text(text.replace("members = 2", "members = 1"))
    assert entry("run", "names.toml", "--out", "run").code == 0
    told = json.loads(entry("report", "run", "--format", "json").stdout)
    assert [(row["case"], row["week"]) for row in told["rows"]] == [(case, week) for case in (first, second, "O_WM")]


def test_a_folder_that_holds_something_else_is_left_alone(entry: Entry, small_study: Path) -> None:
    home = small_study.parent / "home"
    home.mkdir()
    (home / "study.toml").write_text("my own work\n")
    done = entry("run", small_study, "--out", "home")
    assert (done.code, done.stdout) == (6, "")
    assert done.stderr == "error: home: this folder is in use and holds no run; choose another with --out\n"
    assert contents(home).keys() == {"study.toml"}
    assert (home / "study.toml").read_text() == "my own work\n"


@pytest.mark.parametrize("out", ["file", "file/run"])
def test_a_folder_that_can_not_be_is_refused_before_anything_is_computed(
    entry: Entry, small_study: Path, out: str
) -> None:
    file = small_study.parent / "file"
    file.write_text("my own work\n")
    done = entry("run", small_study, "--out", out)
    assert (done.code, done.stdout) == (6, "")
    assert done.stderr.startswith(f"error: {out}: the results cannot be written: ")
    assert done.stderr.endswith("file is no folder to write to\n")
    assert file.read_text() == "my own work\n"


def test_a_run_removes_nothing_that_no_run_has_made(entry: Entry, small_study: Path, small_run: Path) -> None:
    mine = [small_run / "notes.md", small_run / "cases" / "notes.md", small_run / "cases" / "my_case" / "data.csv"]
    mine[2].parent.mkdir()
    for path in mine:
        path.write_text("mine\n")
    old = small_run / "cases" / "O_X_january_0123456789abcdef"
    old.mkdir()
    left = small_run / "cases" / ".partial-left-by-a-killed-run"
    left.mkdir()
    assert entry("run", small_study, "--out", "run").code == 0
    assert all(path.read_text() == "mine\n" for path in mine)
    assert not old.exists()
    assert not left.exists()


def test_a_console_that_lacks_characters_gets_the_table_all_the_same(
    waxstudy: Waxstudy, small_study: Path, small_run: Path
) -> None:
    done = waxstudy("run", small_study, "--out", "run", env={"PYTHONIOENCODING": "cp437"}, encoding="cp437")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[-1] == "run"
