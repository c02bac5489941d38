"""The cache of compiled blocks may be damaged or out of reach; a run goes on without it."""

from __future__ import annotations

import os
import pickle
import random
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli.folders import contents
from tests.conftest import ONE_CASE, Waxstudy

Same = Callable[[Path], None]
pytestmark = pytest.mark.slow  # every run compiles


@pytest.fixture
def one_case(tmp_path: Path) -> Path:
    """A study of one case: there is one chain to compile."""
    path = tmp_path / "one.toml"
    path.write_text(ONE_CASE)
    return path


@pytest.fixture
def same(waxstudy: Waxstudy, one_case: Path) -> Same:
    """Run the study with a cache and compare with the run that had the usual one."""
    assert waxstudy("run", one_case, "--out", "usual").returncode == 0

    def check(cache: Path) -> None:
        done = waxstudy("run", one_case, "--out", f"run-{random.random()}", env={"WAXSTUDY_CACHE": str(cache)})
        assert (done.returncode, done.stderr) == (0, "")
        folder = one_case.parent / done.stdout.splitlines()[-1]
        assert contents(folder) == contents(one_case.parent / "usual")

    return check


def damage(cache: Path, pattern: str, damaged: Callable[[bytes], bytes]) -> None:
    files = list(cache.rglob(pattern))
    assert files
    for file in files:
        file.write_bytes(damaged(file.read_bytes()))


def test_damaged_files_in_the_cache_are_replaced(same: Same, tmp_path: Path) -> None:
    cache, noise = tmp_path / "cache", random.Random(3).randbytes(600)
    same(cache)
    damage(cache, "*.nbi", lambda data: noise)
    same(cache)
    damage(cache, "*.nbc", lambda data: data[: len(data) // 2])
    same(cache)


def test_a_cache_that_cannot_be_written_is_done_without(same: Same, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("not a folder\n")
    same(tmp_path / "file")
    same(Path("/proc/waxstudy"))
    assert (tmp_path / "file").read_text() == "not a folder\n"


def test_code_that_others_planted_in_a_shared_cache_is_not_run(
    waxstudy: Waxstudy, one_case: Path, tmp_path: Path
) -> None:
    """The cache's index is unpickled, which runs what it says."""
    cache, marker = tmp_path / "cache", tmp_path / "planted"
    command, environment = ("run", one_case, "--out"), {"WAXSTUDY_CACHE": str(cache)}
    assert waxstudy(*command, "first", env=environment).returncode == 0
    assert cache.stat().st_mode & 0o777 == 0o700
    damage(cache, "*.nbi", lambda data: pickle.dumps(Planted(marker)))
    cache.chmod(0o777)
    done = waxstudy(*command, "second", env=environment)
    assert done.returncode == 0
    assert done.stderr == (
        f"warning: nothing is cached, as others may write to {cache}: code that lay there would be run "
        "(WAXSTUDY_CACHE names another)\n"
    )
    assert not marker.exists()
    cache.chmod(0o700)
    waxstudy(*command, "third", env=environment)
    assert marker.exists()  # so it would have been


class Planted:
    def __init__(self, marker: Path) -> None:
        self.marker = marker

    def __reduce__(self) -> tuple[object, tuple[str, ...]]:
        return os.mkdir, (str(self.marker),)
