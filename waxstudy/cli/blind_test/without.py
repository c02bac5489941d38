"""`waxstudy blind-test without`"""

from __future__ import annotations

from pathlib import Path

import click

from waxstudy.cli.blind_test.common import failures
from waxstudy.cli.errors import USAGE, CommandError
from waxstudy.cli.existing import Existing
from waxstudy.cli.output import Command


@click.command("without", cls=Command)
@click.argument("name", metavar="EFFECT")
@click.argument("dataset", metavar="DATASET", type=Existing(file_okay=False))
@click.pass_context
def command(ctx: click.Context, name: str, dataset: Path) -> None:
    """Print the diagnosis of a dataset as JSON, with an effect taken out of the library."""
    with failures(dataset):
        from waxstudy.plugin.registry import hint, installed

        registry = installed()
        if name not in (names := registry.names("effect")):
            raise CommandError(f"no effect '{name}'{hint(name, names)} (there are: {', '.join(names)})", USAGE)
        del registry.components["effect", name]
    from waxstudy.cli.diagnose import command as diagnose

    ctx.invoke(diagnose, dataset=dataset, as_json=True, quiet=True, seed=1)
