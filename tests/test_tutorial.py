"""The pages for plugin authors: the tutorial works as written, and the contract page says what is."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import pytest

from docs_site.stages import stages
from tests.conftest import ROOT, SMALL, call
from waxstudy.conformance.kit import BY_KIND, COMMON
from waxstudy.conformance.outside import OUTSIDE_STAGES
from waxstudy.plugin import CHAIN, KINDS, Block
from waxstudy.plugin.registry import PluginError, Registry
from waxstudy_ramp import LinearRamp

TUTORIAL = (ROOT / "docs/plugin-tutorial.md", ROOT / "docs/plugin-tutorial-study.md")  # read one after the other
CONTRACT, RAMP = ROOT / "docs/plugins.md", ROOT / "plugins/waxstudy_ramp.py"
OF_KINDS, PROMISES = ROOT / "docs/plugins-kinds.md", ROOT / "docs/plugins-kit.md"
FILE = re.compile(r"# (\S+\.\w+)")  # the first line of a block that is a file, or a change of one
REPOSITORY = "path/to/waxstudy"  # as the tutorial writes it
FAILS = "# exits with 1"
FAILED = 6


class Fence(NamedTuple):
    language: str  # "" for what a command prints
    text: str


def fences(page: Path) -> list[Fence]:
    found = re.findall(r"^```(\w*)\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    return [Fence(language, text) for language, text in found]


# --- the tutorial ----------------------------------------------------------------------------------


class Reader:
    """Somebody who follows the tutorial in an empty folder, and has no Python environment but the one it makes."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.activation = ""
        outside = {"PYTHONPATH", "PYTHONDONTWRITEBYTECODE", "VIRTUAL_ENV", "PYTEST_ADDOPTS"}
        self.environment = {name: value for name, value in os.environ.items() if name not in outside}
        self.environment |= {
            "PATH": f"{sys.base_prefix}/bin:/usr/bin:/bin",
            "COLUMNS": "120",
            "PIP_COMPILE": "0",  # only what is imported, when it is: a fraction of what is installed
            "WAXSTUDY_CACHE": str(folder / "cache"),
        }

    def follow(self, page: Path) -> Iterator[tuple[str, str]]:
        """Do what each block says, in order; yield what it printed, and what the page says that it prints."""
        for block, after in pairwise([*fences(page), Fence("", "")]):
            if block.language == "sh":
                printed = "".join(self.type(line) for line in block.text.splitlines())
                yield printed, after.text if not after.language else ""
            elif block.language == "diff":
                self.change(*self.named(block.text))
            elif block.language:
                path, text = self.named(block.text)
                path.write_text(text, encoding="utf-8")

    def named(self, text: str) -> tuple[Path, str]:
        first, _, rest = text.partition("\n")
        found = FILE.fullmatch(first)
        assert found, f"a block without the name of its file: {first}"
        return self.folder / found[1], rest

    def change(self, path: Path, lines: str) -> None:
        """Replace the line marked `-` by the one marked `+`."""
        old, new = (line[1:] for line in lines.splitlines())
        assert [line[0] for line in lines.splitlines()] == ["-", "+"]
        text = path.read_text(encoding="utf-8")
        assert text.count(f"{old}\n") == 1
        path.write_text(text.replace(old, new), encoding="utf-8")

    def type(self, line: str) -> str:
        """Run one line of a shell block, with the exit code that the page says; an activation lasts."""
        if line.startswith(". "):
            self.activation = f"{line} && "
        done = self.run(line.replace(REPOSITORY, str(ROOT)))
        assert done.returncode == (1 if FAILS in line else 0), f"{line}\n{done.stdout}{done.stderr}"
        return done.stdout

    def run(self, line: str) -> subprocess.CompletedProcess[str]:
        """Run a line in the reader's environment."""
        command = ["sh", "-c", self.activation + line]
        options = {"cwd": self.folder, "env": self.environment, "capture_output": True, "text": True}
        return subprocess.run(command, timeout=600, **options)  # type: ignore[call-overload,no-any-return]


def without_figures(text: str) -> str:
    """A text in one line, without what may differ in the last digit: figures, and whether they are resolved."""
    return " ".join(re.sub(r"-?\d+(\.\d+)?|\byes\b|\bno\b", "0", text).split())


@pytest.mark.slow
def test_the_tutorial_works_as_written_in_a_fresh_environment(tmp_path: Path) -> None:
    reader = Reader(tmp_path)
    outputs = [output for page in TUTORIAL for output in reader.follow(page)]
    assert [bool(shown) for _, shown in outputs] == [False, False, True, False, True]
    for printed, shown in outputs:
        for part in shown.split("...\n"):
            assert without_figures(part) in without_figures(printed)
    checks = ["it keeps its contract" in printed for printed, _ in outputs]
    assert checks == [False, True, False, True, False]  # begun; as generated; with the mistake; mended; the study
    assert re.search(r"^ O_CS( +-?\d\S* ± \d\S*){4} +(yes|no) +\d", outputs[-1][0], re.MULTILINE)
    assert outputs[-1][0].splitlines()[-1] == "results/motors"
    assert (tmp_path / "results/motors/kpis.csv").read_text(encoding="utf-8").count("O_CS") == 4
    where = reader.run("python -c 'import waxstudy, waxstudy_ramp; print(waxstudy.__file__, waxstudy_ramp.__file__)'")
    assert [Path(file).is_relative_to(tmp_path / ".venv") for file in where.stdout.split()] == [True, True]


# --- the contract pages ----------------------------------------------------------------------------


def test_the_contract_page_shows_the_linear_ramp_whole_and_it_is_short() -> None:
    source = RAMP.read_text(encoding="utf-8")
    assert source in [block.text for block in fences(CONTRACT) if block.language == "python"]
    assert len(source.splitlines()) <= 30


def rows(heading: str, page: str) -> list[list[str]]:
    """The cells of the table of a text that has this first heading."""
    tables = re.findall(r"(?:^\|.*\n)+", page, re.MULTILINE)
    (found,) = [table for table in tables if table.startswith(heading)]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in found.splitlines()[2:]]


def test_the_page_of_kinds_has_every_kind_with_its_input_and_output() -> None:
    table = rows("| kind | input |", OF_KINDS.read_text(encoding="utf-8"))
    assert [row[0] for row in table] == list(KINDS)
    kinds = {base.kind: base for base in Block.__subclasses__() if base.__module__ == Block.__module__}
    for row in table[: len(CHAIN)]:
        for said, port in zip(row[1:3], (kinds[row[0]].input, kinds[row[0]].output), strict=True):
            unit = "" if port.unit == "1" else f" {port.unit}"
            assert said == f"{port.quantity}, {port.low:g} to {port.high:g}{unit}"


def test_the_reference_has_every_stage_of_the_kit_and_whether_it_can_be_exempted() -> None:
    told: dict[str, list[tuple[str, bool]]] = {}
    for kind, stage, claim, exempt in rows("| kind | stage |", stages()):
        assert claim
        told.setdefault(kind, []).append((stage, exempt == "yes"))
    known = {"all": COMMON, "block": BY_KIND["actuator"], "outside room": OUTSIDE_STAGES}
    known |= {kind: BY_KIND[kind] for kind in KINDS[len(CHAIN) :]}
    assert told == {kind: [(stage.name, stage.exemptible) for stage in stages] for kind, stages in known.items()}


def test_the_page_of_promises_quotes_what_is_said_of_another_api_and_of_a_name_that_is_taken() -> None:
    page = " ".join(PROMISES.read_text(encoding="utf-8").split())
    registry = Registry()
    registry.add(LinearRamp, "waxstudy", "0.1.0")
    with pytest.raises(PluginError) as other_major:
        registry.add(type("LinearRamp", (LinearRamp,), {"api_version": "2.0"}), "waxstudy-motors", "1.2")
    with pytest.raises(PluginError, match="registered already"):
        registry.add(LinearRamp, "waxstudy-motors", "1.2")
    with pytest.raises(PluginError) as taken:
        registry.get("actuator", "linear-ramp")
    assert f"`{other_major.value}`" in page
    assert f"`{taken.value}`" in page


@pytest.mark.slow
def test_the_page_of_promises_shows_what_a_run_says_of_a_block_that_fails(tmp_path: Path) -> None:
    source = RAMP.read_text(encoding="utf-8").replace("linear-ramp", "motor").replace("max(0.0, ", "(")
    (tmp_path / "motor.py").write_text(source, encoding="utf-8")
    about = tmp_path / "motor-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: motor\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[waxstudy]\nmotor = motor\n")
    (tmp_path / "study.toml").write_text(SMALL.replace("variable-times", "motor"))
    done = call(tmp_path, "run", "study.toml", env={"PYTHONPATH": str(tmp_path)})
    assert done.returncode == FAILED
    said = done.stderr.replace(f"{tmp_path}/", "")
    assert " ".join(said.split()) in [" ".join(block.text.split()) for block in fences(PROMISES)]
