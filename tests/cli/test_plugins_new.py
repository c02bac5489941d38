"""`waxstudy plugins new`: what it prints, what it refuses, and that it overwrites nothing."""

from __future__ import annotations

import json
import os
import re
import shlex
from pathlib import Path

import pytest

from tests.cli.conftest import Entry
from tests.conftest import Waxstudy
from waxstudy.cli.plugins.new import KINDS_HELP
from waxstudy.plugin import KINDS

DONE, USAGE, PLUGIN, FAILED = 0, 2, 4, 6

FILES = [
    "pyproject.toml",
    "README.md",
    ".gitignore",
    "waxstudy_my_wax.py",
    "tests/test_conformance.py",
    "tests/test_model.py",
    "study.toml",
]


def written(folder: Path) -> set[str]:
    return {str(file.relative_to(folder).as_posix()) for file in folder.rglob("*") if file.is_file()}


def test_it_prints_the_files_and_the_next_three_commands(entry: Entry, tmp_path: Path) -> None:
    done = entry("plugins", "new", "my-wax", "--kind", "actuator")
    assert (done.code, done.stderr) == (DONE, "")
    files, commands = done.stdout.split("\nnext:\n")
    assert files.splitlines() == [f"waxstudy-my-wax/{file}" for file in FILES]
    assert commands.splitlines() == [
        "  python -m pip install --editable waxstudy-my-wax",
        "  waxstudy plugins check my-wax",
        "  waxstudy run waxstudy-my-wax/study.toml",
    ]
    assert written(tmp_path) == {f"waxstudy-my-wax/{file}" for file in FILES}


def test_an_effect_is_tried_on_a_record_that_has_it(entry: Entry) -> None:
    done = entry("plugins", "new", "cold-nights", "--kind", "effect")
    assert done.stdout.splitlines()[-2:] == [
        "  waxstudy reality waxstudy-cold-nights/study.toml --case O_CP --effect cold-nights --set drop_K=5 "
        "--out data/cold-nights",
        "  waxstudy diagnose data/cold-nights --quick",
    ]


def test_as_json_it_prints_the_folder_and_the_files_alone(entry: Entry, tmp_path: Path) -> None:
    done = entry("plugins", "new", "my-wax", "--kind", "actuator", "--out", "mine/new", "--json")
    assert (done.code, done.stderr) == (DONE, "")
    assert json.loads(done.stdout) == {"folder": os.path.join("mine", "new", "waxstudy-my-wax"), "files": FILES}
    assert written(tmp_path / "mine" / "new" / "waxstudy-my-wax") == set(FILES)


def test_a_folder_with_a_space_is_quoted_in_the_commands(entry: Entry) -> None:
    done = entry("plugins", "new", "my-wax", "--kind", "actuator", "--out", "my plugins")
    assert shlex.split(done.stdout.splitlines()[-1])[-1] == "my plugins/waxstudy-my-wax/study.toml"


@pytest.mark.parametrize(
    ("name", "kind", "says"),
    [
        ("My_Wax", "actuator", "'My_Wax' cannot be a name: lower-case letters and digits, words joined by '-'"),
        ("../wax", "actuator", "'../wax' cannot be a name: "),
        ("w" * 41, "actuator", "at most 40 characters"),
        ("my-wax", "acutator", "no kind 'acutator'; did you mean 'actuator'? (kinds: sensor, controller, "),
        ("my-wax", "pump", "no kind 'pump' (kinds: sensor, "),
        ("pwm", "modulator", "modulator 'pwm' of waxstudy 0.1"),
        ("paper", "actuator", "a module waxstudy_paper is installed already: choose another name"),
    ],
    ids=["capitals", "path", "long", "misspelled kind", "unknown kind", "taken", "module"],
)
def test_what_cannot_be_is_refused_in_one_line_and_nothing_written(
    entry: Entry, tmp_path: Path, name: str, kind: str, says: str
) -> None:
    done = entry("plugins", "new", name, "--kind", kind)
    assert (done.code, done.stdout) == (USAGE, "")
    (line,) = done.stderr.splitlines()
    assert line.startswith("error: ")
    assert says in line
    assert list(tmp_path.iterdir()) == []


def test_a_name_of_another_kind_is_free(entry: Entry) -> None:
    assert entry("plugins", "new", "pwm", "--kind", "actuator").code == DONE


def test_checked_before_it_is_installed_it_says_how(entry: Entry) -> None:
    assert entry("plugins", "new", "my-wax", "--kind", "actuator").code == DONE
    done = entry("plugins", "check", "my-wax")
    assert done.code == PLUGIN
    assert "; it may be in the folder waxstudy-my-wax: python -m pip install --editable waxstudy-my-wax" in done.stderr


@pytest.mark.parametrize("there", ["folder", "empty folder", "file", "dangling link"])
def test_what_is_there_already_is_left_alone(entry: Entry, tmp_path: Path, there: str) -> None:
    target = tmp_path / "waxstudy-my-wax"
    if there == "file":
        target.write_text("mine")
    elif there == "dangling link":
        target.symlink_to("nowhere")
    else:
        target.mkdir()
    if there == "folder":
        (target / "study.toml").write_text("mine")
    done = entry("plugins", "new", "my-wax", "--kind", "actuator")
    assert (done.code, done.stdout) == (USAGE, "")
    assert done.stderr == (
        "error: waxstudy-my-wax: there is something of this name already: move it away or take another name; "
        "nothing was written\n"
    )
    assert [path.name for path in tmp_path.iterdir()] == ["waxstudy-my-wax"]
    assert [path.read_text() for path in (target, *target.rglob("*")) if path.is_file()] == (
        ["mine"] if there in ("folder", "file") else []
    )


def test_a_disk_that_refuses_is_a_failure_with_its_reason(entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    done = entry("plugins", "new", "my-wax", "--kind", "actuator", "--out", "file/beneath")
    assert (done.code, done.stdout) == (FAILED, "")
    assert re.fullmatch(r"error: file/beneath/waxstudy-my-wax: cannot be written: Not a directory\n", done.stderr)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_missing_kind_is_asked_for(entry: Entry) -> None:
    done = entry("plugins", "new", "my-wax")
    assert (done.code, done.stdout) == (USAGE, "")
    assert "Missing option '--kind'" in done.stderr


def test_help_names_every_kind() -> None:
    assert re.findall(r"[a-z]+", KINDS_HELP.replace(" or ", " ")) == list(KINDS)


@pytest.mark.slow
def test_the_commands_of_the_readme_run_as_printed(waxstudy: Waxstudy, tmp_path: Path) -> None:
    """All but the installation, for which the package is put on the path as an installer would do it."""
    assert waxstudy("plugins", "new", "my-wax", "--kind", "valve").returncode == DONE
    folder = tmp_path / "waxstudy-my-wax"
    about = folder / "waxstudy_my_wax-0.1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: waxstudy-my-wax\nVersion: 0.1.0\n")
    (about / "entry_points.txt").write_text("[waxstudy]\nmy-wax = waxstudy_my_wax\n")
    (printed,) = re.findall(r"```sh\n(.*?)```", (folder / "README.md").read_text(), re.DOTALL)
    install, *commands = [shlex.split(line, comments=True) for line in printed.splitlines()]
    assert install == ["python", "-m", "pip", "install", "--editable", ".[test]"]
    own = [arguments for program, *arguments in commands if program == "waxstudy"]
    assert [arguments[0] for arguments in own] == ["plugins", "run"]
    for arguments in own:
        # a study is named as seen from the package's folder
        there = [str(folder / a) if a.endswith(".toml") else a for a in arguments]
        done = waxstudy(*there, env={"PYTHONPATH": str(folder)})
        assert (done.returncode, done.stderr) == (DONE, "")
