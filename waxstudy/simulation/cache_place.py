"""Where caches lie, and whether that place is ours alone: compiled code is run when it is read back."""

from __future__ import annotations

import logging
import os
import stat
from functools import cache
from pathlib import Path

log = logging.getLogger(__name__)


def cache_base() -> Path:
    """Folder of all caches: `WAXSTUDY_CACHE`, or that of waxstudy in the user's cache folder."""
    if named := os.environ.get("WAXSTUDY_CACHE"):
        return Path(named).absolute()
    of_user = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return Path(of_user, "waxstudy").absolute()


def private(folder: Path) -> Path | None:
    """Make a folder that nobody else can write to, and return it; None, with a warning, where it cannot be one."""
    try:
        _make(folder)
        wrong = _open_to_others(folder.resolve())
    except OSError as error:
        log.info("nothing can be cached in %s: %s", folder, error)
        return None
    if wrong:
        _warn_once(wrong)
    return None if wrong else folder


def _make(folder: Path) -> None:
    missing = [each for each in (folder, *folder.parents) if not each.exists()]
    for each in reversed(missing):
        each.mkdir(mode=0o700, exist_ok=True)


def _open_to_others(folder: Path) -> str:
    """Return why somebody else could put something into a folder, "" if nobody can.

    Whoever may write to a folder above may put another in its place, unless that is sticky, as /tmp is.
    """
    if os.name != "posix":
        return ""
    for each in (folder, *folder.parents):
        status = each.stat()
        is_base = each == folder
        if status.st_uid != os.geteuid() and (is_base or status.st_uid != 0):
            return f"{each} belongs to another user"
        is_shared = bool(status.st_mode & (stat.S_IWGRP | stat.S_IWOTH))
        if is_shared and (is_base or not status.st_mode & stat.S_ISVTX):
            return f"others may write to {each}"
    return ""


@cache
def _warn_once(wrong: str) -> None:
    log.warning(
        "warning: nothing is cached, as %s: code that lay there would be run (WAXSTUDY_CACHE names another)", wrong
    )
