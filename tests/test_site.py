"""The documentation site builds strictly from any folder of pages, and its pages load nothing from outside."""

from __future__ import annotations

import doctest
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import waxstudy as wx
from docs_site import links, order, tables
from docs_site.components import components
from docs_site.folders import about, folders
from tests.conftest import ROOT
from waxstudy.cli import COMMANDS
from waxstudy.plugin.registry import installed

TABLES = ("[study]", "[comfort]", "[ensemble.weather.NAME]", "[ladder.NAME.start]", "hours_below_per_week")

LOADED = re.compile(r"<(?:script|img|iframe|source)\b[^>]*\bsrc=\"?(https?:)?//|<link\b[^>]*\bhref=\"?(https?:)?//")


@pytest.mark.parametrize("module", [links, order, tables])
def test_the_examples_of_the_site_hold(module: object) -> None:
    tried = doctest.testmod(module)  # type: ignore[arg-type]
    assert tried.attempted
    assert not tried.failed


def test_every_folder_of_the_code_says_what_it_holds_and_has_its_row() -> None:
    page = folders()
    for place in ("waxstudy", "waxstudy/diagnosis", "plugins"):
        for package in (path.parent for path in (ROOT / place).glob("*/__init__.py")):
            assert f"| `{package.name}` | " in page, f"{package}: no layer of [tool.importlinter] names it"
            assert about(package), f"{package}: no docstring"


def test_the_reference_has_every_key_of_a_component_with_its_unit_also_of_tables_inside() -> None:
    rows = {line.split(" | ")[0].strip("| `"): line for line in components().splitlines() if line.startswith("| `")}
    assert "\\[W/m2]" in rows["shading.above_W_m2"]
    assert "`300.0`" in rows["shading.above_W_m2"]
    for entry in installed().components.values():
        if entry.component.kind != "effect":
            for name in entry.component.Parameters.model_fields:
                assert name in rows or any(key.startswith(f"{name}.") for key in rows), (
                    f"{entry.component.name}: {name}"
                )


def build(source: Path, site: Path) -> subprocess.CompletedProcess[str]:
    """Build the site of a copy of the repository's pages."""
    settings = source / "mkdocs.yml"
    paths = f"paths: [{ROOT}, {ROOT / 'plugins'}]"
    text = (ROOT / "mkdocs.yml").read_text(encoding="utf-8").replace("paths: [., plugins]", paths)
    settings.write_text(text.replace("docs_site/", f"{ROOT}/docs_site/"), encoding="utf-8")
    command = [sys.executable, "-m", "mkdocs", "build", "--config-file", str(settings), "--site-dir", str(site)]
    # a proxy that nobody answers: what asked the network would fail
    env = os.environ | {
        "NO_MKDOCS_2_WARNING": "1",
        "https_proxy": "http://localhost:9",
        "http_proxy": "http://localhost:9",
    }
    return subprocess.run(command, cwd=ROOT, env=env, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_the_site_takes_in_new_pages_loads_nothing_from_outside_and_refuses_a_dead_link(tmp_path: Path) -> None:
    docs, site = tmp_path / "docs", tmp_path / "site"
    shutil.copytree(ROOT / "docs", docs)
    new = docs / "quite-new.md"
    new.write_text(
        "# Quite new\n\n[A study](../studies/table5.toml), [the room](room-equations.md)\n", encoding="utf-8"
    )
    done = build(tmp_path, site)
    assert done.returncode == 0, done.stdout + done.stderr
    pages = {path.name: path.read_text(encoding="utf-8") for path in site.rglob("*.html")}
    assert {page.with_suffix(".html").name for page in docs.glob("*.md")} <= set(pages)
    assert not [name for name, text in pages.items() if LOADED.search(text)]
    assert order.FURTHER in pages["room.html"]
    told = {
        "commands": COMMANDS,
        "study-keys": TABLES,
        "effects": installed().names("effect"),
        "python": set(wx.__all__) - {"__version__", "hookimpl"},
    }
    for page, names in told.items():
        text = (site / "reference" / f"{page}.html").read_text(encoding="utf-8")
        assert not [name for name in names if name not in text], page
    assert re.search(r"fit_valve</span><span[^>]*>\(", text), "the last page has no signatures"
    assert "quite-new.html" in pages["room.html"]
    assert "A study (<code>studies/table5.toml</code>)" in pages["quite-new.html"]
    new.write_text("# Quite new\n\n[The room](room.md#no-such-heading)\n", encoding="utf-8")
    refused = build(tmp_path, site)
    assert refused.returncode != 0
    assert "no-such-heading" in refused.stdout + refused.stderr
