"""`waxstudy export`: blocks and chains for other programs."""

from __future__ import annotations

import click

from waxstudy.cli.lazy import LazyGroup

COMMANDS = {
    "fmu": "Write a block or a whole chain as an FMU, for co-simulation.",
    "energyplus": "Write a motor or a whole chain as a Python plugin for EnergyPlus.",
}


@click.group("export", cls=LazyGroup, package=__name__, listed=COMMANDS)
def command() -> None:
    """Write blocks for other programs, which need no waxstudy then."""
