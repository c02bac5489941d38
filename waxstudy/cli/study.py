"""The study file as commands read it: its problems become a message and an exit code."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from waxstudy.cli.errors import INVALID, PLUGIN, CommandError

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
