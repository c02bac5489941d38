"""The generated pages of the reference, by their path in the site: what the program says of itself, as it is now."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module

from docs_site.commands import commands
from docs_site.components import components, effects
from docs_site.folders import folders
from docs_site.keys import dataset_keys, study_keys
from docs_site.stages import stages
from waxstudy import _PLACES


def python() -> str:
    """Every public name of `waxstudy`, for mkdocstrings, which reads its docstring."""
    entries = []
    for name in sorted(_PLACES, key=str.lower):
        place = getattr(import_module(_PLACES[name]), name)
        if hasattr(place, "__qualname__"):  # `hookimpl` is pluggy's
            entries.append(f"::: {place.__module__}.{place.__qualname__}\n")
    intro = "Each name that `import waxstudy as wx` gives. [waxstudy from Python](../python.md) shows them at work.\n\n"
    return "# Python\n\n" + intro + "\n".join(entries)


PAGES: Mapping[str, Callable[[], str]] = {
    "reference/commands.md": commands,
    "reference/study-keys.md": study_keys,
    "reference/dataset-keys.md": dataset_keys,
    "reference/python.md": python,
    "reference/components.md": components,
    "reference/effects.md": effects,
    "reference/stages.md": stages,
    "reference/folders.md": folders,
}
