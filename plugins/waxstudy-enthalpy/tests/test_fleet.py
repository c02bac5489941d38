"""Claims about fleets of physical motors, which know their ambient temperature."""

from __future__ import annotations

from pathlib import Path

from waxstudy.api.activating import activate
from waxstudy.plugin.registry import installed
from waxstudy.study.read import read_study

BLOCKS = (
    'controller = { use = "on-off", dead_band_K = 0.5 }, actuator = { use = "enthalpy", product = "B" }, '
    'valve = { use = "quick-opening" }'
)
STUDY = f"""\
[study]
name = "cabinets"
step_s = 10
[room]
use = "nzeb"
[weather.january]
use = "tallinn-week"
month = "january"
[ladder.on-off]
reference = "O_EM"
start = {{ id = "O_EM", {BLOCKS} }}
steps = [ {{ id = "O_SB", modulator = {{ use = "standby", signal = "switched", pulse_s = 88.0 }} }} ]
[activation]
loops = 10
at_h = [30.0]
rebound_h = 0
[activation.draw]
actuator.ambient_C = [15.0, 35.0]
[activation.state.cold]
case = "O_EM"
pause_s = [7200]
[activation.state.standby]
case = "O_SB"
pause_s = [7200]
"""


def test_a_warm_cabinet_opens_sooner_and_lets_pulses_open_the_valve(tmp_path: Path) -> None:
    (tmp_path / "cabinets.toml").write_text(STUDY)
    found = activate(read_study(tmp_path / "cabinets.toml", installed()), tmp_path / "out")
    by_ambient = found.loops.groupby(["state", "actuator.ambient_C"])[["opening_s", "idle_share"]].mean()
    assert by_ambient.loc[("cold", 35.0), "opening_s"] < by_ambient.loc[("cold", 15.0), "opening_s"] - 100.0
    assert by_ambient.loc[("standby", 35.0), "idle_share"] > 0.05 > by_ambient.loc[("standby", 15.0), "idle_share"]
    assert len(found.warnings) == 1
    assert "state 'standby': water flows though nobody asks" in found.warnings[0]
