"""A run folder belongs to one study file, and shows nothing but what was computed."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Entry
from tests.cli.folders import computed_at, contents, results
from tests.conftest import SMALL

RESULTS = ("run.json", "kpis.csv", "study.toml", "SHA256SUMS")


# --- whose folder it is -----------------------------------------------------------------------------


def other(study: Path) -> Path:
    """Another study's file of the same name in `[study]`."""
    path = study.parent / "other.toml"
    path.write_text(SMALL.replace("dead_band_K = 0.5", "dead_band_K = 0.7"))
    return path


def test_another_study_of_the_same_name_leaves_the_first_one_s_results(entry: Entry, small_study: Path) -> None:
    assert entry("run", small_study).code == 0
    before = contents(Path("results/small"))
    ended = entry("run", other(small_study))
    assert (ended.code, ended.stdout) == (2, "")
    assert str(small_study) in ended.stderr
    assert str(small_study.parent / "other.toml") in ended.stderr
    assert "--out" in ended.stderr
    assert "--replace" in ended.stderr
    assert contents(Path("results/small")) == before


def test_replace_gives_the_folder_to_the_other_study(entry: Entry, small_study: Path, small_run: Path) -> None:
    path = other(small_study)
    assert entry("run", path, "--out", "run", "--replace").code == 0
    assert entry("run", path, "--out", "run").code == 0
    assert entry("run", small_study, "--out", "run").code == 2


def test_a_run_that_was_interrupted_belongs_to_its_study_already(entry: Entry, small_study: Path) -> None:
    path = other(small_study)
    assert entry("run", small_study, "--out", "run").code == 0
    (small_study.parent / "run" / "run.json").unlink()
    (small_study.parent / "run" / "study.toml").unlink()
    assert entry("run", path, "--out", "run").code == 2


def test_a_moved_study_goes_on_to_the_same_bytes(entry: Entry, small_study: Path, small_run: Path) -> None:
    before, times = results(small_run), computed_at(small_run)
    moved = small_study.rename(small_study.parent / "moved.toml")
    assert entry("run", moved, "--out", "run").code == 0
    assert results(small_run) == before
    assert computed_at(small_run) == times
    moved.write_text(SMALL.replace("dead_band_K = 0.5", "dead_band_K = 0.6"))
    assert entry("run", moved, "--out", "run").code == 0  # it is the folder's study now


def test_a_study_that_was_copied_with_its_folder_may_be_edited(
    entry: Entry, small_study: Path, small_run: Path, tmp_path: Path
) -> None:
    shutil.copytree(tmp_path / "run", tmp_path / "copy" / "run")
    copy = Path(shutil.copy(small_study, tmp_path / "copy"))
    copy.write_text(SMALL.replace("dead_band_K = 0.5", "dead_band_K = 0.6"))
    assert entry("run", copy, "--out", tmp_path / "copy" / "run").code == 0


def test_the_study_in_the_folder_runs_again_and_the_file_stays_its_owner(
    entry: Entry, small_study: Path, small_run: Path
) -> None:
    assert entry("run", "run/study.toml", "--out", "run").code == 0
    small_study.write_text(SMALL.replace("dead_band_K = 0.5", "dead_band_K = 0.6"))
    assert entry("run", small_study, "--out", "run").code == 0


def test_a_folder_whose_file_is_not_known_is_given_to_nobody_else(
    entry: Entry, small_study: Path, small_run: Path
) -> None:
    for damage in ("", "{", "[]", '{"study_file": 3}'):
        (small_run / "origin.json").write_text(damage)
        ended = entry("run", other(small_study), "--out", "run")
        assert ended.code == 2
        assert "not recorded" in ended.stderr
    assert entry("run", small_study, "--out", "run").code == 0


# --- nothing edited or damaged is shown ------------------------------------------------------------


def edited(path: Path) -> None:
    """Another figure in the place of one."""
    text = path.read_bytes()
    digit = max(text.rfind(b"%d" % n) for n in range(10))
    path.write_bytes(text[:digit] + b"%d" % (9 - int(text[digit : digit + 1])) + text[digit + 1 :])


def flipped(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(data)


FILES = [*RESULTS, *(f"cases/*/{name}" for name in ("kpis.csv", "durations.parquet", "traces.parquet", "SHA256SUMS"))]


@pytest.mark.parametrize("change", [edited, flipped])
@pytest.mark.parametrize("which", FILES)
def test_what_was_changed_is_refused_by_name_and_computed_again_by_a_run(
    entry: Entry, small_study: Path, small_run: Path, which: str, change: object
) -> None:
    whole = contents(small_run)
    file = sorted(small_run.glob(which))[0]
    assert callable(change)
    change(file)
    ended = entry("report", "run")
    assert (ended.code, ended.stdout) == (3, "")
    (line,) = ended.stderr.splitlines()
    named = line.removeprefix("error: ").split(":")[0]
    # checksums that were changed tell of the file that they no longer fit
    assert named == str(file.relative_to(small_run.parent)) or file.name == "SHA256SUMS"
    assert "`waxstudy run small.toml --out run` computes it again" in line
    ended = entry("run", small_study, "--out", "run")
    assert ended.code == 0
    assert ("is computed again" in ended.stderr) == which.startswith("cases/")
    assert contents(small_run) == whole


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such pipes")
def test_pipes_in_the_place_of_all_files_hold_no_run_up(entry: Entry, small_study: Path, small_run: Path) -> None:
    whole = contents(small_run)
    for path in [path for path in small_run.rglob("*") if path.is_file()]:
        path.unlink()
        os.mkfifo(path)
    assert entry("report", "run").code == 3
    assert entry("run", small_study, "--out", "run").code == 0
    assert contents(small_run) == whole


def test_cases_whose_folders_were_swapped_are_computed_again(
    entry: Entry, small_study: Path, small_run: Path, tmp_path: Path
) -> None:
    """Files and checksums of a case fit each other wherever they lie."""
    whole = contents(small_run)
    one, other = sorted((small_run / "cases").iterdir())[:2]
    one.rename(tmp_path / "one")
    other.rename(one)
    (tmp_path / "one").rename(other)
    assert entry("report", "run").code == 3
    ended = entry("run", small_study, "--out", "run")
    assert (ended.code, contents(small_run)) == (0, whole)
    assert ended.stderr.count("is computed again") == 2


# --- links --------------------------------------------------------------------------------------------


def test_a_run_deletes_nothing_at_the_end_of_a_link(entry: Entry, small_study: Path, tmp_path: Path) -> None:
    home = tmp_path / "home" / "O_X_january_0123456789abcdef"
    home.mkdir(parents=True)
    (home / "mine.txt").write_text("mine\n")
    (tmp_path / "run").mkdir()
    os.symlink(tmp_path / "home", tmp_path / "run" / "cases")
    ended = entry("run", small_study, "--out", "run")
    assert (ended.code, ended.stdout) == (6, "")
    assert ended.stderr.startswith("error: run/cases: a link to ")
    assert (home / "mine.txt").read_text() == "mine\n"


def test_a_case_s_folder_that_links_elsewhere_is_computed_again_beside_it(
    entry: Entry, small_study: Path, small_run: Path, tmp_path: Path
) -> None:
    case = sorted((small_run / "cases").iterdir())[0]
    case.rename(tmp_path / "elsewhere")
    os.symlink(tmp_path / "elsewhere", case)
    old = small_run / "cases" / "O_X_january_0123456789abcdef"
    os.symlink(tmp_path / "elsewhere", old)
    before = contents(tmp_path / "elsewhere")
    ended = entry("report", "run")
    assert ended.code == 3
    assert ended.stderr.startswith(
        f"error: run/cases/{case.name}: a link to {tmp_path / 'elsewhere'}, which a run does"
    )
    ended = entry("run", small_study, "--out", "run")
    assert ended.code == 0
    assert "which a run does not follow; O_0, january is computed again" in ended.stderr
    assert not case.is_symlink()
    assert not old.is_symlink()
    assert contents(tmp_path / "elsewhere") == before


def test_the_cases_of_an_attribution_are_not_kept_at_the_end_of_a_link(
    entry: Entry, small_run: Path, tmp_path: Path
) -> None:
    old = tmp_path / "elsewhere" / "cases" / "O_X_january_0123456789abcdef"
    old.mkdir(parents=True)
    os.symlink(tmp_path / "elsewhere", small_run / "attribution")
    ended = entry("report", "run", "--attribution")
    assert (ended.code, ended.stdout) == (6, "")
    assert ended.stderr.startswith("error: run/attribution: a link to ")
    assert contents(tmp_path / "elsewhere") == {}
    assert old.is_dir()


def test_a_study_whose_file_is_gone_is_asked_for_without_its_name(entry: Entry, small_run: Path) -> None:
    edited(small_run / "kpis.csv")
    assert entry("report", "run").stderr.endswith("; `waxstudy run` the study again\n")
