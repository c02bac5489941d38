"""The components that are installed."""

from __future__ import annotations

import pandas as pd

from waxstudy.plugin import KINDS, Component
from waxstudy.plugin.registry import installed


def components(kind: str | None = None) -> pd.DataFrame:
    """Return a row for each component, of one kind or of all: what it is, and which package has it; by name.

    Raises `ValueError` for a kind that there is not.
    """
    if kind is not None and kind not in KINDS:
        raise ValueError(f"no kind '{kind}': {', '.join(KINDS)}")
    registry = installed()
    rows = [
        {
            "kind": of,
            "name": name,
            "description": first_sentence(component.component),
            "package": component.package,
        }
        for (of, name), component in sorted(registry.components.items())
        if kind in (None, of)
    ]
    frame = pd.DataFrame(rows, columns=["kind", "name", "description", "package"])
    return frame.set_index("name")


def first_sentence(component: type[Component]) -> str:
    """Return what a component is: the first line of its docstring, up to its colon or full stop."""
    lines = (component.__doc__ or "").strip().splitlines()
    return lines[0].split(": ")[0].split(". ")[0].rstrip(".") if lines else ""
