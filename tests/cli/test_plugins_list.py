"""`waxstudy plugins list`: every component by kind with its package, and broken plugins with their reason."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cli.conftest import Entry, Plugin
from waxstudy import __version__
from waxstudy.plugin import KINDS
from waxstudy.plugin.registry import installed


@pytest.fixture
def with_broken(plugin: Plugin, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A plugin beside the others that cannot be imported."""
    monkeypatch.syspath_prepend(plugin("stranger", 'raise RuntimeError("no licence server")')["PYTHONPATH"])
    installed.cache_clear()
    yield
    sys.modules.pop("stranger", None)
    installed.cache_clear()


def test_every_kind_is_listed_in_the_order_of_the_chain(entry: Entry) -> None:
    done = entry("plugins", "list")
    assert (done.code, done.stderr) == (0, "")
    heading, *rows = [line for line in done.stdout.splitlines() if line[:1].strip()]
    assert heading.split() == ["kind", "name", "package", "what", "it", "is"]
    assert list(dict.fromkeys(row.split()[0] for row in rows)) == list(KINDS)


def test_each_component_stands_with_its_package_and_version(entry: Entry) -> None:
    lines = entry("plugins", "list").stdout.splitlines()
    (row,) = [line for line in lines if line.split()[:2] == ["valve", "quick-opening"]]
    assert row.split()[2:4] == ["waxstudy", __version__]
    assert "Three-point quick-opening curve" in row


def test_no_name_is_cut_off_in_a_narrow_terminal(entry: Entry, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "40")
    rows = [line.split() for line in entry("plugins", "list").stdout.splitlines() if line[:1].strip()]
    assert {(row[0], row[1]) for row in rows[1:]} == set(installed().components)


@pytest.mark.usefixtures("with_broken")
def test_a_broken_plugin_is_listed_in_a_line_with_its_reason_and_place(entry: Entry, tmp_path: Path) -> None:
    done = entry("plugins", "list")
    assert (done.code, done.stderr) == (0, "")
    where = tmp_path / "strangers" / "stranger.py"
    assert done.stdout.splitlines()[-1] == f"broken: stranger: RuntimeError: no licence server ({where}:1)"


@pytest.mark.usefixtures("with_broken")
def test_json_holds_the_same(entry: Entry, tmp_path: Path) -> None:
    done = entry("plugins", "list", "--json")
    assert (done.code, done.stderr) == (0, "")
    said = json.loads(done.stdout)
    assert set(said) == {"components", "broken"}
    assert [(row["kind"], row["name"]) for row in said["components"]] == sorted(
        installed().components, key=lambda key: (KINDS.index(key[0]), key[1])
    )
    assert {"kind": "valve", "name": "linear", "package": "waxstudy", "version": __version__} in said["components"]
    where = tmp_path / "strangers" / "stranger.py"
    assert said["broken"] == [{"plugin": "stranger", "reason": f"RuntimeError: no licence server ({where}:1)"}]


def test_without_a_broken_plugin_none_is_mentioned(entry: Entry) -> None:
    assert "broken:" not in entry("plugins", "list").stdout
    assert json.loads(entry("plugins", "list", "--json").stdout)["broken"] == []
