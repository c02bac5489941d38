"""What broken weather, rooms, figures and effects do is told in one line, which names the plugin or its table."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.cli.conftest import Entry
from tests.conformance.broken.plugin import CHECK_FAILED, PLUGIN, install, module_of
from tests.conformance.broken.surroundings import EFFECTS, MISTAKEN, REFERENCES, ROOMS, WEATHER, source
from tests.conformance.broken.test_runs import STUDY
from waxstudy.plugin.registry import installed

Offer = Callable[[str, str, str], None]


@pytest.fixture
def offer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Offer]:
    """Install one component for the test process."""

    def load(name: str, kind: str, body: str) -> None:
        install(tmp_path / "strangers", name, source(kind, body))
        monkeypatch.syspath_prepend(tmp_path / "strangers")
        installed.cache_clear()

    yield load
    for name in {**WEATHER, **ROOMS, **MISTAKEN, **REFERENCES, **EFFECTS}:
        sys.modules.pop(module_of(name), None)
    installed.cache_clear()


def study(text: str) -> Path:
    path = Path("small.toml")
    path.write_text(text.replace("VALVE", "linear"))
    return path


@pytest.mark.parametrize("name", WEATHER)
def test_broken_weather_is_told_in_a_line(entry: Entry, offer: Offer, name: str) -> None:
    offer(name, "Weather", WEATHER[name])
    done = entry("run", study(STUDY.replace('"tallinn-week"\nmonth = "january"', f'"{name}"')))
    assert (done.code, done.stdout) == (PLUGIN, "")
    (line,) = done.stderr.splitlines()
    assert "[weather.january]" in line


@pytest.mark.parametrize("name", ROOMS)
def test_a_broken_room_is_told_in_a_line(entry: Entry, offer: Offer, name: str) -> None:
    offer(name, "Room", ROOMS[name])
    done = entry("run", study(STUDY.replace('"nzeb"', f'"{name}"')))
    assert (done.code, done.stdout) == (PLUGIN, "")
    (line,) = done.stderr.splitlines()
    assert "[room]" in line


@pytest.mark.parametrize("name", [name for name in REFERENCES if name != "no-findings"])
def test_broken_published_figures_are_told_in_a_line(entry: Entry, offer: Offer, small_run: Path, name: str) -> None:
    offer(name, "Reference", REFERENCES[name])
    done = entry("report", small_run, "--against", name)
    assert (done.code, done.stdout) == (PLUGIN, "")
    (line,) = done.stderr.splitlines()
    assert f"reference '{name}'" in line


def test_published_figures_need_no_findings(entry: Entry, offer: Offer, small_run: Path) -> None:
    offer("no-findings", "Reference", REFERENCES["no-findings"])
    done = entry("report", small_run, "--against", "no-findings")
    assert (done.code, done.stderr) == (0, "")


@pytest.mark.parametrize("name", [*WEATHER, *ROOMS, "rows-raise", "rows-of-nothing"])
def test_the_kit_finds_each(entry: Entry, offer: Offer, name: str) -> None:
    kind = "Weather" if name in WEATHER else "Room" if name in ROOMS else "Reference"
    offer(name, kind, {**WEATHER, **ROOMS, **REFERENCES}[name])
    done = entry("plugins", "check", name)
    assert (done.code, done.stderr) == (CHECK_FAILED, "")
    assert "the check failed with" not in done.stdout


@pytest.mark.parametrize("name", EFFECTS)
def test_the_kit_says_of_each_effect_what_is_wrong(entry: Entry, offer: Offer, name: str) -> None:
    body, says = EFFECTS[name]
    offer(name, "Effect", body)
    done = entry("plugins", "check", name)
    assert (done.code, done.stderr) == (CHECK_FAILED, "")
    assert says in done.stdout
    assert "the check failed with" not in done.stdout


@pytest.mark.parametrize("name", MISTAKEN)
def test_the_kit_says_which_input_of_a_room_does_not_act_as_its_role_says(
    entry: Entry, offer: Offer, name: str
) -> None:
    body, says = MISTAKEN[name]
    offer(name, "Room", body)
    done = entry("plugins", "check", name)
    assert (done.code, done.stderr) == (CHECK_FAILED, "")
    assert says in " ".join(done.stdout.split())
    assert "the check failed with" not in done.stdout
