"""Components and effects of every installed plugin, read from the registry."""

from __future__ import annotations

import inspect
from collections.abc import Collection, Iterator, Mapping

from docs_site.keys import HEAD, Node, row
from docs_site.tables import plain, table
from waxstudy.plugin import KINDS, Effect
from waxstudy.plugin.effect import STAGES
from waxstudy.plugin.registry import Registered, installed
from waxstudy.study.schema import described, needed_keys


def components() -> str:
    """Return the page of what a study or a dataset may `use`, kind by kind."""
    intro = "What `use` may name in a study or a dataset, with its keys. [Plugins](../plugins.md) adds more.\n\n"
    kinds = [kind for kind in KINDS if kind != Effect.kind]
    parts = [part for kind in kinds for part in (f"## {kind}\n", *map(_section, _of(kind)))]
    return "# Components\n\n" + intro + "\n".join(parts)


def effects() -> str:
    """Return the page of what a diagnosis may find, stage by stage."""
    intro = (
        "What a diagnosis looks for, in the order of the loop. [Effects](../effects.md) says what they are made of and "
        "where they cannot be told apart.\n\n"
    )
    return "# Effects\n\n" + intro + "\n".join(_staged())


def _of(kind: str) -> list[Registered]:
    registry = installed()
    return [registry.components[kind, name] for name in sorted(registry.names(kind))]


def _staged() -> Iterator[str]:
    found = [(entry.component, entry) for entry in _of(Effect.kind)]
    for stage in STAGES:
        entries = [entry for one, entry in found if issubclass(one, Effect) and one.stage == stage]
        if entries:
            yield f"## {stage}\n"
            yield from map(_section, entries)


def _section(entry: Registered) -> str:
    component = entry.component
    parts = [f"### {component.name}", plain(inspect.cleandoc(component.__doc__ or ""))]
    if entry.package != "waxstudy":
        parts.append(f"From the package `{entry.package}`.")
    keys = {name: node for name, node in described(component)["properties"].items() if name != "use"}
    needed = needed_keys(component)
    if keys:
        parts.append(table(HEAD, list(_rows(keys, needed))))
    if issubclass(component, Effect) and component.priors:
        parts.append(table(("looked for", "from", "to", "scale", "noticeable"), _priors(component)))
    return "\n\n".join(parts) + "\n"


def _rows(keys: Mapping[str, Node], needed: Collection[str], within: str = "") -> Iterator[tuple[str, ...]]:
    """Yield a row for each key; those of a table inside are written as a study file does, `circuit.spacing_m`."""
    for name, node in keys.items():
        if inner := node.get("properties"):
            yield from _rows(inner, node.get("required", ()), f"{within}{name}.")
        else:
            yield row(f"{within}{name}", node, name in needed)


def _priors(effect: type[Effect]) -> Iterator[tuple[str, ...]]:
    """Where each parameter is looked for; on a log scale the least departure worth naming is a factor."""
    for name, prior in effect.priors.items():
        scale, times = ("log", "× ") if prior.is_log else ("linear", "")
        yield (f"`{name}`", f"{prior.low:g}", f"{prior.high:g}", scale, f"{times}{prior.noticeable:g}")
