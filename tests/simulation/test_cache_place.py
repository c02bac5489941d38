"""A cache is used only where nobody else can put something into it."""

from __future__ import annotations

import logging
import os
import sys
from pathlib import Path

import pytest

from waxstudy.simulation import cache_place
from waxstudy.simulation.cache_place import private

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="modes are those of POSIX")


@pytest.fixture(autouse=True)
def anew() -> None:
    cache_place._warn_once.cache_clear()


def test_a_new_cache_is_ours_alone_whatever_the_usual_permissions(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        folder = tmp_path / "cache" / "waxstudy" / "digest"
        assert private(folder) == folder
    finally:
        os.umask(before)
    for each in (folder, folder.parent, folder.parent.parent):
        assert each.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("mode", [0o777, 0o775, 0o757])
@pytest.mark.parametrize("which", ["the folder", "one above"])
def test_what_others_may_write_to_is_told_and_not_used(
    tmp_path: Path, caplog: pytest.LogCaptureFixture, mode: int, which: str
) -> None:
    folder = tmp_path / "above" / "cache"
    folder.mkdir(parents=True)
    wrong = folder if which == "the folder" else folder.parent
    wrong.chmod(mode)
    with caplog.at_level(logging.WARNING):
        assert private(folder) is None
        assert private(folder) is None
    (record,) = caplog.records  # once is enough
    assert f"others may write to {wrong}" in record.getMessage()


def test_a_sticky_folder_above_is_no_danger(tmp_path: Path) -> None:
    (tmp_path / "tmp").mkdir()
    (tmp_path / "tmp").chmod(0o1777)
    assert private(tmp_path / "tmp" / "cache")


@pytest.mark.skipif(os.name != "posix" or os.geteuid() != 0, reason="only root gives files to others")
@pytest.mark.parametrize("which", ["the folder", "one above"])
def test_what_belongs_to_another_user_is_told_and_not_used(tmp_path: Path, which: str) -> None:
    folder = tmp_path / "above" / "cache"
    folder.mkdir(parents=True)
    os.chown(folder if which == "the folder" else folder.parent, 12345, 12345)
    assert private(folder) is None


def test_a_link_is_judged_by_where_it_leads(tmp_path: Path) -> None:
    (tmp_path / "shared").mkdir()
    (tmp_path / "shared").chmod(0o777)
    os.symlink(tmp_path / "shared", tmp_path / "cache")
    assert private(tmp_path / "cache") is None
