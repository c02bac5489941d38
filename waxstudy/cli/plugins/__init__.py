"""`waxstudy plugins`: the registry, for users and for plugin authors."""

from __future__ import annotations

import click

from waxstudy.cli.lazy import LazyGroup

COMMANDS = {
    "list": "List every component by kind, and broken plugins with their reason.",
    "show": "Show a component's parameters, state, input and output.",
    "new": "Begin a plugin: a package of its own with a working component.",
    "check": "Check that a component keeps the contract of its kind.",
}


@click.group("plugins", cls=LazyGroup, package=__name__, listed=COMMANDS)
def command() -> None:
    """Look at plugins, begin one, check one."""
