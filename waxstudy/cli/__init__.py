"""The command line: one module per command, loaded when it is called."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import click

from waxstudy import __version__

COMMANDS = {
    "run": "Run a study and print its comparison.",
    "report": "Print the comparison of a run again, in another format, or against published figures.",
}


class LazyGroup(click.Group):
    """Lists commands without importing them, so that help is quick."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        command: click.Command = import_module(f"waxstudy.cli.{name}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="waxstudy")
def group() -> None:
    """How much modelling detail does a heating control loop need, and what is a model missing?"""


def main(arguments: list[str] | None = None) -> Any:
    """Entry point; exit codes are those of `waxstudy.cli.errors`."""
    from waxstudy.cli.errors import exit_code

    raise SystemExit(exit_code(lambda: group.main(arguments, "waxstudy", standalone_mode=False)))
