"""A plugin of `waxstudy export energyplus` in a run of EnergyPlus moves the water as the block does here."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.cli.conftest import Entry
from tests.conftest import ROOT
from waxstudy.plugin import Choice
from waxstudy.plugin.registry import installed
from waxstudy.simulation.chain import Stepped
from waxstudy_energyplus import objects

FULL_KG_S = 0.034


@pytest.mark.slow
@pytest.mark.usefixtures("energyplus")
def test_a_plugin_moves_the_water_of_a_radiant_floor_as_the_block_does_here(entry: Entry, tmp_path: Path) -> None:
    where = ("--zone", objects.ZONE, "--radiant", objects.RADIANT_FLOOR, "--full-flow-kg-s", FULL_KG_S)
    assert entry("export", "energyplus", "--use", "variable-times", *where, "--out", "motor.py").code == 0
    (tmp_path / "run").mkdir()
    command = [sys.executable, "-m", "tests.energyplus.in_engine", str(tmp_path / "motor.py"), str(tmp_path / "run")]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    thermostat = Stepped(Choice.of(installed().get("controller", "on-off"), {"dead_band_K": 0.5}), 5.0)
    motor = Stepped(Choice.of(installed().get("actuator", "variable-times"), {}), 5.0)
    expected = []
    for minute, (air_C, _) in enumerate(found["rows"]):
        times_s = [60.0 * minute + 5.0 * n for n in range(12)]
        expected.append(np.mean([motor.step(thermostat.step(21.0 - air_C, t), t) for t in times_s]))
    flows = np.array([flow for _, flow in found["rows"]]) / FULL_KG_S
    np.testing.assert_allclose(flows, expected, rtol=0.0, atol=1e-9)
    assert (flows.min(), flows.max()) == (0.0, 1.0)
    assert max(found["heat_W"]) > 100.0
