"""The command line as its help tells it, read from click."""

from __future__ import annotations

import inspect
from collections.abc import Iterator

import click

from docs_site.tables import plain, table
from waxstudy.cli import group


def commands() -> str:
    """Return the page of every command with its arguments and options."""
    intro = "Every command with its options, as `--help` prints them.\n\n"
    return "# Commands\n\n" + intro + "\n".join(_sections(group, _root()))


def _root() -> click.Context:
    return click.Context(group, info_name="waxstudy", **group.context_settings)


def _sections(command: click.Command, context: click.Context) -> Iterator[str]:
    yield _section(command, context)
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            inner = command.get_command(context, name)
            assert inner is not None
            yield from _sections(inner, click.Context(inner, info_name=name, parent=context))


def _section(command: click.Command, context: click.Context) -> str:
    usage = " ".join([context.command_path, *command.collect_usage_pieces(context)])
    parts = [f"## {context.command_path}", plain(inspect.cleandoc(command.help or "").replace("\b\n", ""))]
    parts.append(f"```text\n{usage}\n```")
    told = [option.get_help_record(context) for option in command.get_params(context)]
    rows = [(f"`{record[0]}`", plain(record[1])) for record in told if record]
    if len(rows) > 1:  # more than the help itself
        parts.append(table(("option", "what it does"), rows))
    return "\n\n".join(parts) + "\n"
