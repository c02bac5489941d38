"""A small fleet: ten loops, coarse steps, a call in the second day."""

from __future__ import annotations

from pathlib import Path

import pytest

from waxstudy.api.activating import activate
from waxstudy.fleet.result import Activated
from waxstudy.plugin.registry import installed
from waxstudy.study.model import Study
from waxstudy.study.read import study_of
from waxstudy.study.source import read_source

FLEET = """\
[study]
name = "fleet"
step_s = 10
[room]
use = "nzeb"
[weather.january]
use = "tallinn-week"
month = "january"
[ladder.pi]
reference = "P_WM"
start = { id = "P_WM", BLOCKS }
steps = [ { id = "P_SB", modulator = { use = "standby" } } ]
[activation]
loops = 10
at_h = [30.0]
rebound_h = 1
[activation.draw]
actuator.product = ["A", "B"]
room.window_g = [0.3, 0.5]
setpoint_C = { mean = 21.5, sd = 0.3 }
flow_share = { low = 0.7, high = 1.0 }
[activation.state.cold]
case = "P_WM"
pause_s = [7200]
[activation.state.natural]
case = "P_WM"
[activation.state.preheated]
case = "P_WM"
pause_s = [7200]
preheat_s = 120
[activation.state.standby]
case = "P_SB"
pause_s = [7200]
""".replace(
    "BLOCKS",
    'controller = { use = "pi", gain = 18.0, integration_time_s = 2300.0 }, modulator = { use = "pwm" }, '
    'actuator = { use = "variable-times", product = "B" }, valve = { use = "quick-opening" }',
)


def study(folder: Path, text: str = FLEET) -> Study:
    """Return the study of a text, read from a file as a user's is."""
    path = folder / "fleet.toml"
    path.write_text(text)
    return study_of(read_source(path), installed(), path)


@pytest.fixture(scope="session")
def called(tmp_path_factory: pytest.TempPathFactory) -> Activated:
    """The small fleet after its call, by one worker; not to be changed."""
    folder = tmp_path_factory.mktemp("called")
    return activate(study(folder), folder / "out", workers=1)
