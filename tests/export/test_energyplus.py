"""A plugin for EnergyPlus does what the blocks do here, in one file that needs the standard library alone."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.cli.conftest import Entry
from tests.cli.conftest import entry as entry
from tests.conftest import ROOT, SMALL
from waxstudy.export.python_source import NotPortable, factory
from waxstudy.plugin import Actuator, Choice
from waxstudy.plugin.registry import installed
from waxstudy.rig.bench import LEAD_S
from waxstudy.rig.programme import table_a1
from waxstudy.simulation.chain import Stepped

WHERE = ("--zone", "Living", "--radiant", "Living floor", "--full-flow-kg-s", "0.034")
DONE, USAGE, PLUGIN = 0, 2, 4


def loaded(path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What a plugin's file defines, read as EnergyPlus does: its base class is the engine's."""
    engine = SimpleNamespace(EnergyPlusPlugin=type("EnergyPlusPlugin", (), {}))
    monkeypatch.setitem(sys.modules, "pyenergyplus", SimpleNamespace(plugin=engine))
    monkeypatch.setitem(sys.modules, "pyenergyplus.plugin", engine)
    names: dict[str, Any] = {"__name__": "plugin"}
    exec(compile(path.read_text(encoding="utf-8"), str(path), "exec", dont_inherit=True), names)
    return names


def exported(entry: Entry, *options: object) -> Path:
    done = entry("export", "energyplus", *options, *WHERE, "--out", "motor.py")
    assert done.code == DONE, done.stderr
    return Path("motor.py")


@pytest.mark.parametrize("product", ["A", "B"])
def test_its_actuator_is_the_blocks_own_step_over_all_programmes_of_the_rig(
    entry: Entry, monkeypatch: pytest.MonkeyPatch, product: str
) -> None:
    names = loaded(exported(entry, "--use", "variable-times", "--set", f"product={product}"), monkeypatch)
    for trial in {each.profile: each for each in table_a1() if each.product == product}.values():
        draw = np.random.default_rng(1)
        switches_s = np.cumsum(np.concatenate(([draw.uniform(*LEAD_S)], trial.lengths_s(draw))))
        here = Stepped(Choice.of(installed().get("actuator", "variable-times"), {"product": product}), 5.0)
        ((_, step, p, x, *_),) = [each for each in names["Chain"]().blocks if each[0] == "actuator"]
        for time_s in np.arange(0.0, min(60.0 * trial.duration_min, 6 * 3600.0), 5.0):
            on = float(np.searchsorted(switches_s, time_s, side="right") % 2)
            assert step(p, x, on, float(time_s), 5.0) == pytest.approx(here.step(on, float(time_s)), abs=1e-9)


@pytest.mark.parametrize("name", installed().names("actuator"))
def test_every_installed_actuator_can_be_written(entry: Entry, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    chain = loaded(exported(entry, "--use", name), monkeypatch)["Chain"]()
    flows = [chain.mean_flow(15.0, 600.0) for _ in range(12)]
    assert (chain.steps, flows[-1] > 0.5) == (1440, True)


def test_the_chain_of_a_case_is_stepped_as_here_with_the_rest_of_a_time_step_carried_on(
    entry: Entry, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    text = SMALL.replace("start = {", 'start = { sensor = { use = "delay" },')
    (tmp_path / "study.toml").write_text(text)
    chain = loaded(exported(entry, "study.toml", "--case", "O_WM"), monkeypatch)["Chain"]()
    chosen = [("sensor", "delay", {}), ("controller", "on-off", {"dead_band_K": 0.5})]
    chosen += [("actuator", "variable-times", {}), ("valve", "quick-opening", {})]
    here = [(kind, Stepped(Choice.of(installed().get(kind, name), p), 5.0)) for kind, name, p in chosen]
    for number in range(400):
        air_C, flows = 21.0 + np.sin(number / 20.0), []
        for n in range(int(number * 62.0 / 5.0 + 1e-6), int((number + 1) * 62.0 / 5.0 + 1e-6)):
            u = air_C
            for kind, block in here:
                u = block.step(21.0 - u if kind == "controller" else u, 5.0 * n)
            flows.append(u)
        assert chain.mean_flow(air_C, 62.0) == pytest.approx(np.mean(flows), abs=1e-9)


def test_a_dead_band_is_refused_where_the_chain_has_a_controller_of_its_own(entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(SMALL)
    options = ("study.toml", "--case", "O_WM", *WHERE, "--dead-band-k", "1.5", "--out", "motor.py")
    done = entry("export", "energyplus", *options)
    assert (done.code, "--dead-band-k is of a motor alone" in done.stderr) == (2, True)
    assert not (tmp_path / "motor.py").exists()


def test_the_plugin_reads_the_zone_and_sets_the_flow_of_the_radiant_object(
    entry: Entry, monkeypatch: pytest.MonkeyPatch
) -> None:
    motor = loaded(exported(entry, "--use", "linear-ramp"), monkeypatch)["Motor"]()
    known, was_set, said = {"Living": 3, "Living floor": 4}, [], []
    motor.api = SimpleNamespace(
        exchange=SimpleNamespace(
            api_data_fully_ready=lambda state: True,
            get_variable_handle=lambda state, name, key: known.get(key, -1),
            get_actuator_handle=lambda state, kind, control, key: known.get(key, -1),
            get_variable_value=lambda state, handle: 18.0,
            zone_time_step=lambda state: 1.0 / 6.0,
            set_actuator_value=lambda state, handle, value: was_set.append((handle, value)),
        ),
        runtime=SimpleNamespace(issue_severe=lambda state, text: said.append(text)),
    )
    assert [motor.on_begin_zone_timestep_before_predictor(None) for _ in range(2)] == [0, 0]
    assert was_set[-1] == (4, 0.034)
    known.pop("Living floor")
    motor.handles = None
    assert motor.on_begin_zone_timestep_before_predictor(None) == 1
    # one of constant flow has another kind of actuator
    constant = {("Constant Flow Low Temp Radiant", "Living floor"): 5}
    motor.api.exchange.get_actuator_handle = lambda state, kind, control, key: constant.get((kind, key), -1)
    assert motor.on_begin_zone_timestep_before_predictor(None) == 0
    assert was_set[-1][0] == 5
    assert said == ["waxstudy: the model has no radiant object Living floor"]


def test_the_file_needs_the_standard_library_alone_and_says_what_to_paste(entry: Entry, tmp_path: Path) -> None:
    done = entry("export", "energyplus", "--use", "variable-times", *WHERE, "--out", "motor.py")
    pasted = "PythonPlugin:Instance, waxstudy motor, Yes, motor, Motor;"
    assert (pasted in done.stdout, pasted in Path("motor.py").read_text()) == (True, True)
    (tmp_path / "pyenergyplus").mkdir()
    (tmp_path / "pyenergyplus" / "plugin.py").write_text("class EnergyPlusPlugin:\n    pass\n")
    run = "import sys; sys.path.insert(0, '.'); import motor; print(motor.Chain().mean_flow(15.0, 3600.0) > 0.5)"
    # isolated, without site-packages
    told = subprocess.run([sys.executable, "-ISc", run], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert told.stdout == "True\n"


def test_a_block_that_needs_more_than_the_standard_library_is_refused() -> None:
    class Numeric(Actuator):
        name = "numeric"

        @staticmethod
        def step(p: Any, x: Any, u: float, t: float, dt: float) -> float:
            return float(np.sqrt(u))

    with pytest.raises(NotPortable, match="it needs numpy"):
        factory(Numeric, "numeric")


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (("--use", "linear-ramp", *WHERE, "--out", "my-motor.py"), USAGE, "letters, digits and '_'"),
        (("--use", "linear-ramp", *WHERE[2:], "--zone", "a;b", "--out", "m.py"), USAGE, "--zone 'a;b'"),
        (("--use", "pwm", *WHERE, "--out", "m.py"), USAGE, "no block of a chain"),
        ((ROOT / "studies/table5.toml", "--case", "X", *WHERE, "--out", "m.py"), USAGE, "no case of"),
    ],
)
def test_what_cannot_be_written_is_told_and_nothing_is_written(
    entry: Entry, tmp_path: Path, arguments: tuple[object, ...], code: int, said: str
) -> None:
    done = entry("export", "energyplus", *arguments)
    assert (done.code, said in done.stderr) == (code, True), done.stderr
    assert list(tmp_path.iterdir()) == []
