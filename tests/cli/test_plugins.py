"""Plugins that are broken, clash or fail: what they take down, and what they must not."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.cli.conftest import Entry, Plugin
from tests.cli.folders import finished_cases
from tests.conftest import SMALL, Waxstudy
from waxstudy.plugin.registry import installed

INVALID, PLUGIN, FAILED = 3, 4, 6

IMPORTS = "from waxstudy.plugin import Actuator, Room, Valve, Weather, hookimpl\n"
REGISTER = """
@hookimpl
def {hook}(register):
    register({component})
"""
VALVE = """
class Extra(Valve):
    name = "{name}"

    @staticmethod
    def step(p, x, u, t, dt):
        return u
"""


def offering(component: str, source: str, hook: str = "waxstudy_register") -> str:
    return IMPORTS + source + REGISTER.format(hook=hook, component=component)


BROKEN = {
    "import raises": ('raise RuntimeError("no licence server")', "RuntimeError: no licence server"),
    "import exits": ('import sys\nsys.exit("no licence server")', "SystemExit: no licence server"),
    "syntax": ("def broken(:\n    pass", "SyntaxError: "),
    "misspelled hook": (offering("Extra", VALVE.format(name="extra"), "waxstudy_registre"), "waxstudy_registre"),
    "hook raises": (offering("Missing", ""), "NameError: name 'Missing' is not defined"),
    "no component": (offering("int", ""), "<class 'int'> is no component: register classes derived from Actuator"),
    "nothing": ("", "registers nothing"),
    "other API": (offering("Extra", VALVE.format(name="extra") + '    api_version = "9.0"\n'), "plugin API 9.0"),
}


@pytest.fixture
def loaded(plugin: Plugin, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str], None]]:
    """Install a plugin for the entry point as it is called within the test process."""

    def load(source: str) -> None:
        monkeypatch.syspath_prepend(plugin("stranger", source)["PYTHONPATH"])
        installed.cache_clear()

    yield load
    sys.modules.pop("stranger", None)
    installed.cache_clear()


@pytest.mark.parametrize(("source", "reason"), BROKEN.values(), ids=BROKEN)
def test_a_broken_plugin_stops_only_a_study_that_may_need_it(
    entry: Entry, loaded: Callable[[str], None], small_study: Path, small_run: Path, source: str, reason: str
) -> None:
    loaded(source)
    done = entry("run", small_study, "--out", "run")
    assert (done.code, done.stderr) == (0, "")
    small_study.write_text(SMALL.replace("quick-opening", "extra"))
    done = entry("run", small_study)
    assert (done.code, done.stdout) == (PLUGIN, "")
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"{small_study}:19: case O_WM: valve.use = \"extra\": no valve 'extra' (installed: linear, ")
    assert "plugin 'stranger' is broken: " in line
    assert reason in line


def test_a_name_that_two_plugins_claim_stops_only_a_study_that_uses_it(
    entry: Entry, loaded: Callable[[str], None], small_study: Path, small_run: Path
) -> None:
    loaded(offering("Extra", VALVE.format(name="linear")))
    done = entry("run", small_study, "--out", "run")
    assert (done.code, done.stdout) == (PLUGIN, "")
    claimed = "valve.use = \"linear\": valve 'linear' of stranger 1.0 is registered already by waxstudy "
    assert done.stderr.startswith(f"{small_study}:16: case O_0: {claimed}")
    small_study.write_text(SMALL.replace(', valve = { use = "linear" }', ""))
    done = entry("run", small_study, "--out", "run")
    assert (done.code, done.stderr) == (0, "")


def test_an_actuator_that_fails_does_not_spoil_the_report_of_a_study_without_it(
    entry: Entry, loaded: Callable[[str], None], small_run: Path
) -> None:
    source = VALVE.format(name="seized").replace("Valve", "Actuator").replace("return u", "return 1.0 / 0.0")
    loaded(offering("Extra", source))
    done = entry("report", "run")
    assert (done.code, done.stderr) == (0, "")
    assert "variable-times, product B" in done.stdout
    assert "seized" not in done.stdout


# --- components that fail when they are used ---------------------------------------------------------

SEIZED = VALVE.format(name="extra").replace(
    "        return u", "        if t >= 3600.0:\n            {what}\n        return u"
)


RAISES = ('raise ValueError("bearing seized")', "failed at day 1, 01:00:00 with input ")
GIVES_NAN = ('return float("nan")', "failed at day 1, 01:00:00 with input ")


@pytest.mark.parametrize(
    ("what", "says", "options"),
    [(*RAISES, ()), (*RAISES, ("--no-jit",)), (*GIVES_NAN, ())],
    ids=["raises", "raises interpreted", "nan"],
)
def test_a_block_that_fails_is_named_with_its_case_week_and_time(
    waxstudy: Waxstudy,
    plugin: Plugin,
    small_study: Path,
    small_run: Path,
    what: str,
    says: str,
    options: tuple[str, ...],
) -> None:
    before = finished_cases(small_run)
    env = plugin("stranger", offering("Extra", SEIZED.format(what=what)))
    small_study.write_text(SMALL.replace("quick-opening", "extra"))
    done = waxstudy("run", small_study, "--out", "run", *options, env=env)
    assert (done.returncode, done.stdout) == (FAILED, "")
    first, *traceback = done.stderr.splitlines()
    assert first.startswith(f"error: case O_WM, january: valve 'extra' {says}")
    assert first.endswith(
        "ValueError: bearing seized" if "seized" in what else "it returned nan, not a level from 0 to 1"
    )
    assert re.match(r'  File ".*stranger.py", line \d+, in step', traceback[0])
    assert finished_cases(small_run).items() >= before.items()


UNFORESEEN = {
    "start": (
        VALVE.format(name="extra") + '\n    @classmethod\n    def start(cls, p, dt):\n        return p["nothing"]\n',
        SMALL.replace("quick-opening", "extra"),
        FAILED,
        "error: case O_WM, january: valve 'extra': its start failed: TypeError: ",
    ),
    "weather": (
        'class Extra(Weather):\n    name = "extra"\n\n    @classmethod\n    def load(cls, p, facades):\n'
        '        return {}["south"]\n',
        SMALL.replace('"tallinn-week"\nmonth = "january"', '"extra"'),
        PLUGIN,
        "error: [weather.january]: KeyError: 'south' (",
    ),
    "room": (
        'class Extra(Room):\n    name = "extra"\n\n    @classmethod\n    def build(cls, p):\n        return p.walls\n',
        SMALL.replace('"nzeb"', '"extra"'),
        PLUGIN,
        "error: [room]: AttributeError: 'Parameters' object has no attribute 'walls' (",
    ),
    "room's reason": (
        'class Extra(Room):\n    name = "extra"\n\n    @classmethod\n    def build(cls, p):\n'
        '        raise ValueError("a wall is missing")\n',
        SMALL.replace('"nzeb"', '"extra"'),
        INVALID,
        "{study}:4: [room]: a wall is missing",
    ),
}


@pytest.mark.parametrize(("source", "study", "code", "says"), UNFORESEEN.values(), ids=UNFORESEEN)
def test_what_a_plugin_raises_is_one_line(
    waxstudy: Waxstudy, plugin: Plugin, small_study: Path, source: str, study: str, code: int, says: str
) -> None:
    small_study.write_text(study)
    done = waxstudy("run", small_study, env=plugin("stranger", offering("Extra", source)))
    assert (done.returncode, done.stdout) == (code, "")
    (line,) = done.stderr.splitlines()
    assert line.startswith(says.format(study=small_study))
