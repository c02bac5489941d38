"""The generated pages of the reference, by their path in the site: what the program says of itself, as it is now."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module

from docs_site.commands import commands
from docs_site.components import components, effects
from docs_site.keys import dataset_keys, study_keys
from docs_site.tables import table
from waxstudy import _PLACES
from waxstudy.report.diagnosis import criteria


def python() -> str:
    """Every public name of `waxstudy`, for mkdocstrings, which reads its docstring."""
    entries = []
    for name in sorted(_PLACES, key=str.lower):
        place = getattr(import_module(_PLACES[name]), name)
        if hasattr(place, "__qualname__"):  # `hookimpl` is pluggy's
            entries.append(f"::: {place.__module__}.{place.__qualname__}\n")
    intro = "Each name that `import waxstudy as wx` gives. [Work from Python](../python.md) shows them at work.\n\n"
    return "# Python\n\n" + intro + "\n".join(entries)


def limits() -> str:
    """The criteria of the diagnosis."""
    listed = criteria.table()
    intro = (
        "Every limit that decides what a diagnosis says, as `waxstudy diagnose --criteria` prints them. "
        "[How a diagnosis is found](../diagnosis-method.md) says how they work together.\n\n"
    )
    return "# Criteria\n\n" + intro + table(listed.names, listed.texts)


PAGES: Mapping[str, Callable[[], str]] = {
    "reference/commands.md": commands,
    "reference/study-keys.md": study_keys,
    "reference/dataset-keys.md": dataset_keys,
    "reference/python.md": python,
    "reference/components.md": components,
    "reference/effects.md": effects,
    "reference/criteria.md": limits,
}
