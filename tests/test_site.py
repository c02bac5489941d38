"""The documentation site builds strictly from any folder of pages; they load nothing from outside and are short."""

from __future__ import annotations

import doctest
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

import waxstudy as wx
from docs_site import links, order, tables
from docs_site.components import components
from docs_site.folders import about, folders
from docs_site.reference import PAGES
from tests.conftest import ROOT
from tests.report.test_page import browse, needs_browser
from waxstudy.cli import COMMANDS
from waxstudy.plugin.registry import installed

TABLES = ("[study]", "[comfort]", "[ensemble.weather.NAME]", "[ladder.NAME.start]", "hours_below_per_week")

SCREEN = (1280, 800)  # pixels
SCREENS = 3  # at most, of what is read; the widths of words are those of Arial or Liberation Sans
LONGER = {  # pages that may be longer, and why; those of reference/ are written while the site is built
    "bench": "generated, one table of parameters",
    "blind_test_table": "generated, tables of the newest judged run",
    "checks": "generated, one table of all checks",
    "criteria": "generated, tables of all limits that decide",
    "effect-list": "generated, all effects and what is uncertain of a room, in two tables",
    "gallery": "generated, a picture for each thing that waxstudy can do",
}
NEW = "quite-new"  # a page of the tests'

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


def test_the_generated_pages_call_others_by_their_titles() -> None:
    pattern = re.compile(r"\[([A-Z][\w ]+|waxstudy [\w ]+)\]\(\.\./([\w-]+\.md)")
    calls = [(name, *call) for name, written in PAGES.items() for call in pattern.findall(written())]
    assert calls
    for name, words, page in calls:
        title = (ROOT / "docs" / page).read_text(encoding="utf-8").partition("\n")[0]
        assert title.partition(":")[0] == f"# {words}", f"{name}: {words}"


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


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the pages and of one that no navigation names, and their site."""
    folder = tmp_path_factory.mktemp("pages")
    shutil.copytree(ROOT / "docs", folder / "docs")
    (folder / "docs" / f"{NEW}.md").write_text(
        "# Quite new\n\n[A study](../studies/table5.toml), [the room](room-equations.md)\n", encoding="utf-8"
    )
    done = build(folder, folder / "site")
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.mark.slow
def test_the_site_takes_in_new_pages_loads_nothing_from_outside_and_refuses_a_dead_link(
    source: Path, tmp_path: Path
) -> None:
    docs, site = source / "docs", source / "site"
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
    shutil.copytree(docs, tmp_path / "docs")
    (tmp_path / "docs" / f"{NEW}.md").write_text("# Quite new\n\n[The room](room.md#no-such-heading)\n", "utf-8")
    refused = build(tmp_path, tmp_path / "site")
    assert refused.returncode != 0
    assert "no-such-heading" in refused.stdout + refused.stderr


def heights(place: Path, site: Path, names: Sequence[str]) -> dict[str, float]:
    """How many screens high the text of each page is."""
    script = f"""const found = {{}}, frame = document.createElement("iframe"), names = {json.dumps(names)};
        [frame.width, frame.height] = {json.dumps(SCREEN)};
        const next = () => {{
            if (names.length) frame.src = names[0];
            else document.title = "heights " + JSON.stringify(found);
        }};
        frame.onload = () => {{
            if (!frame.src) return;
            const text = frame.contentDocument.querySelector("article");
            found[names.shift()] = text.getBoundingClientRect().height;
            next();
        }};
        document.body.append(frame);
        next()"""
    file = site / "heights.html"
    file.write_text(f"<!DOCTYPE html><title></title><body><script>{script}</script>", encoding="utf-8")
    options = ("--allow-file-access-from-files", "--hide-scrollbars", "--virtual-time-budget=60000", "--dump-dom")
    told = re.search(r"<title>heights (.*?)</title>", browse(place, file, SCREEN[0] + 100, *options))
    assert told, "the browser did not come to the last page"
    return {name: height / SCREEN[1] for name, height in json.loads(told[1]).items()}


@needs_browser
@pytest.mark.slow
def test_no_page_that_is_written_by_hand_is_longer_than_three_screens(source: Path, tmp_path: Path) -> None:
    pages = {path.stem for path in (ROOT / "docs").glob("*.md")}
    assert set(LONGER) <= pages
    found = heights(tmp_path, source / "site", [f"{name}.html" for name in sorted(pages)])
    assert len(found) == len(pages)
    long = {Path(name).stem: height for name, height in found.items() if height > SCREENS}
    assert "gallery" in long  # so a long page is seen
    too_long = [f"{name}.md: {height:.2f}" for name, height in long.items() if name not in LONGER]
    assert not too_long, f"longer than {SCREENS} screens: {', '.join(too_long)}"
