"""`waxstudy blind-test baseline`"""

from __future__ import annotations

import json
from pathlib import Path

import click

from waxstudy.cli.blind_test.common import failures
from waxstudy.cli.errors import INVALID, PLUGIN, CommandError
from waxstudy.cli.existing import Existing
from waxstudy.cli.output import Command, print_out


@click.command("baseline", cls=Command)
@click.argument("name", metavar="NAME")
@click.argument("dataset", metavar="DATASET", type=Existing(file_okay=False))
def command(name: str, dataset: Path) -> None:
    """Print what a simple diagnoser says of a dataset, as the JSON of a diagnosis."""
    with failures(dataset):
        from waxstudy.dataset.read import read_dataset
        from waxstudy.plugin.trial import baseline_of
        from waxstudy.study.problems import StudyError

        try:
            print_out(json.dumps(baseline_of(name)(read_dataset(dataset))) + "\n")
        except StudyError as error:
            raise CommandError(str(error), PLUGIN if error.is_plugin_fault else INVALID, label="") from error
