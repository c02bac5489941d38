"""Write files and folders so that a reader sees all of them or nothing, and no two runs write at once.

What is being written is locked by its writer. The system lets go of a lock however a process ends: so what a killed one
left is known, and removed by the next that writes there. A writer whose file was taken for such a leftover before it
was locked makes another.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

if sys.platform != "win32":
    import fcntl

PARTIAL = ".partial-"
# read once: to ask for it is to change it for a moment, for every thread
UMASK = os.umask(0)
os.umask(UMASK)


@contextmanager
def whole_file(path: Path, mode: int = 0o666) -> Iterator[Path]:
    """Give a temporary path to write; it replaces `path` when the block ends well, for those that `mode` allows."""
    remove_left(path.parent, PARTIAL)
    with _ours(lambda: _new_file(path)) as temporary:
        yield temporary
        temporary.chmod(mode & ~UMASK)
        os.replace(temporary, path)


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """Give a temporary folder to fill; it becomes `path` when the block ends well."""
    with _folder_of_its_own(path.parent, PARTIAL) as temporary:
        yield temporary
        temporary.chmod(0o777 & ~UMASK)
        if path.is_symlink():  # what it leads to is somebody else's
            path.unlink()
        shutil.rmtree(path, ignore_errors=True)
        os.replace(temporary, path)


@contextmanager
def scratch_folder(prefix: str) -> Iterator[Path]:
    """Give a folder that is gone when the block ends, among the system's temporary ones; a prefix is of one command."""
    with _folder_of_its_own(Path(tempfile.gettempdir()), prefix) as temporary:
        yield temporary


@contextmanager
def _folder_of_its_own(parent: Path, prefix: str) -> Iterator[Path]:
    remove_left(parent, prefix)
    with _ours(lambda: Path(tempfile.mkdtemp(prefix=prefix, dir=parent))) as temporary:
        yield temporary


@contextmanager
def sole_use(folder: Path) -> Iterator[bool]:
    """Lock a folder and say whether that succeeded; the system lets go of the lock however the process ends."""
    if sys.platform == "win32":
        yield True
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        yield _lock(handle) is not False
    finally:
        os.close(handle)


_swept: set[tuple[Path, str]] = set()  # once in a process is enough


def remove_left(parent: Path, prefix: str) -> None:
    """Remove what writers that are no longer there left of this name in a folder."""
    place = parent.absolute(), prefix
    if place in _swept or sys.platform == "win32":
        return
    _swept.add(place)
    for left in parent.glob(f"{prefix}*"):
        with suppress(OSError):
            if left.lstat().st_uid == os.geteuid():
                _remove_unless_held(left)


def _remove_unless_held(path: Path) -> None:
    """Remove what nobody is writing; locked to the end, so that its writer does not take it for its own."""
    handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    try:
        if _lock(handle) is True:
            _remove(path)
    finally:
        os.close(handle)


def _new_file(path: Path) -> Path:
    handle, name = tempfile.mkstemp(prefix=PARTIAL, suffix=path.suffix, dir=path.parent)
    os.close(handle)
    return Path(name)


@contextmanager
def _ours(make: Callable[[], Path]) -> Iterator[Path]:
    """Make something and keep it locked while the block runs; what is left of it then is removed."""
    if sys.platform == "win32":  # folders cannot be opened there, and nothing open is moved
        path, handle = make(), None
    else:
        path, handle = _locked(make)
    try:
        yield path
    finally:
        _remove(path)
        if handle is not None:
            os.close(handle)


def _locked(make: Callable[[], Path]) -> tuple[Path, int]:
    while True:
        path = make()
        with suppress(FileNotFoundError):
            handle = os.open(path, os.O_RDONLY)
            if _lock(handle) is not False and path.exists():
                return path, handle
            os.close(handle)


def _remove(path: Path) -> None:
    if path.is_dir():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _lock(handle: int) -> bool | None:
    """Take a lock; False where another has it, None on a file system that knows no locks."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True
