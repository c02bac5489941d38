"""The study file as commands read it: its problems become a message and an exit code."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from waxstudy.cli.errors import INVALID, PLUGIN, USAGE, CommandError

if TYPE_CHECKING:
    from waxstudy.study.model import Study


def load_study(path: Path, *, needs_files: bool = True) -> Study:
    """Read a study file; turn its problems into exit code 3, or 4 where a plugin is at fault."""
    from waxstudy.plugin.registry import installed
    from waxstudy.study.read import StudyError, read_study

    try:
        return read_study(path, installed(), needs_files=needs_files)
    except StudyError as error:
        raise CommandError(str(error), PLUGIN if error.is_plugin_fault else INVALID, label="") from error


def known(option: str, given: Sequence[str], allowed: Sequence[str]) -> None:
    """Refuse a name that is none of those allowed, with the nearest of them."""
    from waxstudy.plugin.registry import hint

    for name in given:
        if name not in allowed:
            told = f"{option} {name}: there is none{hint(name, allowed)} (allowed: {', '.join(allowed)})"
            raise CommandError(told, USAGE)
