"""Runs in EnergyPlus: what they conserve, how near the fast room they are, and what is left of them when they fail."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.conftest import NO_BYTECODE
from tests.energyplus import drivers
from waxstudy.plugin import SimulationError, Stopped, WeatherRecord
from waxstudy.simulation.advance import ChainAdvance
from waxstudy.simulation.chain import Chain
from waxstudy.simulation.engine import Loop, Start
from waxstudy.simulation.kernel import TRACE
from waxstudy.simulation.modes import drive
from waxstudy.study.model import Choice
from waxstudy_energyplus.installation import EnergyPlusError
from waxstudy_energyplus.model import exchange_W_K
from waxstudy_energyplus.run import Simulated, simulate
from waxstudy_paper.actuators import VariableTimes
from waxstudy_paper.controllers import OnOff
from waxstudy_paper.room import NzebRoom, RoomDescription, SurfacesRoom
from waxstudy_paper.valves import QuickOpeningValve
from waxstudy_paper.weather import TallinnWeek

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("energyplus")]

ROOT = Path(__file__).parents[2]
ADay = Callable[[float], WeatherRecord]

ASKING = """\
import sys
from pathlib import Path
import numpy as np
from tests.conftest import NO_BYTECODE
from tests.energyplus import drivers
from waxstudy.plugin import SimulationError, Stopped, WeatherRecord
from waxstudy_energyplus.run import simulate
from waxstudy_paper.room import NzebRoom
room = NzebRoom.description(NzebRoom.Parameters())
dark = {facade: np.zeros(24) for facade in room.facades}
weather = WeatherRecord(3600.0, "2021-01-01", np.zeros(24), dark)
simulate(room, weather, drivers.Slow(Path(sys.argv[1])), setpoint_C=21.0)
"""


@pytest.fixture
def steady(room: RoomDescription, a_day: ADay) -> tuple[RoomDescription, Simulated]:
    """A room without gains, in balance at full flow and -10 C outdoors."""
    empty = room.model_copy(update={"gains": room.gains.model_copy(update={"mean_W_m2": 0.0})})
    return empty, simulate(empty, a_day(-10.0), drivers.full, setpoint_C=21.0)


def test_heat_that_the_water_gives_off_leaves_the_room(steady: tuple[RoomDescription, Simulated]) -> None:
    room, run = steady
    last = {name: run.minute(name)[-1] for name in ("air_C", "operative_C", "layer_C", "water_heat_W")}
    floor, outdoor_C = room.floor, -10.0
    below = sum(layer.resistance_m2K_W for layer in floor.layers[1:]) + 1 / room.films.exterior_W_m2K
    down_W = floor.area_m2 * (last["layer_C"] - outdoor_C) / below
    up_W = floor.area_m2 * run.minute("floor_heat_W_m2")[-1]
    assert last["water_heat_W"] == pytest.approx(up_W + down_W, rel=0.005)

    supplied_W_K = room.air.ventilation_L_s * 1.206
    air_W = exchange_W_K(room) * (last["air_C"] - outdoor_C) - supplied_W_K * (18.0 - outdoor_C)
    walls_W_K = sum(s.area_m2 for s in room.surfaces if s.name in ("south wall", "west wall")) * 0.12
    windows_W_K = sum(w.area_m2 for w in room.windows) * 0.75
    shell_W = (walls_W_K + windows_W_K) * (last["operative_C"] - outdoor_C)
    assert up_W == pytest.approx(air_W + shell_W, rel=0.01)


def test_water_gives_off_as_much_per_kelvin_as_in_the_fast_room(steady: tuple[RoomDescription, Simulated]) -> None:
    run = steady[1]
    per_K = run.minute("water_heat_W")[-1] / (run.minute("supply_C")[-1] - run.minute("layer_C")[-1])
    fast = NzebRoom.build(NzebRoom.Parameters()).floor_conductance_W_K(np.array([1.0]))[0]
    assert per_K == pytest.approx(fast, rel=0.01)


O_WM = {
    "controller": Choice(OnOff, OnOff.Parameters(dead_band_K=0.5)),
    "actuator": Choice(VariableTimes, VariableTimes.Parameters(product="B")),
    "valve": Choice(QuickOpeningValve, QuickOpeningValve.Parameters()),
}


def test_a_week_of_a_wax_motor_agrees_with_the_fast_room(room: RoomDescription) -> None:
    week = TallinnWeek.load(TallinnWeek.Parameters(month="january"), room.facades)
    run = simulate(room, week, ChainAdvance(O_WM, 5.0, 21.0), setpoint_C=21.0)
    loop = Loop(Chain(O_WM, 5.0), drive(NzebRoom.build(NzebRoom.Parameters()), week, 5.0), 21.0)
    (fast,) = loop.weeks(21.0, [Start(0.0, 0.0)], trace=True)
    mean, fast_mean = (dict(zip(TRACE, trace.mean(axis=0), strict=True)) for trace in (run.trace(), fast.trace))
    assert run.trace().shape == fast.trace.shape
    assert mean["water_heat_W"] == pytest.approx(fast_mean["water_heat_W"], rel=0.05)
    assert mean["air_C"] == pytest.approx(fast_mean["air_C"], abs=0.1)
    assert run.minute("water_heat_W").mean() == pytest.approx(mean["water_heat_W"])


def layer(thickness_m: float, conductivity_W_mK: float, density_kg_m3: float) -> dict[str, float]:
    given = {"thickness_m": thickness_m, "conductivity_W_mK": conductivity_W_mK, "density_kg_m3": density_kg_m3}
    return {**given, "heat_capacity_J_kgK": 1000.0}


def test_a_room_on_the_ground_with_sun_on_its_wall_agrees_with_the_fast_room() -> None:
    slab, insulation, block = layer(0.05, 1.2, 2000.0), layer(0.3, 0.035, 20.0), layer(0.2, 0.1, 600.0)
    floor = {"name": "floor", "facing": "floor", "area_m2": 16.0, "boundary": "ground", "layers": [slab, insulation]}
    sunny = {"name": "outer wall", "area_m2": 9.0, "boundary": "outdoors", "layers": [block]}
    inner = {"name": "walls", "area_m2": 36.0, "boundary": "adiabatic", "layers": [layer(0.1, 0.6, 1400.0)]}
    window = {"name": "window", "area_m2": 4.0, "U_W_m2K": 1.0, "g": 0.5, "azimuth_deg": 180.0}
    house = RoomDescription.model_validate(
        {
            "surfaces": [floor, {**sunny, "azimuth_deg": 180.0, "solar_absorptance": 0.6}, inner],
            "windows": [window],
            "air": {"volume_m3": 40.0, "ventilation_L_s": 8.0, "infiltration_L_s": 1.0},
            "heated_floor": {"surface": "floor", "pipes_after_layer": 1},
            "circuit": {"exchange": "pipe", "spacing_m": 0.2},
            "ground_temperature_C": 8.0,
        }
    )
    week = TallinnWeek.load(TallinnWeek.Parameters(month="february"), house.facades)
    run = simulate(house, week, drivers.full, setpoint_C=21.0)
    loop = Loop(Chain({"controller": O_WM["controller"]}, 5.0), drive(SurfacesRoom.build(house), week, 5.0), 21.0)
    state, always_C = loop.start(21.0), 90.0
    loop.advance(state, np.tile(np.arange(24), 7), -7 * 86400.0, always_C)
    trace = loop.advance(state, np.arange(7 * 24), 0.0, always_C, trace=True)[1]
    mean, fast_mean = (dict(zip(TRACE, rows.mean(axis=0), strict=True)) for rows in (run.trace(), trace))
    assert fast_mean["flow_fraction"] == 1.0
    assert mean["water_heat_W"] == pytest.approx(fast_mean["water_heat_W"], rel=0.02)
    assert mean["operative_C"] == pytest.approx(fast_mean["operative_C"], abs=0.1)


def test_starts_differ_as_asked_at_the_end_of_the_warm_up(room: RoomDescription, a_day: ADay) -> None:
    cold, warm = (
        simulate(room, a_day(0.0), drivers.closed, setpoint_C=21.0, start=Start(0.0, slab_K)) for slab_K in (-2.0, 2.0)
    )
    assert 0.05 < warm.minute("layer_C")[0] - cold.minute("layer_C")[0] < 4.0


def test_what_the_chain_raises_comes_out_with_its_traceback(room: RoomDescription, a_day: ADay) -> None:
    with pytest.raises(ZeroDivisionError) as raised:
        simulate(room, a_day(0.0), drivers.divides_by_nothing, setpoint_C=21.0)
    assert "in divides_by_nothing" in str(raised.value.__cause__)


def test_a_block_that_fails_is_named_as_in_the_fast_room(room: RoomDescription, a_day: ADay) -> None:
    broken = ChainAdvance({"valve": Choice(QuickOpeningValve, OnOff.Parameters())}, 5.0, 21.0)
    with pytest.raises(SimulationError, match="valve 'quick-opening' failed"):
        simulate(room, a_day(0.0), broken, setpoint_C=21.0)


def test_a_fatal_model_shows_the_engines_own_error(room: RoomDescription, a_day: ADay) -> None:
    with pytest.raises(EnergyPlusError, match=r"(?s)eplusout.err.*\*\* Severe.*\*\*  Fatal"):
        simulate(room, a_day(1e5), drivers.full, setpoint_C=21.0)


def folders(tmp_path: Path) -> list[str]:
    return [entry.name for entry in tmp_path.iterdir() if entry.name.startswith("waxstudy-energyplus")]


def test_a_crash_of_the_engine_is_told_and_leaves_nothing(
    room: RoomDescription, a_day: ADay, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.raises(EnergyPlusError, match="ended by itself"):
        simulate(room, a_day(0.0), drivers.dies, setpoint_C=21.0)
    assert not folders(tmp_path)


def is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return "Z" not in Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]


def eventually(happened: Callable[[], bool]) -> bool:
    return any(happened() or time.sleep(0.05) for _ in range(600))


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize("blow", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_whoever_asked_takes_the_engine_along(tmp_path: Path, blow: signal.Signals) -> None:
    number = tmp_path / "number"
    environment = {**os.environ, "TMPDIR": str(tmp_path), "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])}
    command = [sys.executable, "-c", ASKING, str(number)]
    with subprocess.Popen(
        command,
        env=environment,
        cwd=ROOT,
        stderr=subprocess.DEVNULL,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),  # also where the tests run in the background
    ) as asking:
        assert eventually(lambda: number.exists() and bool(number.read_text()))
        engine = int(number.read_text())
        assert is_alive(engine)
        asking.send_signal(blow)
        asking.wait(timeout=30)
    assert asking.returncode != 0
    assert eventually(lambda: not is_alive(engine))
    assert eventually(lambda: not folders(tmp_path))


def text_in(file: Path) -> str:
    return file.read_text() if file.exists() else ""


def test_a_run_that_is_stopped_ends_its_process(room: RoomDescription, a_day: ADay, tmp_path: Path) -> None:
    number = tmp_path / "number"
    with pytest.raises(Stopped):
        # the file is there a moment before the number is in it
        simulate(room, a_day(0.0), drivers.Slow(number), setpoint_C=21.0, stop=lambda: text_in(number) != "")
    assert not is_alive(int(number.read_text()))


def test_a_run_can_be_stopped_while_its_process_has_not_read_the_question(
    room: RoomDescription, a_day: ADay, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The worker's own Python stands still at its start; the question is longer than what a pipe holds."""
    (tmp_path / "sitecustomize.py").write_text("import time\ntime.sleep(600)\n")
    monkeypatch.syspath_prepend(tmp_path)
    long = drivers.Slow(tmp_path / "never", ballast=b"x" * 10_000_000)
    began = time.monotonic()
    with pytest.raises(Stopped):
        simulate(room, a_day(0.0), long, setpoint_C=21.0, stop=lambda: time.monotonic() > began + 0.5)
    assert not (tmp_path / "never").exists()


def test_a_full_disk_is_told_and_leaves_nothing(
    room: RoomDescription, a_day: ADay, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    for name, value in NO_BYTECODE.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, before[1]))
    try:
        with pytest.raises(OSError, match="File too large"):
            simulate(room, a_day(0.0), drivers.full, setpoint_C=21.0)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert not folders(tmp_path)
