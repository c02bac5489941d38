"""The run folder as files: all of it or nothing, and nothing read from what is cut off."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.cli.folders import contents
from tests.conftest import WAXSTUDY
from waxstudy.results.atomic import whole_file, whole_folder
from waxstudy.results.checksums import SUMS
from waxstudy.results.folder import RunError, run_folder
from waxstudy.results.run import CaseFolder, Run, finish, is_finished
from waxstudy.study.model import Ladder

FILES = ("run.json", "study.toml", "kpis.csv", "SHA256SUMS")
OF_CASES = ("kpis.csv", "durations.parquet", "traces.parquet", "SHA256SUMS")
EVERY_FILE = (*FILES, *(f"cases/*/{name}" for name in OF_CASES))


@given(which=st.sampled_from(EVERY_FILE), case=st.integers(0, 2), share=st.floats(0.0, 1.0), less=st.integers(0, 12))
def test_a_run_folder_cut_off_at_any_byte_is_refused_by_the_name_of_the_file(
    finished: Path, which: str, case: int, share: float, less: int
) -> None:
    with tempfile.TemporaryDirectory() as place:
        run = shutil.copytree(finished, Path(place) / "run")
        files = sorted(run.glob(which))
        file = files[case % len(files)]
        data = file.read_bytes()
        # anywhere, and more often just before the end
        left = max(0, int(share * len(data)) - less)
        file.write_bytes(data[:left])
        if left < len(data.rstrip()):
            with pytest.raises(RunError, match=f"^{re.escape(str(file))}: "):
                Run(run)


@given(which=st.sampled_from(EVERY_FILE), case=st.integers(0, 2), at=st.floats(0.0, 1.0, exclude_max=True))
def test_a_flipped_bit_anywhere_in_a_run_folder_is_noticed(finished: Path, which: str, case: int, at: float) -> None:
    with tempfile.TemporaryDirectory() as place:
        run = shutil.copytree(finished, Path(place) / "run")
        files = sorted(run.glob(which))
        file = files[case % len(files)]
        data = bytearray(file.read_bytes())
        data[int(at * len(data))] ^= 1
        file.write_bytes(data)
        with pytest.raises(RunError):
            Run(run)


@pytest.mark.skipif(sys.platform != "linux", reason="devices and pipes are those of Linux")
@pytest.mark.parametrize("which", EVERY_FILE)
@pytest.mark.parametrize("make", [os.mkfifo, lambda path: path.symlink_to("/dev/zero")], ids=["pipe", "device"])
def test_what_has_no_end_in_the_place_of_a_file_is_refused_at_once(
    finished: Path, tmp_path: Path, which: str, make: Callable[[Path], None]
) -> None:
    """A run folder may come from somebody else."""
    run = shutil.copytree(finished, tmp_path / "run")
    file = sorted(run.glob(which))[0]
    file.unlink()
    make(file)
    with pytest.raises(RunError):
        Run(run)


def test_a_finished_run_tells_what_it_holds(finished: Path) -> None:
    run = Run(finished)
    assert (run.study, run.weeks, run.members) == ("small", ["january"], 2)
    assert [case.case for case in run.cases] == ["O_0", "O_CP", "O_WM"]
    assert run.ladders == [Ladder("on-off", "O_WM", ["O_0", "O_CP", "O_WM"])]
    assert list(run.kpis["member"]) == [0, 1] * 3
    assert set(run.durations("O_CP", "january")["member"]) == {0, 1}
    assert len(run.traces("O_CP", "january")) == 7 * 24 * 60


def test_provenance_says_where_the_figures_come_from(finished: Path) -> None:
    provenance = json.loads((finished / "run.json").read_text())["provenance"]
    assert provenance["seed"] == 1
    assert {"waxstudy", "numpy", "numba"} <= provenance["packages"].keys()
    assert provenance["plugins"].keys() == {"waxstudy"}
    assert {"python", "machine", "inputs"} <= provenance.keys()


def test_the_command_of_a_run_makes_the_same_bytes_from_its_own_folder(finished: Path, tmp_path: Path) -> None:
    command = shlex.split(json.loads((finished / "run.json").read_text())["provenance"]["command"])
    again = [str(WAXSTUDY), *command[1:], "--out", str(tmp_path / "again")]
    subprocess.run(again, cwd=finished, check=True, capture_output=True)
    assert (tmp_path / "again" / SUMS).read_bytes() == (finished / SUMS).read_bytes()


def test_a_case_counts_as_finished_only_as_it_was_written(finished: Path, tmp_path: Path) -> None:
    run = shutil.copytree(finished, tmp_path / "run")
    case = Run(run).cases[0]
    assert is_finished(run, case)
    assert not is_finished(run, CaseFolder(case.case, case.week, "0" * 16))
    (run / "cases" / case.name / "SHA256SUMS").unlink()
    assert not is_finished(run, case)


def test_checksums_are_such_as_the_usual_command_checks(finished: Path) -> None:
    if not (check := shutil.which("sha256sum")):
        pytest.skip("there is no sha256sum on this machine")
    for place in (finished, *finished.glob("cases/*")):
        done = subprocess.run([check, "--check", "--strict", "SHA256SUMS"], cwd=place, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        assert done.stdout.count(": OK") in (3, 6)


def test_what_cannot_be_put_together_leaves_the_earlier_run(finished: Path, tmp_path: Path) -> None:
    run = shutil.copytree(finished, tmp_path / "run")
    before, earlier = contents(run), Run(run)
    study = {"study": {"name": "other"}, "ensemble": {"members": 2}, "comfort": {"hours_below_per_week": 33.0}}
    with pytest.raises(TypeError):
        finish(run, study, earlier.ladders, earlier.weeks, earlier.cases[:1], {"machine": object()})
    assert contents(run) == before
    assert not list(run.glob(".partial-*"))


def test_a_run_that_ends_half_way_through_publishing_counts_as_unfinished(finished: Path, tmp_path: Path) -> None:
    run = shutil.copytree(finished, tmp_path / "run")
    earlier, study = Run(run), tomllib.loads((run / "study.toml").read_text())
    (run / "study.toml").unlink()
    (run / "study.toml").mkdir()  # nothing takes its place: the table of figures is new, what comes after it is not
    with pytest.raises(OSError, match=r"study\.toml"):
        finish(run, study, earlier.ladders, earlier.weeks, earlier.cases[:1], earlier.provenance)
    with pytest.raises(RunError, match="this run has not finished"):
        Run(run)


def test_a_run_folder_is_made_in_an_empty_place_or_on_top_of_a_run_only(finished: Path, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    for place in (tmp_path / "new" / "below", tmp_path / "empty", finished):
        for _ in range(2):
            with run_folder(place):
                assert (place / "cases").is_dir()
    (tmp_path / "home" / "photos").mkdir(parents=True)
    with pytest.raises(RunError, match="holds no run"), run_folder(tmp_path / "home"):
        pass
    assert [path.name for path in (tmp_path / "home").iterdir()] == ["photos"]


def test_a_run_folder_is_held_by_one_run_at_a_time(tmp_path: Path) -> None:
    with (
        run_folder(tmp_path / "run"),
        pytest.raises(RunError, match="another run is at work"),
        run_folder(tmp_path / "run"),
    ):
        pass
    with run_folder(tmp_path / "run"):
        pass


def test_a_file_or_folder_that_fails_half_way_leaves_the_one_before(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("before")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "file").write_text("before")
    before = contents(tmp_path)

    def write_half(path: Path) -> None:
        path.write_text("half")
        raise OSError("full")

    with pytest.raises(OSError, match="full"), whole_file(tmp_path / "file") as path:
        write_half(path)
    with pytest.raises(OSError, match="full"), whole_folder(tmp_path / "folder") as path:
        write_half(path / "file")
    assert contents(tmp_path) == before
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder"]


def test_files_and_folders_have_the_permissions_that_the_user_s_other_files_have(tmp_path: Path) -> None:
    (tmp_path / "usual").write_text("")
    (tmp_path / "usual folder").mkdir()
    with whole_file(tmp_path / "file") as path:
        path.write_text("text")
    with whole_folder(tmp_path / "folder"):
        pass
    assert os.stat(tmp_path / "file").st_mode == os.stat(tmp_path / "usual").st_mode
    assert os.stat(tmp_path / "folder").st_mode == os.stat(tmp_path / "usual folder").st_mode
