"""What a killed process was writing is removed by the next that writes there, and nothing else is."""

from __future__ import annotations

import os
import subprocess
import sys
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
    """A process that has not looked for leftovers yet, with temporary files of its own."""
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
    with whole_folder(tmp_path / "other"), atomic.scratch_folder("waxstudy-test-"):
        assert len(left(tmp_path)) == 2
    assert left(tmp_path) == []
    assert mine.read_text() == "mine\n"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["notes.partial-", "other", "other.csv", "temporary"]


WRITE_OFTEN = """\
import pathlib, sys
from waxstudy.results import atomic
place = pathlib.Path(sys.argv[1])
for number in range(400):
    atomic._swept.clear()
    with atomic.whole_folder(place / sys.argv[2]) as folder, atomic.whole_file(folder / "data") as file:
        file.write_text(str(number))
    assert (place / sys.argv[2] / "data").read_text() == str(number)
"""


def test_who_writes_and_who_removes_leftovers_at_one_time_do_not_hinder_each_other(tmp_path: Path) -> None:
    names = ["one", "two", "three"]
    command = [sys.executable, "-c", WRITE_OFTEN, str(tmp_path)]
    processes = [subprocess.Popen([*command, name], stderr=subprocess.PIPE, text=True) for name in names]
    assert [process.communicate()[1] for process in processes] == ["", "", ""]
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)


@pytest.mark.usefixtures("later")
def test_a_link_among_the_leftovers_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "mine").write_text("mine\n")
    os.symlink(tmp_path / "home", tmp_path / f"{PARTIAL}link")
    with whole_file(tmp_path / "file") as path:
        path.write_text("whole")
    assert (tmp_path / "home" / "mine").read_text() == "mine\n"
