"""`waxstudy fit`: from measurements to blocks that a study file can use."""

from __future__ import annotations

import click

from waxstudy.cli.lazy import LazyGroup

COMMANDS = {
    "actuator": "Fit an actuator to records of its displacement.",
    "valve": "Fit a valve's curve to a record of flow.",
}


@click.group("fit", cls=LazyGroup, package=__name__, listed=COMMANDS)
def command() -> None:
    """Fit an actuator or a valve curve to measurements, for use in a study."""
