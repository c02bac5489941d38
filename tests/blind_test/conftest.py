"""A small blind test, made once by the command itself."""

from __future__ import annotations

import fcntl
import os
import shutil
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import entry
from tests.conftest import call
from waxstudy.blind_test.key import Key
from waxstudy.blind_test.make import Place

__all__ = ["entry"]

CASES = 4
# no secret, so that the same records are made every time, and none of them in EnergyPlus, installed or not
KEY = Key(12356, 32 * "c")
DATA = "WAXSTUDY_DATA"
NONE = '{"verdict": "none"}'


@pytest.fixture(scope="session")
def finished_test(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with four records in `test` and their key in `key`; not to be changed.

    Processes that test side by side share it: who comes later waits for it.
    """
    own = tmp_path_factory.getbasetemp()
    folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "blind"
    folder.mkdir(exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "made").exists():
            (folder / "key").write_text(f"{KEY}\n")
            done = call(folder, "blind-test", "make", "--cases", CASES, "--out", "test", "--key-file", "key")
            assert done.returncode == 0, done.stderr
            (folder / "made").touch()
    return folder


@pytest.fixture
def small_test(finished_test: Path, tmp_path: Path) -> Path:
    """A copy of the folder `test`, its key beside it."""
    return copied(finished_test, tmp_path)


def copied(made: Path, place: Path) -> Path:
    """Copy the folder `test` and its key; return the copy of `test`."""
    shutil.copy(made / "key", place / "key")
    return shutil.copytree(made / "test", place / "test")


def answered_by(made: Path, place: Path, name: str, text: str) -> Path:
    """Copy the folder `test` and let a diagnoser answer that says the same of every record; return the place."""
    copied(made, place)
    done = call(place, "blind-test", "solve", "test", "--name", name, "--", *answering(place, text))
    assert done.returncode == 0, done.stderr
    return place


@pytest.fixture
def place(small_test: Path) -> Place:
    return Place(small_test)


@pytest.fixture
def key() -> Key:
    """The key of every copy of the small test."""
    return KEY


def answering(folder: Path, text: str) -> list[str]:
    """Return a command that prints the same of every dataset."""
    script = folder / "answer.py"
    script.write_text(f"import sys, pathlib\nassert pathlib.Path(sys.argv[1], 'data.csv').exists()\nprint({text!r})\n")
    return [sys.executable, str(script)]
