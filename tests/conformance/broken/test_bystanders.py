"""No broken plugin takes down a study that does not use it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.folders import finished_cases
from tests.conformance.broken.plugin import install, valve
from tests.conftest import Waxstudy


def test_a_study_runs_as_before_beside_all_of_them(
    waxstudy: Waxstudy, small_study: Path, finished: Path, shelf: Path
) -> None:
    done = waxstudy("run", small_study, "--out", "run", env={"PYTHONPATH": str(shelf)})
    assert (done.returncode, done.stderr) == (0, "")
    assert finished_cases(small_study.parent / "run") == finished_cases(finished)


IMPORTS = {
    "raises what is no Exception": "class Ended(BaseException):\n    pass\n\nraise Ended",
    "prints": 'print("licence found")',
    "warns": 'import warnings\nwarnings.warn("an old licence", FutureWarning)',
    "turns warnings into errors": 'import warnings\nwarnings.simplefilter("error")',
    "turns rounding into errors": 'import numpy\nnumpy.seterr(all="raise")',
    "goes to another folder": 'import os\nos.chdir("/")',
    "seeds": "import random\nrandom.seed(1)",
}


@pytest.mark.slow
@pytest.mark.parametrize("before", IMPORTS.values(), ids=IMPORTS)
def test_what_an_import_does_leaves_a_study_alone_that_does_not_use_it(
    waxstudy: Waxstudy, tmp_path: Path, small_study: Path, small_run: Path, before: str
) -> None:
    """The run folder is finished: only what reading and reporting need is done again."""
    install(tmp_path / "strangers", "at-import", valve(before=before))
    env = {"PYTHONPATH": str(tmp_path / "strangers")}
    done = waxstudy("run", "small.toml", "--out", "run", env=env)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.endswith("\nrun\n")


def test_an_entry_point_that_cannot_be_read_leaves_others_alone(waxstudy: Waxstudy, tmp_path: Path) -> None:
    file = install(tmp_path / "strangers", "unread", valve())
    (file.parent / f"{file.stem}-1.0.dist-info" / "entry_points.txt").write_text("[waxstudy]\nunread\n")
    done = waxstudy("plugins", "list", env={"PYTHONPATH": str(tmp_path / "strangers")})
    assert (done.returncode, done.stderr) == (0, "")
    assert "broken: unread: entry_points.txt cannot be read: write NAME = MODULE in each line" in done.stdout
    assert "linear-ramp" in done.stdout


def test_a_package_that_does_not_state_its_name_offers_its_components(waxstudy: Waxstudy, tmp_path: Path) -> None:
    file = install(tmp_path / "strangers", "nameless", valve())
    (file.parent / f"{file.stem}-1.0.dist-info" / "METADATA").write_bytes(b"\xff")
    done = waxstudy("plugins", "show", "nameless", env={"PYTHONPATH": str(tmp_path / "strangers")})
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("valve 'nameless' of unknown unknown ")


def test_two_broken_plugins_of_one_name_are_both_listed(waxstudy: Waxstudy, tmp_path: Path) -> None:
    folder = tmp_path / "strangers"
    for module in ("first", "second"):
        file = install(folder, module, valve(before=f'raise RuntimeError("the {module}")'))
        (folder / f"{file.stem}-1.0.dist-info" / "entry_points.txt").write_text(f"[waxstudy]\nmotors = {file.stem}\n")
    done = waxstudy("plugins", "list", env={"PYTHONPATH": str(folder)})
    first, second = [line for line in done.stdout.splitlines() if line.startswith("broken: ")]
    assert first.startswith("broken: motors: RuntimeError: the first (")
    assert second.startswith("broken: motors of second: RuntimeError: the second (")
