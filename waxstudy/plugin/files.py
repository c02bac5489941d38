"""Files that a user names: regular ones only, and none larger than what it is taken for can be (docs/security.md)."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

TEXT_BYTES = 5_000_000  # of what people write: studies, fragments, descriptions, keys
DATA_BYTES = 2_000_000_000  # of what loggers and weather services write


def read_file(path: Path | str, most_bytes: int = TEXT_BYTES) -> bytes:
    """Return what a file holds.

    Raises `OSError`: of a device, a pipe or a socket, which may never end, of a file of the system that does not tell
    its size, and of a file that is too large, its `strerror` says so.
    """
    with os.fdopen(_open(path, most_bytes), "rb") as file:
        data = file.read(most_bytes + 1)
    if len(data) > most_bytes:  # it grew meanwhile
        raise _too_large(path, most_bytes)
    return data


def check_file(path: Path | str, most_bytes: float = DATA_BYTES) -> None:
    """Raise `OSError` as `read_file` does, for a file that is read by others."""
    os.close(_open(path, most_bytes))


def lacking(path: Path) -> str:
    """Return why a file cannot be had, "" if it can."""
    try:
        check_file(path)
    except IsADirectoryError:
        return "this is a folder, not a file"
    except (FileNotFoundError, NotADirectoryError, ValueError):  # no file has some names
        return "no such file"
    except OSError as error:
        return "no such file" if error.errno == errno.ENAMETOOLONG else f"cannot be read: {error.strerror}"
    return ""


def _open(path: Path | str, most_bytes: float) -> int:
    # without waiting: the other end of a pipe may never come
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    try:
        status = os.fstat(handle)
        if stat.S_ISDIR(status.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
        if not stat.S_ISREG(status.st_mode):
            raise OSError(errno.EINVAL, "it is a device, a pipe or a socket; a regular file is expected", str(path))
        if status.st_size > most_bytes:
            raise _too_large(path, most_bytes)
        if status.st_size == 0 and os.read(handle, 1):  # as those of /proc, some of which never end
            raise OSError(errno.EINVAL, "it does not tell how large it is: copy it to a regular file", str(path))
    except OSError:
        os.close(handle)
        raise
    return handle


def why(error: Exception) -> str:
    """Return why a file cannot be read, in words without its name."""
    return (error.strerror if isinstance(error, OSError) else None) or str(error)


def _too_large(path: Path | str, most_bytes: float) -> OSError:
    return OSError(errno.EFBIG, f"it is larger than {most_bytes / 1e6:g} MB", str(path))
