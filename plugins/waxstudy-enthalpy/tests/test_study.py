"""The motor in a study, from the command line, in place of the empirical one."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
from pathlib import Path

STUDY = """\
[study]
name = "motors"

[room]
use = "nzeb"

[weather.january]
use = "tallinn-week"
month = "january"

[ensemble]
members = 2

[ladder.on-off]
reference = "O_WM"
start = { id = "O_VC", controller = { use = "on-off", dead_band_K = 0.5 }, valve = { use = "quick-opening" } }
steps = [
  { id = "O_WM", actuator = { use = "variable-times", product = "B" } },
  { id = "O_EN", actuator = { use = "enthalpy", product = "B" } },
  { id = "O_EN_cool", actuator = { ambient_C = 15.0 } },
]
"""


def waxstudy(folder: Path, *arguments: str) -> str:
    command = [str(Path(sys.executable).with_name("waxstudy")), *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, env=os.environ)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_it_runs_in_a_ladder_in_place_of_the_empirical_motor(tmp_path: Path) -> None:
    (tmp_path / "motors.toml").write_text(STUDY)
    waxstudy(tmp_path, "run", "motors.toml", "--out", "run", "--quiet")
    rows = {
        row["case"]: row for row in csv.DictReader(waxstudy(tmp_path, "report", "run", "--format", "csv").splitlines())
    }
    assert list(rows) == ["O_VC", "O_WM", "O_EN", "O_EN_cool"]
    empirical, physical = (float(rows[case]["heat_kWh_m2_week"]) for case in ("O_WM", "O_EN"))
    assert 0.0 < abs(physical / empirical - 1.0) < 0.05


def test_the_command_line_shows_it_with_its_package(tmp_path: Path) -> None:
    shown = waxstudy(tmp_path, "plugins", "show", "enthalpy")
    assert "actuator 'enthalpy' of waxstudy-enthalpy" in shown
    assert "friction_N" in shown
