"""`waxstudy plugins check`"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import click

from waxstudy.cli.errors import CHECK_FAILED, DONE
from waxstudy.cli.output import Command
from waxstudy.cli.plugins.lookup import as_json, imported, print_json, print_tables, registered, table

if TYPE_CHECKING:
    from waxstudy.conformance import Outcome


@click.command("check", cls=Command)
@click.argument("target", metavar="MODULE:CLASS|NAME")
@as_json
def command(target: str, as_json: bool) -> int:
    """Check that a component keeps the contract of its kind.

    The component is a registered NAME, or MODULE:CLASS of the current folder or an installed package. Exit code 1 if
    a stage fails; each failure says what to do.
    """
    found = _checked(target)
    failed = any(outcome.status == "failed" for _, outcomes in found for outcome in outcomes)
    if as_json:
        print_json({"passed": not failed, "components": [_as_json(*one) for one in found]})
    else:
        parts: list[object] = []
        for title, outcomes in found:
            parts += [*([""] if parts else []), *_parts(title, outcomes)]
        print_tables(*parts)
    return CHECK_FAILED if failed else DONE


def _checked(target: str) -> list[tuple[str, list[Outcome]]]:
    from waxstudy.conformance import Outcome, check
    from waxstudy.plugin.registry import PluginError

    if ":" not in target:
        return [(str(entry), check(entry.component)) for entry in registered(target)]
    try:
        component = imported(target)
    except PluginError as error:
        module, _, name = target.partition(":")
        claim = f"module '{module}' can be imported and has '{name}'"
        return [(target, [Outcome("import", claim, "failed", [str(error)])])]
    return [(target, check(component))]


def _as_json(title: str, outcomes: Sequence[Outcome]) -> dict[str, Any]:
    return {"component": title, "stages": [asdict(outcome) for outcome in outcomes]}


def _parts(title: str, outcomes: Sequence[Outcome]) -> list[object]:
    stages = table(("stage", "", "what is checked"))
    for outcome in outcomes:
        stages.add_row(outcome.stage, outcome.status, outcome.claim)
    failed = [outcome for outcome in outcomes if outcome.status == "failed"]
    # what could not run for want of an engine is told too, but not what only waits for a stage that failed
    shown = ("failed", "exempt") if failed else ("failed", "exempt", "not run")
    said = [f"{o.stage}: {message}" for o in outcomes if o.status in shown for message in o.messages]
    summary = f"{len(failed)} of {len(outcomes)} stages failed" if failed else "it keeps its contract"
    return [title, "", stages, "", *said, *([""] if said else []), summary]
