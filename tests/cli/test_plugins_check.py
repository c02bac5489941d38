"""`waxstudy plugins check`: the stages of the kit for a registered name or a class in a module."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cli.conftest import Entry
from waxstudy.plugin.registry import installed

CHECK_FAILED, USAGE, PLUGIN = 1, 2, 4
MOTOR = '''
from waxstudy.plugin import Actuator


class Motor(Actuator):
    """Follows its signal."""

    name = "motor"
    api_version = "1.0"

    @staticmethod
    def step(p, x, u, t, dt):
        STEP
'''
RIGHT, WRONG = "return u", "return 2.0 * u"
STAGES = [
    "declaration",
    "parameters",
    "examples",
    "ports",
    "state",
    "output",
    "reproducible",
    "restore",
    "compiled",
    "step-halving",
]


@pytest.fixture
def here(entry: Entry, tmp_path: Path) -> Iterator[Path]:
    """The present folder, with a right motor and a wrong one in modules of their own."""
    for name, step in {
        "right_motor": RIGHT,
        "wrong_motor": WRONG,
        "loud_motor": f'print("click")\n        {RIGHT}',
    }.items():
        (tmp_path / f"{name}.py").write_text(MOTOR.replace("STEP", step))
    (tmp_path / "loud_import.py").write_text('print("hello")\n' + MOTOR.replace("STEP", RIGHT))
    (tmp_path / "no_import.py").write_text('raise RuntimeError("no licence server")\n')
    path = list(sys.path)
    yield tmp_path
    sys.path[:] = path
    for name in ("right_motor", "wrong_motor", "loud_motor", "loud_import", "no_import"):
        sys.modules.pop(name, None)


def test_a_class_of_the_present_folder_is_checked(entry: Entry, here: Path) -> None:
    done = entry("plugins", "check", "right_motor:Motor")
    assert (done.code, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert lines[0] == "right_motor:Motor"
    assert [line.split()[:2] for line in lines[3:13]] == [[stage, "passed"] for stage in STAGES]
    assert lines[-1] == "it keeps its contract"


def test_a_class_that_fails_ends_with_exit_code_1_and_what_to_do(entry: Entry, here: Path) -> None:
    done = entry("plugins", "check", "wrong_motor:Motor")
    assert (done.code, done.stderr) == (CHECK_FAILED, "")
    said = [line for line in done.stdout.splitlines() if line.startswith("output: ")]
    assert said[0].endswith("it returned 2, not a level from 0 to 1")
    assert "step-halving  not run" in done.stdout
    assert done.stdout.splitlines()[-1] == "1 of 10 stages failed"


def test_json_holds_each_stage_with_its_messages(entry: Entry, here: Path) -> None:
    done = entry("plugins", "check", "wrong_motor:Motor", "--json")
    assert (done.code, done.stderr) == (CHECK_FAILED, "")
    said = json.loads(done.stdout)
    assert said["passed"] is False
    (component,) = said["components"]
    assert component["component"] == "wrong_motor:Motor"
    assert [stage["stage"] for stage in component["stages"]] == STAGES
    status = {stage["stage"]: stage["status"] for stage in component["stages"]}
    assert (status["state"], status["output"], status["restore"]) == ("passed", "failed", "not run")
    messages = {stage["stage"]: stage["messages"] for stage in component["stages"]}
    assert "it returned 2, not a level" in messages["output"][0]
    assert messages["restore"] == ["needs 'output'"]


def test_a_name_that_two_kinds_have_checks_both(entry: Entry) -> None:
    done = entry("plugins", "check", "ideal", "--json")
    assert done.code == 0
    titles = [component["component"] for component in json.loads(done.stdout)["components"]]
    assert [title.partition(" of ")[0] for title in titles] == ["actuator 'ideal'", "sensor 'ideal'"]


def test_an_exemption_is_told_with_its_reason(entry: Entry) -> None:
    done = entry("plugins", "check", "epw")
    assert (done.code, done.stderr) == (0, "")
    reason = installed().components["weather", "epw"].component.exemptions["examples"]
    assert f"examples: {reason}" in done.stdout.splitlines()


def test_an_unknown_name_is_answered_with_the_nearest(entry: Entry) -> None:
    done = entry("plugins", "check", "quick-openning")
    assert (done.code, done.stdout) == (PLUGIN, "")
    assert "; did you mean 'quick-opening'? (installed: " in done.stderr


def test_a_module_without_its_class_is_told_how_to_write_it(entry: Entry, here: Path) -> None:
    done = entry("plugins", "check", "right_motor")
    assert (done.code, done.stdout) == (PLUGIN, "")
    assert "right_motor:" in done.stderr


IMPORTS = {
    "no module": ("no_such_motor:Motor", "import: no module 'no_such_motor' in "),
    "no class": ("right_motor:Moter", "import: module 'right_motor' has no 'Moter'; did you mean 'Motor'?"),
    "raises": ("no_import:Motor", "import: RuntimeError: no licence server ("),
    "no component": ("right_motor:Actuator", "declaration: "),
}


@pytest.mark.parametrize(("target", "says"), IMPORTS.values(), ids=IMPORTS)
def test_what_cannot_be_imported_fails_the_check(entry: Entry, here: Path, target: str, says: str) -> None:
    done = entry("plugins", "check", target)
    assert (done.code, done.stderr) == (CHECK_FAILED, "")
    assert [line for line in done.stdout.splitlines() if line.startswith(says)]
    assert json.loads(entry("plugins", "check", target, "--json").stdout)["passed"] is False


def test_a_module_that_exits_at_import_fails_the_check(entry: Entry, here: Path) -> None:
    (here / "no_import.py").write_text("class Ended(BaseException):\n    pass\n\n\nraise Ended('licence')\n")
    done = entry("plugins", "check", "no_import:Motor")
    assert (done.code, done.stderr) == (CHECK_FAILED, "")
    assert f"import: Ended: licence ({here / 'no_import.py'}:5)" in done.stdout.splitlines()


MALFORMED = ("right_motor:", ":Motor", ":", "..right_motor:Motor")


@pytest.mark.parametrize("target", MALFORMED)
def test_a_malformed_target_is_told_how_to_write_it(entry: Entry, here: Path, target: str) -> None:
    done = entry("plugins", "check", target)
    assert done.code in (CHECK_FAILED, USAGE)
    assert "MODULE:CLASS" in done.stdout + done.stderr


@pytest.mark.parametrize("module", ["loud_motor", "loud_import"])
def test_json_stays_valid_when_the_plugin_prints(entry: Entry, here: Path, module: str) -> None:
    done = entry("plugins", "check", f"{module}:Motor", "--json")
    assert json.loads(done.stdout)["components"][0]["component"] == f"{module}:Motor"
