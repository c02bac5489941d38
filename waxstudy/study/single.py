"""One block on its own: from a fragment, or by its name."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from waxstudy.plugin import CHAIN, Choice
from waxstudy.plugin.registry import Registry
from waxstudy.study.check import Check
from waxstudy.study.problems import StudyError, listed
from waxstudy.study.source import read_source
from waxstudy.study.spots import RawTable, Spot


def block_of_fragment(path: Path, registry: Registry, changes: Mapping[str, Any]) -> Choice:
    """Return the one block that a fragment describes, with some values changed; raise `StudyError`."""
    check = Check(read_source(path), registry)
    kinds = [kind for kind in CHAIN if kind in check.source.values]
    if len(kinds) != 1:
        found = f"describes {listed(kinds)}" if kinds else "describes no block"
        check.problem(Spot.table(), f"{found}: one table of {', '.join(f'[{kind}]' for kind in CHAIN)} is needed")
        raise StudyError(check.problems)
    spot = Spot.table(kinds[0])
    values = check.table(spot)
    choice = None if values is None else check.choice(kinds[0], RawTable.of({**values, **changes}, spot))
    if choice is None or check.problems:
        raise StudyError(check.problems)
    return choice
