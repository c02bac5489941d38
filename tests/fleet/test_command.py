"""Claims about `waxstudy run` of a study with `[activation]`: the same bytes by any way, and every mistake told."""

from __future__ import annotations

import json
import re
import subprocess
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

import waxstudy as wx
from tests.cli.conftest import Entry, entry
from tests.conftest import WAXSTUDY
from tests.fleet.conftest import FLEET, study
from waxstudy.api.activating import activate
from waxstudy.plugin import SimulationError
from waxstudy.report.fleet.tables import render
from waxstudy.simulation.run import Progress
from waxstudy.study.spread import spread_of

__all__ = ["entry"]

USAGE, INVALID, FAILED = 2, 3, 6
WRITTEN = ("activation.json", "response.parquet", "loops.parquet", "activation.csv", "report.html")
COLD = FLEET.partition("[activation.state.natural]")[0]  # one state
LONG = COLD.replace("loops = 10", "loops = 80").replace("step_s = 10", "step_s = 20")


def contents(folder: Path) -> dict[str, bytes]:
    return {name: (folder / name).read_bytes() for name in WRITTEN}


def batches(folder: Path) -> dict[str, int]:
    return {file.name: file.stat().st_mtime_ns for file in (folder / "batches").glob("[!.]*.parquet")}


def test_a_larger_fleet_takes_over_the_loops_of_a_smaller_one_and_workers_change_nothing(tmp_path: Path) -> None:
    activate(study(tmp_path, COLD.replace("loops = 10", "loops = 20")), tmp_path / "grown")
    first = batches(tmp_path / "grown")
    larger = study(tmp_path, COLD.replace("loops = 10", "loops = 30"))
    activate(larger, tmp_path / "grown", workers=1)
    assert first.items() <= batches(tmp_path / "grown").items()
    activate(larger, tmp_path / "whole", workers=3)
    assert contents(tmp_path / "grown") == contents(tmp_path / "whole")


@pytest.mark.slow
def test_a_call_that_is_killed_loses_no_finished_batch(entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "long.toml").write_text(LONG)
    command = [str(WAXSTUDY), "run", "long.toml", "--out", "killed", "--quiet"]
    process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and not batches(tmp_path / "killed"):
        time.sleep(0.02)
    process.kill()
    process.wait()
    kept = batches(tmp_path / "killed")
    assert 1 <= len(kept) < 4
    told = entry("report", "killed")
    assert (told.code, "has not finished" in told.stderr) == (INVALID, True)
    assert entry("run", "long.toml", "--out", "killed").code == 0
    assert kept.items() <= batches(tmp_path / "killed").items()
    activate(study(tmp_path, LONG), tmp_path / "whole", workers=1)
    assert contents(tmp_path / "killed") == contents(tmp_path / "whole")


def test_the_command_prints_tables_and_writes_a_page(entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "fleet.toml").write_text(FLEET)
    done = entry("run", "fleet.toml")
    assert (done.code, done.stdout.splitlines()[-1]) == (0, "results/fleet"), done.stderr
    assert "Fully open within 300 s of the call: cold 0 %" in done.stdout
    assert "what 1 MW of reserve needs" in done.stdout
    folder = tmp_path / "results" / "fleet"
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert page.count("<svg id") == 2
    assert "kept off before the call for 120 min" in page
    assert entry("report", folder, "--format", "html").stdout == page
    assert entry("report", folder, "--format", "csv").stdout == (folder / "activation.csv").read_text()
    said = json.loads(entry("report", folder, "--json").stdout)
    assert [row["state"] for row in said["table"]] == ["cold", "natural", "preheated", "standby"]
    assert "## What 1 MW of reserve needs" in entry("report", folder, "--format", "md").stdout
    assert entry("report", folder, "--against", "paper").code == USAGE


def test_tables_of_a_fleet_fit_100_columns_with_three_digits(called: wx.Activated) -> None:
    text = render(called, "table", 100, False)
    assert max(map(len, text.splitlines())) <= 100
    assert set(re.findall(r"\d,\d\d(\d)", text)) == {"0"}


def test_python_gets_what_the_command_writes(called: wx.Activated, tmp_path: Path) -> None:
    (tmp_path / "fleet.toml").write_text(FLEET)
    seen: list[tuple[int, int]] = []
    found = wx.run(tmp_path / "fleet.toml", progress=lambda done, of: seen.append((done, of)))
    assert isinstance(found, wx.Activated)
    pd.testing.assert_frame_equal(found.table, called.table)
    assert seen == [(0, 1), (1, 1)]


def test_pulses_that_heat_while_nobody_asks_are_warned_of(tmp_path: Path) -> None:
    told: list[str] = []
    text = FLEET.replace('use = "standby"', 'use = "standby", pulse_s = 200.0')
    found = activate(study(tmp_path, text), tmp_path / "out", progress=Progress(warn=told.append))
    assert told == found.warnings
    assert len(told) == 1
    assert "state 'standby': water flows though nobody asks for heat" in told[0]
    standby = next(row for row in found.rows if row.state == "standby")
    assert standby.idle_share > 0.1
    assert all(row.idle_share == 0.0 for row in found.rows if row.state != "standby")


def test_the_first_batch_that_fails_is_told_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []

    def failing(fleet: object, batch: range, stop: object) -> pd.DataFrame:
        raise SimulationError(f"loop {batch[0]}, cold: no")

    monkeypatch.setattr("waxstudy.fleet.run.computed", failing)
    fleet = study(tmp_path, COLD.replace("loops = 10", "loops = 60"))
    progress = Progress(warn=said.append, done=lambda case, computed: said.append("ended"))
    with pytest.raises(SimulationError, match="loop 0, cold: no"):
        activate(fleet, tmp_path / "out", workers=1, progress=progress)
    told = "loop 0, cold: no; the other batches are computed and kept, then the call ends"
    assert said == [told, "ended", "ended", "ended"]


ROOMS = '[activation]\nrooms = "rooms.csv"'


def test_loops_are_drawn_from_a_table_of_rooms_by_how_many_there_are(tmp_path: Path) -> None:
    (tmp_path / "rooms.csv").write_text("name,loops,room.window_g,setpoint_C\nhall,3,0.2,20\nbath,1,0.3,23\n")
    text = COLD.replace("[activation]", ROOMS).replace("loops = 10", "loops = 80")
    text = "".join(line for line in text.splitlines(True) if not line.startswith(("room.window_g", "setpoint_C")))
    loops = activate(study(tmp_path, text), tmp_path / "out").loops
    assert set(loops.groupby("room")["setpoint_C"].first().items()) == {("hall", 20.0), ("bath", 23.0)}
    assert 40 <= (loops["room"] == "hall").sum() <= 75  # 60 of 80, and 4 standard errors
    assert set(loops["actuator.product"]) == {"A", "B"}


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("loops = 10", "loops = 0", "fleet.toml:14: [activation] loops = 0: must be at least 10"),
        (
            '["A", "B"]',
            '["A", "Bb"]',
            "fleet.toml:18: [activation.draw] actuator.product[1] = \"Bb\": must be 'A' or 'B'; did you",
        ),
        ("actuator.product", "actuator.prodct", "nothing of this study; did you mean 'actuator.product'?"),
        (
            "[30.0]",
            "[1.0]",
            "fleet.toml:15: [activation] at_h: the call at 1 h does not fit into week 'january' of 7 days",
        ),
        ("[30.0]", "[167.9]", "up to 166.75 h"),
        (
            '"P_SB"\npause',
            '"P_BS"\npause',
            "[activation.state.standby] case = \"P_BS\": is no case; did you mean 'P_SB'?",
        ),
        ("preheat_s", "prehat_s", "did you mean 'preheat_s'? (allowed: case, preheat_s, pause_s)"),
        ("at_h = [30.0]", "at_h = [30.0]\nlasts_s = 200", "limit_s = 300 must be less than lasts_s = 200"),
        ("[30.0]", "[30.0, 30.0]", "at_h holds a time twice"),
        ("[30.0]", "[30.0]\nlasts_s = 907", "[activation] lasts_s: 907 s is no multiple of the step of 10 s"),
        ("preheat_s = 120", "preheat_s = 124", "124 s is no multiple of the step of 10 s"),
        ("[activation]", "[season]\n[activation]", "[season]: has no use beside [activation]"),
        (
            "actuator.product =",
            "modulator.pulse_s = [400.0]\nmodulator.pulse_period_s = [450.0, 100.0]\nactuator.product =",
            "pulse_s = 400.0 must be less than pulse_period_s",
        ),
        ("sd = 0.3", "sd = 9", "setpoint_C = -5.5: must be at least 5"),
        ("low = 0.7", "low = 2.0", "low must be less than high, not 2 and 1"),
        ("high = 1.0", "high = 3.0", "flow_share = 3.0: must be from 0.05 to 2.0 (high)"),
        ("[0.3, 0.5]", "{ low = 0.3, high = 0.5 }", "rooms are built for a list of values"),
        ("actuator.product =", '"actuator.product" = ["A"]\nactuator.product =', "actuator.product: is given twice"),
        ("pause_s = [7200]", "pause_s = 7200", "must be a distribution"),
        ("[activation]", '[activation]\nrooms = "none.csv"', 'rooms = "none.csv": no such file'),
        ("[activation]", ROOMS, "rooms.csv:1: loops: this column is missing (columns: name, loop, room.height_m)"),
        ("[activation.state", "[activation.stat", "[activation.state]: missing: at least one table"),
    ],
)
def test_what_a_fleet_cannot_be_is_told_at_its_line(
    entry: Entry, tmp_path: Path, old: str, new: str, told: str
) -> None:
    (tmp_path / "fleet.toml").write_text(FLEET.replace(old, new))
    (tmp_path / "rooms.csv").write_text("name,loop,room.height_m\nhall,3,2.6\n")
    done = entry("run", "fleet.toml")
    assert done.code == INVALID
    assert told in done.stderr
    assert not list(tmp_path.glob("results/fleet/*.json"))


@pytest.mark.parametrize(
    ("table", "told"),
    [
        (
            "name,loops,room.windw_g\na,3,0.3\n",
            "rooms.csv:1: room.windw_g: nothing of this study; did you mean 'room.window_g'?",
        ),
        ("name,loops,room.height_m\na,3,2.6\nb,4,99\n", "rooms.csv:3: room b: room.height_m = 99: must be"),
        ("name,loops,room.height_m\na,0,2.6\n", "rooms.csv:2: loops: must be a number above 0"),
        ("name,loops,room.height_m\na,1\n", "rooms.csv:2: 3 values are expected"),
        ("name,loops,setpoint_C\na,1,21\n", "setpoint_C: is in the table of rooms too"),
    ],
)
def test_what_a_table_of_rooms_cannot_be_is_told_at_its_line(
    entry: Entry, tmp_path: Path, table: str, told: str
) -> None:
    (tmp_path / "fleet.toml").write_text(FLEET.replace("[activation]", ROOMS))
    (tmp_path / "rooms.csv").write_text(table)
    done = entry("run", "fleet.toml")
    assert done.code == INVALID
    assert told in done.stderr


def test_options_of_other_runs_are_refused(entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "fleet.toml").write_text(FLEET)
    (tmp_path / "points.csv").write_text("comfort.setpoint_C\n20\n")
    assert "this study has [activation]" in entry("run", "fleet.toml", "--replace").stderr
    assert "this one has [activation]" in entry("run", "fleet.toml", "--sweep", "points.csv").stderr
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    assert entry("run", "fleet.toml", "--out", "mine").code == FAILED
    assert [each.name for each in (tmp_path / "mine").iterdir()] == ["letter.txt"]


def test_a_study_with_a_fleet_is_the_same_when_it_is_written_out_and_read_again(tmp_path: Path) -> None:
    first = study(tmp_path)
    again = study(tmp_path, wx_toml(first.described()))
    assert again.described() == first.described()


def wx_toml(stated: dict[str, object]) -> str:
    import tomli_w

    return tomli_w.dumps(stated)


@given(st.floats(0.0, 1.0, exclude_max=True))
def test_what_is_drawn_lies_between_the_ends_that_are_checked(share: float) -> None:
    for stated in ({"low": 1, "high": 3}, {"mean": 2.0, "sd": 0.5}, [1, 2, 3]):
        spread = spread_of(stated)
        assert min(spread.ends) <= spread.at(share) <= max(spread.ends)


def test_quantiles_have_the_moments_and_shares_that_are_stated() -> None:
    shares = (np.arange(2000) + 0.5) / 2000
    normal = [spread_of({"mean": 2.0, "sd": 0.5}).at(float(share)) for share in shares]
    assert np.mean(normal) == pytest.approx(2.0, abs=1e-6)
    assert np.std(normal) == pytest.approx(0.5, rel=0.02)  # cut off at three
    named = [spread_of({"values": ["A", "B"], "shares": [3, 1]}).at(float(share)) for share in shares]
    assert named.count("A") == 1500
