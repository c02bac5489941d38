"""Claims about sweeps: each point is the study at that point, whoever computes it, however often it is interrupted."""

from __future__ import annotations

import contextlib
import json
import multiprocessing
import operator
import os
import signal
import subprocess
import time
from collections.abc import Iterator
from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
import psutil
import pytest

from tests.cli.conftest import Entry, Plugin, entry, plugin
from tests.conftest import ONE_CASE, WAXSTUDY, Waxstudy
from tests.results.test_parquet import units_in
from tests.simulation.lumped import Absent, Lumped
from tests.simulation.test_outside import study_of
from waxstudy.api.sweeping import sweep
from waxstudy.plugin import BackendMissing
from waxstudy.simulation.run import Progress
from waxstudy.study.model import Comfort
from waxstudy.sweeps import run as sweeps
from waxstudy.sweeps.axes import Sweep
from waxstudy.sweeps.executors import executor
from waxstudy.sweeps.kinds import Kind
from waxstudy.sweeps.point import engines_of
from waxstudy.sweeps.run import Where, _attempt

__all__ = ["entry", "plugin"]

INVALID, BACKEND, FAILED = 3, 5, 6
STUDY = (
    ONE_CASE.replace('"small"\n', '"two"\nstep_s = 60\n').replace('"O_0"\n', '"O_CP"\n')
    + """\
steps = [ { id = "O_CP", controller = { dead_band_K = 0.5 } } ]
"""
)
GRID = """\
[vary]
"comfort.setpoint_C" = [20.0, 22.0]
O_CP.controller.dead_band_K = [0.3, 0.5]
"""
SOBOL = """\
[sweep]
method = "sobol"
samples = 8
[vary]
room.window_area_m2.south = { low = 2.0, high = 4.0 }
comfort.setpoint_C = { low = 20.0, high = 22.0 }
"""
STICKS = """
from waxstudy.plugin import Parameters, Valve, hookimpl, parameter


class Most(Parameters):
    most: float = parameter(1.0, unit="1", ge=0, le=1, description="Below 0.8 it breaks.", source="made up")


class Sticks(Valve):
    name = "sticks"
    Parameters = Most

    @staticmethod
    def step(p, x, u, t, dt):
        return u * p.most if p.most > 0.8 else -1.0


@hookimpl
def waxstudy_register(register):
    register(Sticks)
"""


@pytest.fixture(autouse=True)
def files(tmp_path: Path) -> None:
    for name, text in (("two", STUDY), ("grid", GRID), ("sobol", SOBOL)):
        (tmp_path / f"{name}.toml").write_text(text)


def table(folder: Path) -> pd.DataFrame:
    return pd.read_parquet(folder / "sweep.parquet")


def test_each_point_of_a_grid_has_the_figures_of_the_study_that_says_so(waxstudy: Waxstudy, tmp_path: Path) -> None:
    done = waxstudy("run", "two.toml", "--sweep", "grid.toml")
    assert (done.returncode, done.stdout.splitlines()[-1]) == (0, "results/two-grid"), done.stderr
    swept = table(tmp_path / "results" / "two-grid")
    points = swept.groupby("point")[["comfort.setpoint_C", "O_CP.controller.dead_band_K"]].first()
    assert points.to_numpy().tolist() == [[20.0, 0.3], [20.0, 0.5], [22.0, 0.3], [22.0, 0.5]]
    units = units_in(tmp_path / "results" / "two-grid" / "sweep.parquet")
    assert (units["comfort.setpoint_C"], units["O_CP.controller.dead_band_K"], units["mae_K"]) == ("C", "K", "K")
    stated = STUDY.replace("dead_band_K = 0.5", "dead_band_K = 0.3") + "[comfort]\nsetpoint_C = 22.0\n"
    (tmp_path / "one.toml").write_text(stated)
    assert waxstudy("run", "one.toml", "--out", "one").returncode == 0
    figures = pd.read_csv(tmp_path / "one" / "kpis.csv")
    pd.testing.assert_frame_equal(
        swept[swept["point"] == 2][figures.columns].reset_index(drop=True), figures, check_exact=False, rtol=1e-12
    )


def test_a_table_of_rooms_is_a_sweep_and_its_names_come_along(waxstudy: Waxstudy, tmp_path: Path) -> None:
    (tmp_path / "rooms.csv").write_text("name,room.window_area_m2.south\nsmall,2\nlarge,4\n")
    assert waxstudy("run", "two.toml", "--sweep", "rooms.csv", "--out", "rooms").returncode == 0
    heat = table(tmp_path / "rooms").groupby("name")["heat_corrected_kWh_m2_week"].mean()
    assert heat["large"] > heat["small"] * 1.02  # more window, and January has little sun


def test_a_latin_hypercube_has_a_point_in_each_part_of_every_range(waxstudy: Waxstudy, tmp_path: Path) -> None:
    text = SOBOL.replace('"sobol"', '"latin-hypercube"').replace("samples = 8", "samples = 4")
    (tmp_path / "cube.toml").write_text(text)
    assert waxstudy("run", "two.toml", "--sweep", "cube.toml", "--out", "cube").returncode == 0
    drawn = table(tmp_path / "cube").groupby("point")["comfort.setpoint_C"].first()
    assert sorted(int((value - 20.0) / 0.5) for value in drawn) == [0, 1, 2, 3]


@pytest.mark.parametrize(
    ("line", "told"),
    [
        (
            '"comfort.setpont_C" = [20.0]',
            "bad.toml:2: comfort.setpont_C: no parameter of this study; did you mean 'comfort.setpoint_C'?",
        ),
        ("comfort.setpoint_C = [20.0, 99.0]", "bad.toml:2: comfort.setpoint_C = 99.0: must be at most 40"),
        ('comfort.setpoint_C = [20.0]\n"comfort.setpoint_C" = [21.0]', "a key is given twice"),
        ("comfort.setpoint_C = 20.0", "must be a list of values, or a range"),
        ("comfort.setpoint_C = { low = 22.0, high = 20.0 }", "low must be less than high"),
        ("comfort.setpoint_C = { low = 20.0, high = 22.0 }", "a grid takes a list of values"),
    ],
)
def test_what_a_sweep_cannot_be_is_told_at_its_line(entry: Entry, tmp_path: Path, line: str, told: str) -> None:
    (tmp_path / "bad.toml").write_text(f"[vary]\n{line}\n")
    done = entry("run", "two.toml", "--sweep", "bad.toml")
    assert done.code == INVALID
    assert told in done.stderr
    assert not (tmp_path / "results").exists()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("comfort.setpont_C\n20\n", "bad.csv:1: comfort.setpont_C: no parameter of this study"),
        ("comfort.setpoint_C\n\n20\n99\n", "bad.csv:4: comfort.setpoint_C = 99: must be at most 40"),
        ("comfort.setpoint_C\nnan\n", "bad.csv:2: comfort.setpoint_C = nan: must be"),
        ("comfort.setpoint_C,name\n20\n", "bad.csv:2: 1 values where there are 2 keys"),
    ],
)
def test_what_a_table_of_points_cannot_be_is_told_at_its_line(
    entry: Entry, tmp_path: Path, text: str, told: str
) -> None:
    (tmp_path / "bad.csv").write_text(text)
    done = entry("run", "two.toml", "--sweep", "bad.csv")
    assert done.code == INVALID
    assert told in done.stderr


def test_a_point_that_fails_is_told_and_left_out(waxstudy: Waxstudy, plugin: Plugin, tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text(STUDY.replace('"linear"', '"sticks"'))
    (tmp_path / "points.csv").write_text("valve.most\n1.0\n0.5\n0.9\n")
    done = waxstudy("run", "two.toml", "--sweep", "points.csv", "--out", "points", env=plugin("stranger", STICKS))
    assert done.returncode == FAILED
    assert "warning: point 1: case O_0, january: " in done.stderr
    assert set(table(tmp_path / "points")["point"]) == {0, 2}
    assert list(json.loads((tmp_path / "points" / "sweep.json").read_text())["failed"]) == ["1"]


def test_a_folder_of_something_else_is_left_alone(entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("dear")
    done = entry("run", "two.toml", "--sweep", "grid.toml", "--out", "mine")
    assert done.code == FAILED
    assert "in use" in done.stderr
    assert [each.name for each in (tmp_path / "mine").iterdir()] == ["letter.txt"]


def test_options_of_a_sweep_without_one_are_told(entry: Entry) -> None:
    assert "--sweep" in entry("run", "two.toml", "--executor", "processes").stderr
    assert "--executor dask" in entry("run", "two.toml", "--sweep", "grid.toml", "--scheduler", "a:1").stderr


# --- a room of another engine ------------------------------------------------------------------------


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The engines that a room says it has, each time that it is asked; points cost nothing."""
    found: list[str] = []

    def ready(cls: type[Lumped], *_: object) -> str:
        found.append(cls.engine)
        return cls.engine

    monkeypatch.setattr(Lumped, "ready", classmethod(ready))
    monkeypatch.setattr(sweeps, "computed", lambda *_, jit: pd.DataFrame({"member": [0], "mae_K": [0.1]}))
    return found


def test_points_are_computed_again_where_the_engine_of_their_room_has_another_version(
    asked: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It is asked once for points in the same room on the same weather."""
    study = study_of(tmp_path / "small.toml", Lumped)
    made = [replace(study, comfort=Comfort(setpoint_C=value)) for value in (20.0, 21.0)]
    vary = Sweep("points", "table", ("comfort.setpoint_C",), ((20.0,), (21.0,)))

    def kept() -> int:
        assert sweeps.run(made, vary, tmp_path / "out", Where(workers=1), Progress()) == {}
        return len(list((tmp_path / "out" / "points").glob("*.parquet")))

    assert (kept(), kept()) == (2, 2)
    monkeypatch.setattr(Lumped, "engine", "Lumped 1.1")
    assert kept() == 4
    assert asked == ["Lumped 1.0", "Lumped 1.0", "Lumped 1.1"]


def test_a_point_whose_room_is_refused_is_told_by_its_own_reason(tmp_path: Path) -> None:
    short, long = (study_of(tmp_path / "small.toml", Lumped, step_s=step_s) for step_s in (60.0, 600.0))
    assert list(engines_of([long, short], jit=False)) == ["", "Lumped 1.0"]
    with pytest.raises(BackendMissing, match="pip install lumped"):
        list(engines_of([study_of(tmp_path / "small.toml", Absent)], jit=False))


# --- beside each other -------------------------------------------------------------------------------


def test_a_sweep_that_ends_stops_no_other_of_its_process(tmp_path: Path) -> None:
    points = pd.DataFrame({"comfort.setpoint_C": [20.0, 20.5, 21.0, 21.5]})

    def beside(*_: object) -> None:
        if not (tmp_path / "short").exists():
            sweep(tmp_path / "two.toml", points[:1], tmp_path / "short", workers=1)

    found = sweep(tmp_path / "two.toml", points, tmp_path / "long", workers=1, progress=Progress(done=beside))
    assert (tmp_path / "short" / "sweep.parquet").exists()
    assert found.frame["point"].nunique() == 4


@pytest.mark.parametrize("kind", ["threads", "processes"])
def test_a_sweep_that_begins_takes_no_stop_back(kind: Kind) -> None:
    with executor("threads", 1, None) as (_, stop):
        assert stop[0] == 0
    with executor(kind, 1, None) as (_, other):
        assert (stop[0], other[0]) == (1, 0)


# --- killed ------------------------------------------------------------------------------------------


def begun(tmp_path: Path, *options: str) -> Iterator[tuple[subprocess.Popen[bytes], Path]]:
    """Give a sweep at work each time that it has finished another point."""
    folder = tmp_path / "killed"
    command = [str(WAXSTUDY), "run", "two.toml", "--sweep", "sobol.toml", "--out", str(folder), *options]
    process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    seen = 0
    try:
        while process.poll() is None:
            now = len(list((folder / "points").glob("[!.]*.parquet")))
            if now > seen:
                yield process, folder
                seen = now
            time.sleep(0.02)
    finally:
        process.kill()
        process.wait()


@pytest.mark.slow
def test_a_sweep_that_is_killed_loses_no_finished_point(waxstudy: Waxstudy, tmp_path: Path) -> None:
    for process, _ in begun(tmp_path):
        process.kill()
        process.wait()
    points = {file.name: file.stat().st_mtime_ns for file in (tmp_path / "killed" / "points").glob("[!.]*.parquet")}
    assert 1 <= len(points) < 32
    told = waxstudy("report", "killed", "--sensitivity")
    assert (told.returncode, "has not finished" in told.stderr) == (INVALID, True)
    assert waxstudy("run", "two.toml", "--sweep", "sobol.toml", "--out", "killed").returncode == 0
    after = {file.name: file.stat().st_mtime_ns for file in (tmp_path / "killed" / "points").glob("*.parquet")}
    assert points.items() <= after.items()
    assert table(tmp_path / "killed")["point"].nunique() == 32
    shares = json.loads(waxstudy("report", "killed", "--sensitivity", "--format", "json").stdout)["indices"]
    total = {(each["figure"], each["parameter"]): each["total"] for each in shares if each["case"] == "O_CP"}
    # at equal comfort the setpoint only moves the shift, and the windows only the heat
    assert total["heat_corrected_kWh_m2_week", "comfort.setpoint_C"] < 0.05
    assert total["heat_corrected_kWh_m2_week", "room.window_area_m2.south"] > 0.5
    assert total["setpoint_shift_K", "room.window_area_m2.south"] < 0.05
    assert total["setpoint_shift_K", "comfort.setpoint_C"] > 0.5


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["processes", "dask"])
def test_a_worker_that_is_killed_costs_no_point(waxstudy: Waxstudy, tmp_path: Path, kind: str) -> None:
    (tmp_path / "sobol.toml").write_text(SOBOL.replace("samples = 8", "samples = 2"))
    killed = 0
    for process, _ in begun(tmp_path, "--executor", kind, "--workers", "2"):
        workers = [each for each in psutil.Process(process.pid).children(recursive=True) if is_worker(each)]
        if not killed and len(workers) == 2:
            os.kill(workers[0].pid, signal.SIGKILL)
            killed += 1
    assert killed == 1
    assert waxstudy("run", "two.toml", "--sweep", "sobol.toml", "--out", "whole").returncode == 0
    pd.testing.assert_frame_equal(table(tmp_path / "killed"), table(tmp_path / "whole"))


def test_a_worker_that_dies_while_nobody_waits_for_it_costs_the_points_under_way_alone() -> None:
    todo: dict[int, Any] = dict.fromkeys(range(8))

    def ended(number: int, outcome: Future[Any]) -> None:
        outcome.result()
        del todo[number]
        for worker in multiprocessing.active_children():
            worker.kill()
            worker.join()
        time.sleep(0.5)  # the pool sees it

    lost = _attempt(dict(todo), Where("processes", 1), operator.is_, ended)  # type: ignore[arg-type]
    assert len(todo) >= 6
    assert set(lost) <= set(todo)


def is_worker(process: psutil.Process) -> bool:
    """Whether a process computes points; one that has just ended tells nothing of itself any more."""
    with contextlib.suppress(psutil.Error):
        return any("spawn_main" in word or word.startswith("dask worker") for word in process.cmdline())
    return False


def test_a_scheduler_that_does_not_answer_is_told(waxstudy: Waxstudy) -> None:
    done = waxstudy("run", "two.toml", "--sweep", "grid.toml", "--executor", "dask", "--scheduler", "tcp://127.0.0.1:1")
    assert done.returncode == BACKEND
    assert "the dask scheduler at tcp://127.0.0.1:1 does not answer" in done.stderr
