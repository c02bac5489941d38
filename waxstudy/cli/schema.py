"""`waxstudy schema`"""

from __future__ import annotations

import click

from waxstudy.cli.output import Command, print_out


@click.command("schema", cls=Command)
@click.option("--dataset", "is_of_dataset", is_flag=True, help="That of dataset.toml instead.")
def command(is_of_dataset: bool) -> None:
    """Print the JSON Schema of the study file, with every installed component, for editors."""
    import json

    from waxstudy.dataset.schema import dataset_schema
    from waxstudy.plugin.registry import installed
    from waxstudy.study.schema import schema

    made = dataset_schema(installed()) if is_of_dataset else schema(installed())
    print_out(json.dumps(made, indent=2) + "\n")
