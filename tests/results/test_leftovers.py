"""What a killed process was writing is removed by the next that writes there, and nothing else is."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from waxstudy.results import atomic
from waxstudy.results.atomic import PARTIAL, whole_file, whole_folder

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="nothing is locked there")

WRITE = """\
import pathlib, sys, time
from waxstudy.results.atomic import scratch_folder, whole_file, whole_folder
place = pathlib.Path(sys.argv[1])
with whole_file(place / "file.csv") as file, whole_folder(place / "folder") as folder, scratch_folder("waxstudy-test-"):
    file.write_text("half")
    (folder / "data").write_text("half")
    print("writing", flush=True)
    time.sleep(600)
"""


@pytest.fixture
def later(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A process that comes when what was just made is no longer new."""
    monkeypatch.setattr(atomic, "A_MOMENT_S", 0.0)
    monkeypatch.setattr(atomic, "_swept", set())
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()


def writing(place: Path) -> subprocess.Popen[str]:
    environment = {**os.environ, "TMPDIR": str(place / "temporary")}
    command = [sys.executable, "-c", WRITE, str(place)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
    assert process.stdout
    with process.stdout:
        assert process.stdout.readline() == "writing\n"
    return process


def left(place: Path) -> list[str]:
    return sorted(path.name for path in (*place.glob(f"{PARTIAL}*"), *(place / "temporary").iterdir()))


@pytest.mark.usefixtures("later")
def test_what_a_living_process_writes_stays_and_what_a_killed_one_left_goes(tmp_path: Path) -> None:
    process = writing(tmp_path)
    try:
        mine = tmp_path / "notes.partial-"
        mine.write_text("mine\n")
        with whole_file(tmp_path / "other.csv") as path:
            path.write_text("whole")
        assert len(left(tmp_path)) == 3
    finally:
        process.kill()
        process.wait()
    atomic._swept.clear()
    time.sleep(0.01)
    with whole_folder(tmp_path / "other"), atomic.scratch_folder("waxstudy-test-"):
        assert len(left(tmp_path)) == 2
    assert left(tmp_path) == []
    assert mine.read_text() == "mine\n"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["notes.partial-", "other", "other.csv", "temporary"]


def test_what_was_made_a_moment_ago_is_left_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It may be locked in the next."""
    monkeypatch.setattr(atomic, "_swept", set())
    (tmp_path / f"{PARTIAL}new").mkdir()
    with whole_file(tmp_path / "file") as path:
        path.write_text("whole")
    assert (tmp_path / f"{PARTIAL}new").exists()


@pytest.mark.usefixtures("later")
def test_a_link_among_the_leftovers_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "mine").write_text("mine\n")
    os.symlink(tmp_path / "home", tmp_path / f"{PARTIAL}link")
    with whole_file(tmp_path / "file") as path:
        path.write_text("whole")
    assert (tmp_path / "home" / "mine").read_text() == "mine\n"
