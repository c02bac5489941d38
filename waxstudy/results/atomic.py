"""Write files and folders so that a reader sees all of them or nothing, and no two runs write at once.

What is being written is locked by its writer. The system lets go of a lock however a process ends: so what a killed one
left is known, and removed by the next that writes there.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

if sys.platform != "win32":
    import fcntl

PARTIAL = ".partial-"
A_MOMENT_S = 60.0  # in which a file that was just made may not be locked yet
# read once: to ask for it is to change it for a moment, for every thread
UMASK = os.umask(0)
os.umask(UMASK)


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a temporary path to write; it replaces `path` when the block ends well."""
    remove_left(path.parent, PARTIAL)
    handle, name = tempfile.mkstemp(prefix=PARTIAL, suffix=path.suffix, dir=path.parent)
    temporary = Path(name)
    try:
        with _held(handle):
            yield temporary
            temporary.chmod(0o666 & ~UMASK)
            if sys.platform != "win32":
                os.replace(temporary, path)
        if sys.platform == "win32":  # where nothing open is moved
            os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)


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
    temporary = Path(tempfile.mkdtemp(prefix=prefix, dir=parent))
    try:
        if sys.platform == "win32":  # folders cannot be opened there
            yield temporary
        else:
            with _held(os.open(temporary, os.O_RDONLY)):
                yield temporary
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


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
            if _is_left(left):
                left.unlink() if left.is_file() else shutil.rmtree(left, ignore_errors=True)


def _is_left(path: Path) -> bool:
    """Whether something of ours is no longer being written; a clock that was put forward makes it no older."""
    stat = path.lstat()
    if stat.st_uid != os.geteuid() or abs(time.time() - stat.st_ctime) < A_MOMENT_S:
        return False
    handle = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
    try:
        return _lock(handle) is True
    finally:
        os.close(handle)


@contextmanager
def _held(handle: int) -> Iterator[None]:
    """Lock what was just opened, and close it in the end."""
    try:
        if sys.platform != "win32":
            _lock(handle)
        yield
    finally:
        os.close(handle)


def _lock(handle: int) -> bool | None:
    """Take a lock; False where another has it, None on a file system that knows no locks."""
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return None
    return True
