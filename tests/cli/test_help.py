"""Help and shell completion: quick, because nothing heavy is imported for them."""

from __future__ import annotations

import subprocess
import sys

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
    program = (
        "import sys; from waxstudy.cli import main\n"
        f"try: main({arguments})\n"
        f"finally: print([name for name in {HEAVY} if name in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "[]\n")
    assert "waxstudy" in done.stdout


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
