"""`waxstudy plugins new`"""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from waxstudy.cli.errors import FAILED, USAGE, CommandError, taken
from waxstudy.cli.existing import Written
from waxstudy.cli.output import Command, print_out
from waxstudy.cli.plugins.lookup import as_json, print_json

if TYPE_CHECKING:
    from waxstudy.plugin.scaffold import NewPlugin

KINDS_HELP = "sensor, controller, modulator, actuator, valve, room, weather, effect or reference."


@click.command("new", cls=Command)
@click.argument("name")
@click.option("--kind", required=True, metavar="KIND", help=KINDS_HELP)
@click.option(
    "--out",
    type=Written(file_okay=False),
    default=Path(),
    metavar="DIR",
    help="Where to put its folder  [default: the current folder]",
)
@as_json
def command(name: str, kind: str, out: Path, as_json: bool) -> None:
    """Begin a plugin: a package of its own with a working component called NAME.

    It goes to the folder waxstudy-NAME: one module to edit, its tests, a study that uses it, and a README that says
    how to go on. A folder that is there already is left alone.
    """
    from waxstudy.plugin.registry import installed
    from waxstudy.plugin.scaffold import NewPlugin

    plugin = NewPlugin(name, kind)
    for problem in plugin.problems(installed()):
        raise CommandError(problem, USAGE)
    folder = out / plugin.package
    files = plugin.files()
    _write(files, folder)
    if as_json:
        print_json({"folder": str(folder), "files": list(files)})
    else:
        print_out(_said(folder, plugin, files))


def _write(files: dict[str, str], folder: Path) -> None:
    from waxstudy.plugin.scaffold import write

    if os.path.lexists(folder):
        raise taken(folder)
    try:
        write(files, folder)
    except OSError as error:
        raise CommandError(f"{folder}: cannot be written: {error.strerror or error}", FAILED) from error


def _said(folder: Path, plugin: NewPlugin, files: Iterable[str]) -> str:
    commands = (
        ("python", "-m", "pip", "install", "--editable", str(folder)),
        ("waxstudy", "plugins", "check", plugin.name),
        *_tried(plugin, folder),
    )
    written = [str(folder / file) for file in files]
    return "\n".join([*written, "", "next:", *(f"  {shlex.join(command)}" for command in commands)]) + "\n"


def _tried(plugin: NewPlugin, folder: Path) -> Iterator[tuple[str, ...]]:
    """Yield what shows a component at work: an effect in a record of its own, which a study would not name."""
    study = str(folder / "study.toml")
    if plugin.kind != "effect":
        yield "waxstudy", "run", study
        return
    record = str(Path("data") / plugin.name)
    put = ("--effect", plugin.name, "--set", "drop_K=5")
    yield "waxstudy", "reality", study, "--case", "O_CP", *put, "--out", record
    yield "waxstudy", "diagnose", record, "--quick"
