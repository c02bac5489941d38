"""Two small runs: one with everything that a figure can ask for, one with as little as a study may have."""

from __future__ import annotations

from pathlib import Path

import pytest

from waxstudy.plugin.registry import installed
from waxstudy.report.content import Content, gather
from waxstudy.results.run import Run
from waxstudy.simulation.run import run
from waxstudy.study.read import read_study

FULL = """
[study]
name = "small"
step_s = 20
[room]
use = "nzeb"
[weather.cold]
use = "tallinn-week"
month = "january"
[weather.sunny]
use = "tallinn-week"
month = "february"
[ensemble]
members = 2
[output]
trace_interval_s = 60
[ladder.switching]
reference = "precise"
start = { id = "rough", controller = { use = "on-off", dead_band_K = 2.0 } }
steps = [{ id = "precise", controller = { dead_band_K = 0.5 } }]
[ladder.steady]
reference = "motor"
start = { id = "usual", controller = { use = "pi", gain = 0.3, integration_time_s = 300.0, tracking_time_s = 30.0 } }
steps = [
  { id = "pulsed", modulator = { use = "pwm" } },
  { id = "motor", actuator = { use = "variable-times", product = "B" } },
]
"""
BARE = """
[study]
name = "bare"
step_s = 20
[room]
use = "nzeb"
[weather.cold]
use = "tallinn-week"
month = "january"
[ensemble]
members = 1
[output]
trace_members = 0
[ladder.only]
reference = "single"
start = { id = "single", controller = { use = "on-off", dead_band_K = 1.0 } }
steps = []
"""


def computed(text: str, place: Path) -> Content:
    file = place / "study.toml"
    file.write_text(text)
    study = read_study(file, installed())
    run(study, place / "run")
    return gather(Run(place / "run"), study)


@pytest.fixture(scope="session")
def small(tmp_path_factory: pytest.TempPathFactory) -> Content:
    return computed(FULL, tmp_path_factory.mktemp("small"))


@pytest.fixture(scope="session")
def bare(tmp_path_factory: pytest.TempPathFactory) -> Content:
    return computed(BARE, tmp_path_factory.mktemp("bare"))
