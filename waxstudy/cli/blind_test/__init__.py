"""`waxstudy blind-test`: records whose effect is withheld, diagnosers let loose on them, their score."""

from __future__ import annotations

import click

from waxstudy.cli.lazy import LazyGroup

COMMANDS = {
    "make": "Make records whose effect is sealed, and print the key.",
    "solve": "Let a diagnoser loose on every record, each alone in a temporary folder.",
    "score": "Open the truth with the key and score everybody who answered.",
    "baseline": "Print what a simple diagnoser says of one dataset.",
    "without": "Diagnose one dataset with an effect taken out of the library.",
}


@click.group("blind-test", cls=LazyGroup, package=__name__, listed=COMMANDS)
def command() -> None:
    """Try a diagnosis on records whose effect is withheld."""
