"""Files that a user names are regular ones of a sensible size; tests/cli/test_named_files.py asks every command."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest

from waxstudy.plugin.files import TEXT_BYTES, check_file, read_file

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no devices and pipes of this kind there")


def pipe(path: Path) -> None:
    os.mkfifo(path)


def zeros(path: Path) -> None:
    os.symlink("/dev/zero", path)


def large(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(TEXT_BYTES + 1)


ODD = {"pipe": pipe, "device": zeros, "large": large}


@pytest.mark.parametrize("odd", ODD)
def test_what_is_no_file_that_somebody_wrote_is_refused_at_once(odd: str, tmp_path: Path) -> None:
    ODD[odd](tmp_path / "odd")
    with pytest.raises(OSError, match="larger than 5 MB" if odd == "large" else "a regular file is expected"):
        read_file(tmp_path / "odd")


def test_a_file_of_the_largest_size_is_read(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"#" * TEXT_BYTES)
    assert len(read_file(tmp_path / "file")) == TEXT_BYTES


def test_a_file_that_is_too_large_is_refused_before_others_read_it(tmp_path: Path) -> None:
    path = tmp_path / "data.csv"
    path.write_bytes(b"time")
    check_file(path, 4)
    with pytest.raises(OSError, match="it is larger than"):
        check_file(path, 3)
