"""The components that are installed."""

from __future__ import annotations

import pandas as pd

from waxstudy.plugin import KINDS
from waxstudy.plugin.registry import installed


def components(kind: str | None = None) -> pd.DataFrame:
    """Return a row for each component, of one kind or of all: what it is, and which package has it; by name.

    Raises `ValueError` for a kind that there is not.
    """
    if kind is not None and kind not in KINDS:
        raise ValueError(f"no kind '{kind}': {', '.join(KINDS)}")
    rows = [
        {"kind": of, "name": name, "description": entry.summary, "package": entry.package}
        for (of, name), entry in sorted(installed().components.items())
        if kind in (None, of)
    ]
    return pd.DataFrame(rows, columns=["kind", "name", "description", "package"]).set_index("name")
