"""A study that uses a broken plugin ends with its exit code and a message that leads to the fault, in both modes."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tests.cli.conftest import Entry
from tests.cli.folders import finished_cases
from tests.conformance.broken.catalogue import USED
from tests.conformance.broken.plugin import DONE, FAILED, PLUGIN, install, module_of, start, state, valve
from tests.conftest import Waxstudy

STUDY = """\
[study]
name = "small"
step_s = 60

[room]
use = "nzeb"

[weather.january]
use = "tallinn-week"
month = "january"

[ensemble]
members = 1

[ladder.on-off]
reference = "O_0"
start = { id = "O_0", controller = { use = "on-off" }, valve = { use = "VALVE" } }
steps = []
"""
TWO_WEEKS = STUDY.replace(
    "[ensemble]", '[weather.february]\nuse = "tallinn-week"\nmonth = "february"\n\n[ensemble]'
).replace("steps = []", 'steps = [{ id = "O_CP", controller = { dead_band_K = 0.5 } }]')

STOPPED = [name for name, plugin in USED.items() if plugin.code not in (None, DONE)]
FINISHED = [name for name, plugin in USED.items() if plugin.code == DONE]
MODES = {"compiled": (), "interpreted": ("--no-jit",)}
MOST_LINES = 14
PRINTED = ("opening ", "... (what plugins print")  # by one of them, and what is said of it


def study(name: str, text: str = STUDY) -> Path:
    """Write the study of a valve into the present folder."""
    path = Path("small.toml")
    path.write_text(text.replace("VALVE", name))
    return path


def warned(name: str, mode: str) -> str:
    """How the warning for a valve begins that cannot be compiled, if it is due."""
    slow = USED[name].slow and mode == "compiled"
    return f"warning: valve '{name}' cannot be compiled and runs in Python, many times slower: " if slow else ""


@pytest.mark.usefixtures("all_installed")
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", STOPPED)
def test_a_run_that_fails_names_the_block_its_file_and_its_fault(entry: Entry, name: str, mode: str) -> None:
    plugin = USED[name]
    code, says = plugin.code, plugin.run
    if mode == "interpreted" and plugin.interpreted:
        code, says = plugin.interpreted
    done = entry("run", study(name), *MODES[mode])
    assert (done.code, done.stdout) == (code, "")
    lines = done.stderr.splitlines()
    warning = warned(name, mode)
    assert lines[0].startswith(warning)
    if warning:
        del lines[0]
    assert f"valve '{name}'" in lines[0]
    assert says in lines[0]
    assert "pydantic.dev" not in done.stderr
    assert "site-packages" not in done.stderr
    assert len(lines) <= MOST_LINES
    if plugin.stage == "output":
        assert re.search(rf"{module_of(name)}\.py\"?, line \d+", done.stderr)
    if plugin.stage == "output" and code == FAILED:
        assert re.match(r"error: case O_0, january: .* at (day \d, [\d:]{8}|\d+ s before the week)", lines[0])


@pytest.mark.usefixtures("all_installed")
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("name", FINISHED)
def test_a_run_that_goes_on_warns_of_what_is_slow_and_of_nothing_else(entry: Entry, name: str, mode: str) -> None:
    done = entry("run", study(name), "--json", *MODES[mode])
    assert done.code == DONE
    assert json.loads(done.stdout)["rows"]
    lines = [line for line in done.stderr.splitlines() if not line.startswith(PRINTED)]
    warning = warned(name, mode)
    assert len(lines) == (1 if warning else 0)
    assert done.stderr.startswith(warning)


@pytest.mark.usefixtures("all_installed")
def test_what_a_step_prints_does_not_flood_the_terminal(entry: Entry) -> None:
    done = entry("run", study("prints"))
    assert done.code == DONE
    assert "opening" not in done.stdout.splitlines()
    assert len(done.stderr.splitlines()) <= MOST_LINES


@pytest.mark.usefixtures("all_installed")
def test_a_block_in_python_gives_the_figures_of_the_interpreter_and_one_warning(entry: Entry) -> None:
    path = study("uses-a-dict", TWO_WEEKS)
    done = entry("run", path, "--out", "mixed")
    assert done.code == DONE
    (line,) = done.stderr.splitlines()
    assert line.startswith(warned("uses-a-dict", "compiled"))
    assert entry("run", path, "--out", "python", "--no-jit").stderr == ""
    mixed, python = finished_cases(Path("mixed")), finished_cases(Path("python"))
    assert len(mixed) >= 4
    assert mixed == python


WIDE = 'output = Port("level", "1", -1e12, 1e12)'
RING = "State = Memory\n" + start("return Memory(Ring(3))")
CRASHES = {
    "far-below-its-kind": valve("return -1e9", body=WIDE),
    "ring-made-longer": valve(
        "x.memory.length = 10**8\nreturn delayed(x.memory, u)", before=state("memory: Ring"), body=RING
    ),
    "ring-read-beyond-its-end": valve(
        "u = delayed(x.memory, u)\nx.memory.head = 10**8\nreturn u", before=state("memory: Ring"), body=RING
    ),
}


@pytest.mark.parametrize("name", CRASHES)
def test_no_step_reads_outside_its_memory(waxstudy: Waxstudy, tmp_path: Path, name: str) -> None:
    install(tmp_path / "strangers", name, CRASHES[name])
    (tmp_path / "small.toml").write_text(STUDY.replace("VALVE", name))
    done = waxstudy("run", "small.toml", env={"PYTHONPATH": str(tmp_path / "strangers")})
    assert done.returncode in (PLUGIN, FAILED)
    assert f"valve '{name}'" in done.stderr
    assert "Traceback" not in done.stderr
