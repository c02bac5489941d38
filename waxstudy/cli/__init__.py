"""The command line: one module per command, loaded when it is called."""

from __future__ import annotations

import os
from typing import Any

import click

from waxstudy.cli.lazy import LazyGroup
from waxstudy.version import __version__

COMMANDS = {
    "run": "Run a study and print its comparison.",
    "report": "Print the comparison of a run again, in another format, or against published figures or another run.",
    "traces": "Write a page on which the traces of a run or a diagnosis zoom.",
    "tune": "Find better parameters for a case at equal comfort, tested on weather that took no part.",
    "loop": "Print stability, wear and useful duty of every case's loop.",
    "reality": "Make a dataset of a case, as if its room had been measured, and keep the truth apart.",
    "import": "Make a dataset of what a house has logged, in whatever layout.",
    "believe": "Say what is believed of a dataset's room and loop, in the words of its owner.",
    "diagnose": "Find where a record and a model disagree, which effect causes it, and how far the gap shrinks.",
    "calibrate": "Find how a room was built, from a record of its loop when healthy, for use in studies.",
    "blind-test": "Make records whose effect is withheld, let diagnosers loose on them, and score them.",
    "fit": "Fit an actuator or a valve curve to measurements, for use in a study.",
    "rig": "Make displacement and flow records on a virtual test bench, and keep the truth apart.",
    "export": "Write blocks for other programs: as an FMU, or as a plugin for EnergyPlus.",
    "plugins": "List, show, begin and check plugins.",
    "schema": "Print the JSON Schema of the study file, or of dataset.toml, for editors.",
}


@click.group(cls=LazyGroup, package=__name__, listed=COMMANDS, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="waxstudy")
def group() -> None:
    """How much modelling detail does a heating control loop need, and what is a model missing?"""


def main(arguments: list[str] | None = None) -> Any:
    """Entry point; exit codes are those of `waxstudy.cli.errors`."""
    from waxstudy.cli.errors import exit_code

    # pydantic would look for plugins of its own, and end at any package whose list of entry points is damaged
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    raise SystemExit(exit_code(lambda: group.main(arguments, "waxstudy", standalone_mode=False)))
