"""The cache of compiled blocks may be damaged or out of reach; a run goes on without it."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from tests.cli.folders import contents
from tests.conftest import Waxstudy

pytestmark = pytest.mark.slow  # every run compiles


@pytest.fixture
def same(waxstudy: Waxstudy, small_study: Path, finished: Path) -> object:
    """Run the small study with a cache and compare with the run that had the usual one."""

    def check(cache: Path) -> None:
        done = waxstudy("run", small_study, "--out", f"run-{random.random()}", env={"WAXSTUDY_CACHE": str(cache)})
        assert (done.returncode, done.stderr) == (0, "")
        folder = small_study.parent / done.stdout.splitlines()[-1]
        assert contents(folder) == contents(finished)

    return check


def damage(cache: Path, pattern: str, data: bytes) -> None:
    files = [file for file in cache.rglob(pattern) if file.is_file()]
    assert files
    for file in files:
        file.write_bytes(data)


def test_damaged_files_in_the_cache_are_replaced(same, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    cache, noise = tmp_path / "cache", random.Random(3).randbytes(600)
    same(cache)
    for pattern, data in (("*.nbi", noise), ("*.nbc", noise), ("*.nb?", b"")):
        damage(cache, pattern, data)
        same(cache)


def test_a_cache_that_cannot_be_written_is_done_without(same, tmp_path: Path) -> None:  # type: ignore[no-untyped-def]
    (tmp_path / "file").write_text("not a folder\n")
    same(tmp_path / "file")
    same(Path("/proc/waxstudy"))
    assert (tmp_path / "file").read_text() == "not a folder\n"
