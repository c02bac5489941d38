"""Which study file a run folder belongs to, told as its place seen from the folder: both may move together."""

from __future__ import annotations

import json
import os
from pathlib import Path

MANIFEST = "run.json"
RESOLVED = "study.toml"


def recorded(folder: Path) -> str:
    """Return what the manifest says; "" where there is none, or one that is damaged or older than this entry."""
    try:
        manifest = json.loads((folder / MANIFEST).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ""
    said = manifest.get("study_file") if isinstance(manifest, dict) else None
    return said if isinstance(said, str) else ""


def origin(folder: Path, study_file: Path) -> str:
    """Return what the manifest is to say; the folder's own resolved study stands for the one that it was made of."""
    place, folder = study_file.resolve(), folder.resolve()
    if place == folder / RESOLVED:
        return recorded(folder)
    return Path(os.path.relpath(place, folder)).as_posix()


def other_study(folder: Path, study_file: Path) -> str:
    """Return the study file that the run in a folder is of, if that is another, else "".

    A file of the same name is taken for the same study, moved, where the earlier one has gone.
    """
    earlier = recorded(folder)
    if not earlier or earlier == origin(folder, study_file):
        return ""
    place = folder.resolve() / earlier
    if place.name == study_file.name and not place.exists():
        return ""
    return os.path.relpath(place)
