"""`waxstudy plugins list`"""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from waxstudy.cli.output import Command
from waxstudy.cli.plugins.lookup import as_json, print_json, print_tables, table

if TYPE_CHECKING:
    from waxstudy.plugin import Component


@click.command("list", cls=Command)
@as_json
def command(as_json: bool) -> None:
    """List every component by kind, with its package, and broken plugins with their reason."""
    from waxstudy.plugin import KINDS
    from waxstudy.plugin.registry import installed

    registry = installed()
    entries = sorted(registry.components.items(), key=lambda item: (KINDS.index(item[0][0]), item[0][1]))
    if as_json:
        rows = [
            {"kind": kind, "name": name, "package": e.package, "version": e.version, **_stage(e.component)}
            for (kind, name), e in entries
        ]
        broken = [{"plugin": plugin, "reason": reason} for plugin, reason in registry.broken.items()]
        print_json({"components": rows, "broken": broken})
        return
    listed = table(("kind", "name", "package", "what it is"))
    for (kind, name), entry in entries:
        said = ": ".join((*_stage(entry.component).values(), entry.summary))
        listed.add_row(kind, name, f"{entry.package} {entry.version}", said)
    reasons = [f"broken: {plugin}: {reason}" for plugin, reason in registry.broken.items()]
    print_tables(listed, *(["", *reasons] if reasons else []))


def _stage(component: type[Component]) -> dict[str, str]:
    """The stage of the loop that an effect belongs to; nothing for other kinds."""
    from waxstudy.plugin import Effect

    return {"stage": str(getattr(component, "stage", "no stage"))} if issubclass(component, Effect) else {}
