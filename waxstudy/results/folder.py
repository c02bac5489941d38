"""A run folder as a place: made, held by one run at a time, and kept for the study that it was begun for.

`origin.json` is written when a run begins: the study's file, seen from the folder, and the study as it was read.
"""

from __future__ import annotations

import json
import os
import shlex
import tomllib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from waxstudy.plugin.files import read_file
from waxstudy.results.atomic import sole_use, whole_file

MANIFEST = "run.json"
CASES = "cases"
STUDY = "study.toml"
ORIGIN = "origin.json"


class RunError(Exception):
    """A run folder cannot be read or written; the message says which file and why."""


class OtherStudy(RunError):
    """A run folder holds the results of another study."""


@contextmanager
def run_folder(
    folder: Path, study: Mapping[str, Any] | None = None, file: Path | None = None, *, replaces: bool = False
) -> Iterator[Callable[[], None]]:
    """Make a folder for the run of a study, as it was read from a file, and hold it; give what makes it the study's.

    Raises `RunError` where it holds something else, links elsewhere, or another run is at work; `OtherStudy` where it
    holds the results of another study and that is not to be replaced; `OSError` if it cannot be made.
    """
    if folder.is_dir() and any(folder.iterdir()) and not holds_run(folder):
        raise RunError(f"{folder}: this folder is in use and holds no run; choose another with --out")
    refuse_link(folder / CASES)
    (folder / CASES).mkdir(parents=True, exist_ok=True)
    with sole_use(folder) as is_ours:
        if not is_ours:
            raise RunError(
                f"{folder}: another run is at work in this folder; wait for it, or choose another with --out"
            )
        origin = _origin(folder, _plain(study), file.resolve() if file else None, replaces) if study else None
        yield lambda: _write_origin(folder, origin)


def refuse_link(path: Path) -> None:
    """Raise `RunError` where a folder of a run is a link: what a run writes and deletes is its own."""
    if path.is_symlink():
        raise RunError(
            f"{path}: a link to {os.readlink(path)}; a run writes and deletes in its own folder only: remove the link"
        )


def again(folder: Path) -> str:
    """Say what to type for the study of a folder to be run again, as far as its file is known."""
    file = _study_file(folder, _known(folder))
    if file is None or not file.is_file():
        return "`waxstudy run` the study again"
    here = Path.cwd()
    shown = file.relative_to(here) if file.is_relative_to(here) else file
    return f"`{shlex.join(['waxstudy', 'run', str(shown), '--out', str(folder)])}` computes it again"


def holds_run(folder: Path) -> bool:
    """Say whether a folder holds what a run leaves, finished or not; False for what cannot be a path."""
    return any(os.path.exists(folder / name) for name in (MANIFEST, CASES))


def _origin(folder: Path, study: Mapping[str, Any], file: Path | None, replaces: bool) -> dict[str, Any] | None:
    """Return whose folder it will be, None if no file is known; raise `OtherStudy` where another's results are held."""
    known = _known(folder)
    earlier = _study_file(folder, known)
    if known and not replaces and known["study"] != study and (earlier or file) and earlier != file:
        raise OtherStudy(_refusal(folder, earlier, file))
    if file is None:
        return None
    # a copy that says the same goes on, but the folder stays the first one's as long as that is there
    is_kept = earlier is not None and earlier.exists() and not replaces
    owner = earlier if earlier and is_kept and known and known["study"] == study else file
    return {"study_file": _seen_from(folder, owner), "study": study}


def _write_origin(folder: Path, origin: Mapping[str, Any] | None) -> None:
    if origin is not None:
        with whole_file(folder / ORIGIN) as path:
            path.write_text(json.dumps(origin, indent=1) + "\n")


def _study_file(folder: Path, known: Mapping[str, Any] | None) -> Path | None:
    """Return the file that a folder belongs to; it is kept as seen from there, so that both can be moved together."""
    return (folder / known["study_file"]).resolve() if known and known["study_file"] else None


def _seen_from(folder: Path, file: Path) -> str:
    try:
        return os.path.relpath(file, folder.resolve())
    except ValueError:  # on another drive
        return str(file)


def _plain(study: Any) -> Any:
    """Return a study as JSON gives it back."""
    return json.loads(json.dumps(study, default=str))


def _known(folder: Path) -> dict[str, Any] | None:
    """Return file and study that a folder was begun for, the file "" where that is not recorded; None if nothing is."""
    try:
        known = json.loads(read_file(folder / ORIGIN))
        return {"study_file": str(known["study_file"]), "study": known["study"]}
    except (OSError, ValueError, KeyError, TypeError):
        pass
    try:
        return {"study_file": "", "study": _plain(tomllib.loads(read_file(folder / STUDY).decode()))}
    except (OSError, ValueError):
        return None


def _refusal(folder: Path, earlier: Path | None, file: Path | None) -> str:
    held = str(earlier) if earlier else "another study, whose file is not recorded"
    ours = str(file) if file else "a study without a file"
    return (
        f"{folder}: holds the results of {held}; those of {ours} would take their place; nothing was written. "
        "Name another folder with --out, or say --replace"
    )
