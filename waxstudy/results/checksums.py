"""Checksums of files: what was edited or damaged since it was written is noticed."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Mapping
from pathlib import Path

from waxstudy.plugin.files import check_file, read_file

SUMS = "SHA256SUMS"  # as the command sha256sum writes and checks it


def write_sums(path: Path, files: Mapping[str, Path]) -> None:
    """Write the SHA-256 of files, each under its name; raise `OSError`."""
    path.write_text("".join(f"{sha256(file)}  {name}\n" for name, file in files.items()), encoding="utf-8")


def changed(folder: Path, names: Iterable[str]) -> str | None:
    """Return the first of these files that is not as the folder's checksums have it; the checksums if they lack it."""
    try:
        lines = read_file(folder / SUMS).decode("utf-8").split("\n")
    except (OSError, ValueError):
        return SUMS
    known = {name: digest for digest, _, name in (line.partition("  ") for line in lines)}
    for name in names:
        if name not in known:
            return SUMS
        try:
            if sha256(folder / name) == known[name]:
                continue
        except OSError:
            pass
        return name
    return None


def sha256(path: Path) -> str:
    """Return a file's SHA-256 in hexadecimal digits; raise `OSError`."""
    check_file(path, math.inf)  # a device in its place has no end
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
