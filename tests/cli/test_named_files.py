"""Files that a user names: what is no regular file, or too large, is told at once, wherever it is named."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.cli.conftest import Entry
from tests.conftest import SMALL
from waxstudy.plugin.files import TEXT_BYTES

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="devices, pipes and /proc are those of Linux")
INVALID = 3

Make = Callable[[Path], object]


def pipe(path: Path) -> None:
    os.mkfifo(path)


def link_to(target: str) -> Make:
    return lambda path: path.symlink_to(target)


def too_large(path: Path) -> None:
    with path.open("wb") as file:
        file.truncate(TEXT_BYTES + 1)


STRANGE: dict[str, tuple[Make, str]] = {
    "pipe": (pipe, "it is a device, a pipe or a socket; a regular file is expected"),
    "device": (link_to("/dev/zero"), "it is a device, a pipe or a socket; a regular file is expected"),
    "process": (link_to("/proc/self/status"), "it does not tell how large it is: copy it to a regular file"),
}
LARGE = {"large": (too_large, "it is larger than 5 MB")}
strange = pytest.mark.parametrize(("make", "says"), STRANGE.values(), ids=STRANGE)
strange_text = pytest.mark.parametrize(("make", "says"), (STRANGE | LARGE).values(), ids=STRANGE | LARGE)


@strange_text
def test_a_study(entry: Entry, make: Make, says: str) -> None:
    make(Path("study.toml"))
    done = entry("run", "study.toml")
    assert (done.code, done.stderr) == (INVALID, f"study.toml: cannot be read: {says}\n")


@strange_text
def test_a_fragment(entry: Entry, small_study: Path, make: Make, says: str) -> None:
    make(Path("motor.toml"))
    small_study.write_text(SMALL.replace('{ use = "variable-times" }', '{ from = "motor.toml" }'))
    done = entry("run", small_study)
    assert done.code == INVALID
    assert f'actuator.from = "motor.toml": cannot be read: {says}' in done.stderr


@strange_text
def test_a_room_of_a_study(entry: Entry, small_study: Path, make: Make, says: str) -> None:
    make(Path("room.toml"))
    small_study.write_text(SMALL.replace('use = "nzeb"', 'from = "room.toml"'))
    done = entry("run", small_study)
    assert done.code == INVALID
    assert f"cannot be read: {says}" in done.stderr


@strange
def test_weather(entry: Entry, small_study: Path, make: Make, says: str) -> None:
    make(Path("tallinn.epw"))
    weather = 'use = "epw"\npath = "tallinn.epw"\nstart = "01-10"\ndays = 7'
    small_study.write_text(SMALL.replace('use = "tallinn-week"\nmonth = "january"', weather))
    done = entry("run", small_study)
    assert done.code == INVALID
    assert f'path = "tallinn.epw": cannot be read: {says}' in done.stderr


@strange_text
def test_the_description_of_a_record(entry: Entry, make: Make, says: str) -> None:
    Path("room").mkdir()
    make(Path("room/dataset.toml"))
    done = entry("diagnose", "room")
    assert (done.code, done.stderr) == (INVALID, f"room/dataset.toml: cannot be read: {says}\n")


@strange
@pytest.mark.parametrize("named", ["", 'file = "data.csv"'], ids=["beside", "named"])
def test_the_data_of_a_record(entry: Entry, make: Make, says: str, named: str) -> None:
    Path("room").mkdir()
    Path("room/dataset.toml").write_text(f"[dataset]\n{named}\n[nominal]\n")
    make(Path("room/data.csv"))
    done = entry("diagnose", "room")
    assert done.code == INVALID
    assert says in done.stderr


@strange
def test_a_record_of_displacement(entry: Entry, make: Make, says: str) -> None:
    make(Path("motor.csv"))
    done = entry("fit", "actuator", "motor.csv", "--out", "motor.toml")
    assert done.code == INVALID
    assert f"motor.csv: cannot be read: {says}" in done.stderr


@strange_text
def test_a_programme_of_the_bench(entry: Entry, make: Make, says: str) -> None:
    make(Path("programme.csv"))
    done = entry("rig", "bench", "--programme", "programme.csv")
    assert (done.code, done.stderr) == (INVALID, f"programme.csv: cannot be read: {says}\n")


@strange_text
def test_the_key_of_a_blind_test(entry: Entry, make: Make, says: str) -> None:
    Path("set").mkdir()
    make(Path("key"))
    done = entry("blind-test", "make", "--cases", "1", "--out", "set", "--key-file", "key")
    assert (done.code, done.stderr) == (2, f"error: key: cannot be read: {says}\n")
