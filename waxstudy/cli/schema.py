"""`waxstudy schema`"""

from __future__ import annotations

import click

from waxstudy.cli.output import Command, print_out


@click.command("schema", cls=Command)
def command() -> None:
    """Print the JSON Schema of the study file, with every installed component, for editors."""
    import json

    from waxstudy.plugin.registry import installed
    from waxstudy.study.schema import schema

    print_out(json.dumps(schema(installed()), indent=2) + "\n")
