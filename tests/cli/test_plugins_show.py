"""`waxstudy plugins show`: parameters, state, input and output of a component, and where its source is."""

from __future__ import annotations

import inspect
import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.cli.conftest import Entry, Plugin
from waxstudy.plugin.registry import installed

PLUGIN = 4
VALVE = '''
from dataclasses import dataclass

from waxstudy.plugin import Parameters, Ring, Valve, hookimpl, parameter


class Play(Parameters):
    width_mm: float = parameter(0.25, unit="mm", ge=0, le=2, description="Play of the stem.", source="maker X, page 3")
    stroke_mm: float = parameter(unit="mm", gt=0, le=9, description="Full stroke.", source="maker X, page 2")


@dataclass
class Stem:
    place: float = 0.5
    turns: int = 3
    memory: Ring = None


class Worn(Valve):
    """A valve with play in its stem."""

    name = "worn"
    api_version = "1.0"
    Parameters = Play
    State = Stem
    examples = {"new": {"stroke_mm": 4.0}}
    exemptions = {"step-halving": "The stem jumps by its play at any step."}

    @classmethod
    def start(cls, p, dt):
        START

    @staticmethod
    def step(p, x, u, t, dt):
        return u


@hookimpl
def waxstudy_register(register):
    register(Worn)
'''
RIGHT = "return Stem(p.width_mm / p.stroke_mm, 3, Ring(2))"
Load = Callable[[str], Path]


@pytest.fixture
def worn(plugin: Plugin, monkeypatch: pytest.MonkeyPatch) -> Iterator[Load]:
    """Install the worn valve with this start; return its file."""

    def load(start: str) -> Path:
        place = plugin("stranger", VALVE.replace("START", start))["PYTHONPATH"]
        monkeypatch.syspath_prepend(place)
        installed.cache_clear()
        return Path(place) / "stranger.py"

    yield load
    sys.modules.pop("stranger", None)
    installed.cache_clear()


def test_each_parameter_has_its_unit_range_default_and_source(entry: Entry, worn: Load) -> None:
    worn(RIGHT)
    done = entry("plugins", "show", "worn")
    assert (done.code, done.stderr) == (0, "")
    (width,) = [line for line in done.stdout.splitlines() if line.startswith("width_mm")]
    assert " ".join(width.split()) == "width_mm mm 0 to 2 0.25 Play of the stem. maker X, page 3"
    (stroke,) = [line for line in done.stdout.splitlines() if line.startswith("stroke_mm")]
    assert stroke.split()[1:6] == ["mm", ">", "0", "to", "9"]
    assert "required" in stroke


def test_the_state_stands_with_its_values_at_the_start_of_the_first_example(entry: Entry, worn: Load) -> None:
    worn(RIGHT)
    lines = [line.split() for line in entry("plugins", "show", "worn").stdout.splitlines()]
    assert ["place", "float", "0.0625"] in lines
    assert ["turns", "int", "3"] in lines
    assert ["memory", "Ring", "empty"] in lines


def test_input_output_source_file_and_exemptions_are_shown(entry: Entry, worn: Load) -> None:
    file = worn(RIGHT)
    lines = entry("plugins", "show", "worn").stdout.splitlines()
    assert lines[0] == "valve 'worn' of stranger 1.0 (API 1.0)"
    line = VALVE.splitlines().index("class Worn(Valve):") + 1
    assert lines[1] == f"{file}:{line}"
    assert "A valve with play in its stem." in lines
    assert "input:   level [1], 0 to 1" in lines
    assert "output:  level [1], 0 to 1" in lines
    assert "exempt from step-halving: The stem jumps by its play at any step." in lines


def test_json_holds_the_same(entry: Entry, worn: Load) -> None:
    worn(RIGHT)
    done = entry("plugins", "show", "worn", "--json")
    assert (done.code, done.stderr) == (0, "")
    (shown,) = json.loads(done.stdout)
    assert [shown[key] for key in ("kind", "name", "package", "version", "api_version")] == [
        "valve",
        "worn",
        "stranger",
        "1.0",
        "1.0",
    ]
    width, stroke = shown["parameters"]
    assert width == {
        "name": "width_mm",
        "unit": "mm",
        "range": "0 to 2",
        "default": 0.25,
        "required": False,
        "description": "Play of the stem.",
        "source": "maker X, page 3",
    }
    assert (stroke["required"], stroke["default"]) == (True, None)
    assert [(field["name"], field["type"]) for field in shown["state"]] == [
        ("place", "float"),
        ("turns", "int"),
        ("memory", "Ring"),
    ]
    assert shown["state"][0]["start"] == 0.0625
    assert shown["output"] == {"quantity": "level", "unit": "1", "low": 0.0, "high": 1.0}


def test_a_state_in_json_holds_no_memory_address(entry: Entry, worn: Load) -> None:
    worn(RIGHT)
    assert " at 0x" not in entry("plugins", "show", "worn", "--json").stdout


def test_a_name_that_two_kinds_have_shows_both(entry: Entry) -> None:
    names = [name for _, name in installed().components]
    assert names.count("ideal") == 2
    done = entry("plugins", "show", "ideal")
    assert done.stdout.startswith("actuator 'ideal' of waxstudy ")
    assert "\nsensor 'ideal' of waxstudy " in done.stdout
    assert [shown["kind"] for shown in json.loads(entry("plugins", "show", "ideal", "--json").stdout)] == [
        "actuator",
        "sensor",
    ]


@pytest.mark.parametrize("key", sorted(installed().components))
def test_every_component_can_be_shown(entry: Entry, key: tuple[str, str]) -> None:
    done = entry("plugins", "show", key[1], "--json")
    assert (done.code, done.stderr) == (0, "")
    (shown,) = [shown for shown in json.loads(done.stdout) if shown["kind"] == key[0]]
    component = installed().components[key].component
    assert shown["documentation"] == inspect.getdoc(component)
    assert Path(shown["source_file"].rpartition(":")[0]).is_file()
    assert entry("plugins", "show", key[1]).code == 0


def test_an_unknown_name_is_answered_with_the_nearest(entry: Entry) -> None:
    done = entry("plugins", "show", "quick-openning")
    assert (done.code, done.stdout) == (PLUGIN, "")
    assert done.stderr.startswith(
        "error: no component 'quick-openning'; did you mean 'quick-opening'? (installed: constant-times, "
    )
    assert len(done.stderr.splitlines()) == 1


START_FAILS = {
    "raises": ('raise OSError("no such motor")', "OSError: no such motor"),
    "exits": ('raise SystemExit("no such motor")', "SystemExit: no such motor"),
    "gives no state": ("return None", "Stem"),
}


@pytest.mark.parametrize(("start", "says"), START_FAILS.values(), ids=START_FAILS)
def test_a_component_whose_start_fails_is_shown_with_that(entry: Entry, worn: Load, start: str, says: str) -> None:
    """Its parameters are what an author who looks for the fault needs."""
    worn(start)
    done = entry("plugins", "show", "worn")
    assert (done.code, done.stderr) == (0, "")
    assert "width_mm" in done.stdout
    assert says in done.stdout


UNFIT = {
    "a port": (
        "State = Stem",
        'State = Stem\n    input = "level"',
        "input: it must be a Port(quantity, unit, low, high)",
    ),
    "an example": (
        '"stroke_mm": 4.0',
        '"stroke_mm": 40.0',
        "state: ValidationError: 1 validation error for Play stroke_mm",
    ),
    "a validator": (
        "class Worn",
        "Play.model_post_init = lambda self, context: {}['page']\n\n\nclass Worn",
        "state: KeyError",
    ),
}


@pytest.mark.parametrize(("right", "wrong", "says"), UNFIT.values(), ids=UNFIT)
def test_what_does_not_fit_is_told_beside_the_rest(
    entry: Entry, plugin: Plugin, monkeypatch: pytest.MonkeyPatch, right: str, wrong: str, says: str
) -> None:
    source = VALVE.replace("START", RIGHT).replace(right, wrong)
    monkeypatch.syspath_prepend(plugin("stranger", source)["PYTHONPATH"])
    installed.cache_clear()
    done, as_json = entry("plugins", "show", "worn"), entry("plugins", "show", "worn", "--json")
    installed.cache_clear()
    del sys.modules["stranger"]
    assert (done.code, done.stderr, as_json.code) == (0, "", 0)
    assert "width_mm" in done.stdout
    assert [line for line in done.stdout.splitlines() if line.startswith(says)] == json.loads(as_json.stdout)[0][
        "problems"
    ]


def test_json_stays_valid_when_a_start_prints(entry: Entry, worn: Load) -> None:
    worn(f'print("click"); {RIGHT}')
    done = entry("plugins", "show", "worn", "--json")
    assert json.loads(done.stdout)[0]["problems"] == []
    assert done.stderr == "click\n"


def test_a_broken_plugin_says_why(entry: Entry, plugin: Plugin, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(plugin("stranger", 'raise RuntimeError("no licence server")')["PYTHONPATH"])
    installed.cache_clear()
    done = entry("plugins", "show", "stranger")
    installed.cache_clear()
    assert (done.code, done.stdout) == (PLUGIN, "")
    assert done.stderr.startswith("error: plugin 'stranger' is broken: RuntimeError: no licence server (")
