"""`waxstudy export fmu`: fragments, blocks by name, whole chains, plugins of others, and what it refuses."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from tests.cli.conftest import Entry, Plugin
from tests.cli.conftest import entry as entry
from tests.cli.conftest import plugin as plugin
from tests.conftest import ROOT, SMALL, call
from tests.export.importer import Fmu, Instance
from waxstudy.export import compiler
from waxstudy.plugin import Choice
from waxstudy.plugin.registry import installed
from waxstudy.simulation.chain import Stepped

DONE, USAGE, INVALID, PLUGIN, BACKEND = 0, 2, 3, 4, 5
MAGIC = {"linux64": b"\x7fELF", "darwin64": b"\xcf\xfa\xed\xfe", "darwin-arm64": b"\xcf\xfa\xed\xfe"}
FRAGMENT = """\
[actuator]
use = "constant-times"
dead_time_s = 100.0
rise_time_s = 200.0
hold_time_s = 50.0
fall_time_s = 80.0
"""
NOT_COMPILED = '''
from waxstudy.plugin import Actuator, hookimpl


class Worded(Actuator):
    """The opening is the signal, found by its name."""

    name, api_version = "worded", "1.0"

    @staticmethod
    def step(p, x, u, t, dt):
        return float(__import__("json").loads(str(u)))


@hookimpl
def waxstudy_register(register):
    register(Worded)
'''


def opened_after(there: Instance, step_s: float = 5.0) -> float:
    """The time at which the signal, on from the start, has opened the valve fully."""
    there.begin().set("signal", 1.0)
    time_s = 0.0
    while there.get("opening") < 1.0:
        assert time_s < 3600.0
        there.step(time_s, step_s)
        time_s += step_s
    return time_s


def test_a_fragment_becomes_an_fmu_at_the_step_that_is_asked_for(entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "motor.toml").write_text(FRAGMENT)
    done = entry("export", "fmu", "motor.toml", "--step", 2, "--set", "dead_time_s=50.0", "--out", "motor.fmu")
    assert (done.code, done.stdout) == (DONE, "motor.fmu\n"), done.stderr
    assert opened_after(Instance(Fmu(tmp_path / "motor.fmu", tmp_path / "unpacked")), 1.0) == 250.0


def test_the_chain_of_a_case_goes_from_temperature_and_setpoint_to_flow(entry: Entry, tmp_path: Path) -> None:
    (tmp_path / "study.toml").write_text(SMALL)
    done = entry("export", "fmu", "study.toml", "--case", "O_WM", "--out", "chain.fmu", "--fmi", 3)
    assert done.code == DONE, done.stderr
    chosen = {
        "controller": ("on-off", {"dead_band_K": 0.5}),
        "actuator": ("variable-times", {}),
        "valve": ("quick-opening", {}),
    }
    here = [Stepped(Choice.of(installed().get(k, name), values), 5.0) for k, (name, values) in chosen.items()]
    there = Instance(Fmu(tmp_path / "chain.fmu", tmp_path / "unpacked")).begin()
    there.set("setpoint_C", 21.0)
    flows = []
    for number in range(1000):
        reading = 20.0 if number < 400 else 22.0
        there.set("temperature_C", reading)
        there.step(5.0 * number, 5.0)
        u = 21.0 - reading
        for block in here:
            u = block.step(u, 5.0 * number)
        assert (there.get("reading_C"), there.get("flow_fraction")) == (reading, pytest.approx(u, abs=1e-9))
        flows.append(u)
    assert (min(flows), max(flows)) == (0.0, 1.0)


def test_a_plugins_own_actuator_is_exported_as_the_tutorial_makes_it(plugin: Plugin, tmp_path: Path) -> None:
    page = (ROOT / "docs" / "plugin-tutorial.md").read_text(encoding="utf-8")
    source = page.split("```python\n# waxstudy-cold-start/waxstudy_cold_start.py\n")[1].split("```")[0]
    mended = source.replace("1.0 / stroke_s if u > 0.5 else -1.0 / p", "dt / stroke_s if u > 0.5 else -dt / p")
    options = ("--use", "cold-start", "--set", "cold_stroke_s=180.0", "--out", "cold.fmu")
    done = call(tmp_path, "export", "fmu", *options, env=plugin("waxstudy_cold_start", mended))
    assert done.returncode == DONE, done.stderr
    assert opened_after(Instance(Fmu(tmp_path / "cold.fmu", tmp_path / "unpacked"))) == 180.0


def test_a_block_that_cannot_be_compiled_is_refused_with_the_reason(plugin: Plugin, tmp_path: Path) -> None:
    done = call(tmp_path, "export", "fmu", "--use", "worded", "--out", "w.fmu", env=plugin("worded", NOT_COMPILED))
    assert done.returncode == PLUGIN
    assert "actuator 'worded' cannot be compiled, and so not exported: " in done.stderr
    assert not (tmp_path / "w.fmu").exists()


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (("--use", "variable-times"), USAGE, "Missing option '--out'"),
        (("--use", "variable-times", "--out", "motor.zip"), USAGE, "the name of an FMU ends with .fmu"),
        (("--out", "motor.fmu"), USAGE, "name a file with a block, or a block with --use"),
        (("--use", "ideal", "--out", "motor.fmu"), USAGE, "one among each of actuator, sensor: add --kind"),
        (("--use", "nzeb", "--out", "motor.fmu"), USAGE, "no block of a chain"),
        (("--use", "variable-times", "--set", "product=C", "--out", "motor.fmu"), USAGE, "product"),
        (("study.toml", "--case", "O_XX", "--out", "motor.fmu"), USAGE, "no case of study.toml"),
        (("study.toml", "--kind", "actuator", "--out", "motor.fmu"), USAGE, "--kind goes with --use"),
        (("study.toml", "--out", "motor.fmu"), INVALID, "study.toml"),
        (("--use", "linear-ramp", "--platform", "linux-arm64", "--out", "m.fmu"), USAGE, "use --fmi 3"),
        (("--use", "linear-ramp", "--out", "there.fmu"), USAGE, "there is something of this name already"),
        (("--use", "linear-ramp", "--step", "0", "--out", "motor.fmu"), USAGE, "0.01<=x<=60"),
        (("--use", "linear-ramp", "--out", "no/motor.fmu"), 6, "cannot be written"),
    ],
)
def test_what_cannot_be_exported_is_told_and_nothing_is_written(
    entry: Entry, tmp_path: Path, arguments: tuple[str, ...], code: int, said: str
) -> None:
    (tmp_path / "study.toml").write_text(SMALL)
    (tmp_path / "there.fmu").write_text("mine")
    done = entry("export", "fmu", *arguments)
    assert (done.code, said in done.stderr) == (code, True), done.stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["study.toml", "there.fmu"]
    assert (tmp_path / "there.fmu").read_text() == "mine"


def test_without_the_compiler_the_extra_is_named(entry: Entry, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(compiler, "find_spec", lambda name: None)
    done = entry("export", "fmu", "--use", "linear-ramp", "--out", "motor.fmu")
    assert (done.code, 'pip install "waxstudy[fmu]"' in done.stderr) == (BACKEND, True)
    assert list(tmp_path.iterdir()) == []


def test_the_same_block_is_the_same_file(entry: Entry, tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        done = entry("export", "fmu", "--use", "variable-times", "--out", f"{name}/motor.fmu")
        assert done.code == DONE, done.stderr
    assert (tmp_path / "a/motor.fmu").read_bytes() == (tmp_path / "b/motor.fmu").read_bytes()


@pytest.mark.slow
def test_one_fmu_may_hold_libraries_for_several_platforms(entry: Entry, tmp_path: Path) -> None:
    options = [word for name in MAGIC for word in ("--platform", name)]
    done = entry("export", "fmu", "--use", "linear-ramp", "--fmi", 3, *options, "--out", "motor.fmu")
    assert done.code == DONE, done.stderr
    with zipfile.ZipFile(tmp_path / "motor.fmu") as archive:
        for name, magic in MAGIC.items():
            of = compiler.PLATFORMS[name]
            assert archive.read(f"binaries/{of.folder3}/motor{of.ending}").startswith(magic)
