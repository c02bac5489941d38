"""Help and shell completion are quick: nothing heavy is imported for them, nor by a command what it does not use."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import click
import pytest

from tests.conftest import Waxstudy
from waxstudy import __version__
from waxstudy.cli import COMMANDS, group

HEAVY = (
    "numpy",
    "pandas",
    "scipy",
    "numba",
    "pydantic",
    "pluggy",
    "pyarrow",
    "matplotlib",
    "jinja2",
    "rich",
    "pint",
    "python_calamine",
)


@pytest.mark.parametrize(
    "arguments",
    [["--help"], ["-h"], ["run", "--help"], ["report", "-h"], ["diagnose", "-h"], ["import", "-h"], ["--version"]],
    ids=" ".join,
)
def test_help_is_printed_without_heavy_imports(arguments: list[str]) -> None:
    done = imported(arguments, HEAVY)
    assert (done.returncode, done.stderr) == (0, "[]\n")
    assert "waxstudy" in done.stdout


def imported(arguments: list[str], modules: Sequence[str]) -> subprocess.CompletedProcess[str]:
    """Call a command in a process of its own, which prints those of some modules that it imported on stderr."""
    program = (
        "import sys; from waxstudy.cli import main\n"
        f"try: main({arguments})\n"
        f"finally: print([name for name in {modules} if name in sys.modules], file=sys.stderr)"
    )
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("arguments", "modules"),
    [
        (["run", "small.toml", "--quiet", "--out", "run"], ("matplotlib", "scipy.signal", "waxstudy.fleet.run")),
        (["report", "run", "--quiet"], ("matplotlib", "numba", "waxstudy.fleet.result")),
    ],
    ids=["run", "report"],
)
def test_a_run_of_cases_waits_for_nothing_of_figures_or_fleets(
    small_study: Path, small_run: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], modules: tuple[str, ...]
) -> None:
    monkeypatch.chdir(small_study.parent)
    done = imported(arguments, modules)
    assert (done.returncode, done.stderr) == (0, "[]\n")


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_and_option_says_what_it_does(name: str) -> None:
    command = group.get_command(click.Context(group), name)
    assert command is not None
    assert command.help
    options = [parameter for parameter in command.params if isinstance(parameter, click.Option)]
    assert [option.name for option in options if not option.help] == []


def test_the_version_is_that_of_the_package(waxstudy: Waxstudy) -> None:
    assert waxstudy("--version").stdout == f"waxstudy, version {__version__}\n"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_shell_s_completion_script_is_printed(waxstudy: Waxstudy, shell: str) -> None:
    done = waxstudy(env={"_WAXSTUDY_COMPLETE": f"{shell}_source"})
    assert (done.returncode, done.stderr) == (0, "")
    assert "_WAXSTUDY_COMPLETE" in done.stdout


def test_completion_offers_commands_and_options(waxstudy: Waxstudy) -> None:
    def offered(*words: str) -> list[str]:
        env = {"_WAXSTUDY_COMPLETE": "bash_complete", "COMP_WORDS": " ".join(words), "COMP_CWORD": str(len(words) - 1)}
        return [line.partition(",")[2] for line in waxstudy(env=env).stdout.splitlines()]

    assert offered("waxstudy", "r") == ["run", "report", "reality", "rig"]
    assert offered("waxstudy", "run", "--no") == ["--no-jit"]
    assert offered("waxstudy", "report", "--format", "h") == ["html"]
