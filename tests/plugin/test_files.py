"""Files that a user names are regular ones of a sensible size, whoever reads them."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.conftest import SMALL, WAXSTUDY
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


@pytest.mark.skipif(not Path("/proc/kallsyms").exists(), reason="no such file")
def test_a_file_that_hides_its_size_is_read_to_the_limit_only(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="larger than"):
        read_file("/proc/kallsyms", 1000)
    check_file("/proc/kallsyms")


def test_a_file_of_the_largest_size_is_read(tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(b"#" * TEXT_BYTES)
    assert len(read_file(tmp_path / "file")) == TEXT_BYTES


# --- every command that reads a file ----------------------------------------------------------------

FRAGMENT = SMALL.replace(
    'actuator = { use = "constant-times"', 'actuator = { from = "odd.toml", use = "constant-times"'
)


def study(folder: Path, odd: Callable[[Path], None]) -> list[str]:
    odd(folder / "odd.toml")
    return ["run", "odd.toml"]


def fragment(folder: Path, odd: Callable[[Path], None]) -> list[str]:
    odd(folder / "odd.toml")
    (folder / "study.toml").write_text(SMALL.replace('{ use = "on-off" }', '{ from = "odd.toml" }'))
    return ["run", "study.toml"]


def description(folder: Path, odd: Callable[[Path], None]) -> list[str]:
    (folder / "record").mkdir()
    (folder / "record" / "data.csv").write_text("time,air_temperature_C\n2024-01-01 00:00,21\n")
    odd(folder / "record" / "dataset.toml")
    return ["diagnose", "record"]


def record(folder: Path, odd: Callable[[Path], None]) -> list[str]:
    (folder / "record").mkdir()
    (folder / "record" / "dataset.toml").write_text('[dataset]\nname = "x"\ninterval_s = 60\n')
    odd(folder / "record" / "data.csv")
    return ["diagnose", "record"]


def displacement(folder: Path, odd: Callable[[Path], None]) -> list[str]:
    odd(folder / "odd.csv")
    return ["fit", "actuator", "odd.csv", "--out", "motor.toml"]


def programme(folder: Path, odd: Callable[[Path], None]) -> list[str]:
    odd(folder / "odd.csv")
    return ["rig", "bench", "--programme", "odd.csv"]


def weather(folder: Path, odd: Callable[[Path], None]) -> list[str]:
    odd(folder / "odd.epw")
    epw = 'use = "epw"\npath = "odd.epw"\nstart = "01-20"\ndays = 7'
    (folder / "study.toml").write_text(SMALL.replace('use = "tallinn-week"\nmonth = "january"', epw))
    return ["run", "study.toml"]


COMMANDS = [study, fragment, description, record, displacement, programme, weather]


@pytest.mark.parametrize("odd", ["pipe", "device"])
@pytest.mark.parametrize("command", COMMANDS)
def test_no_command_waits_for_a_pipe_or_reads_a_device(
    command: Callable[[Path, Callable[[Path], None]], list[str]], odd: str, tmp_path: Path
) -> None:
    done = subprocess.run(
        [str(WAXSTUDY), *command(tmp_path, ODD[odd])], cwd=tmp_path, capture_output=True, text=True, timeout=120
    )
    assert done.returncode in (2, 3), done.stderr
    assert "Traceback" not in done.stderr
    assert "a regular file is expected" in done.stderr
