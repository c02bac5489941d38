"""A group that lists its commands without importing them, so that help is quick."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

import click


class LazyGroup(click.Group):
    """Commands by name with their help line; each is `command` in the module of its name in `package`."""

    def __init__(self, *args: Any, package: str = "", listed: Mapping[str, str] | None = None, **options: Any) -> None:
        super().__init__(*args, **options)
        self.package, self.listed = package, dict(listed or {})

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(self.listed)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in self.listed:
            return None
        command: click.Command = import_module(f"{self.package}.{name.replace('-', '_')}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(self.listed.items()))
