"""Runs that are killed, interrupted, or find the disk full: what is finished stays, and the rest follows."""

from __future__ import annotations

import os
import pickle
import random
import resource
import signal
import subprocess
import time
from pathlib import Path

import click
import pytest

from tests.cli.conftest import Entry
from tests.cli.folders import contents, finished_cases, results
from tests.conftest import NO_BYTECODE, SMALL, WAXSTUDY, Waxstudy
from waxstudy.cli.errors import exit_code

FAILED, INTERRUPTED = 6, 130
KILLS = 2

# seven cases at a fine step: some seconds
DEAD_BANDS_K = (1.8, 1.6, 1.4, 1.2, 1.0, 0.5)
STEPS = [f'  {{ id = "b{band}", controller = {{ dead_band_K = {band} }} }},\n' for band in DEAD_BANDS_K]
LONG = f"""\
[study]
name = "long"
step_s = 4
[room]
use = "nzeb"
[weather.january]
use = "tallinn-week"
month = "january"
[ensemble]
members = 2
[ladder.on-off]
reference = "b0.5"
start = {{ id = "b2.0", controller = {{ use = "on-off" }} }}
steps = [
{"".join(STEPS)}]
"""
FEWER = LONG.replace("".join(STEPS[:4]), "")  # three cases


def start(folder: Path, *arguments: str) -> subprocess.Popen[str]:
    """Start the command in a folder, open to Ctrl-C even where the tests run in the background."""
    return subprocess.Popen(
        [str(WAXSTUDY), *arguments],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def kill_after(process: subprocess.Popen[str], seconds: float) -> None:
    try:
        process.communicate(timeout=seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()


@pytest.mark.slow
def test_a_run_killed_at_any_moment_goes_on_to_the_same_figures(waxstudy: Waxstudy, tmp_path: Path) -> None:
    (tmp_path / "long.toml").write_text(LONG)
    began = time.perf_counter()
    assert waxstudy("run", "long.toml", "--out", "whole").returncode == 0
    whole_s = time.perf_counter() - began
    whole = contents(tmp_path / "whole")
    moments, partly = random.Random(7), 0
    for i in range(KILLS + 1):
        out = f"killed{i}"
        process = start(tmp_path, "run", "long.toml", "--out", out)
        while i == KILLS and process.poll() is None and not finished_cases(tmp_path / out):
            time.sleep(0.01)  # the last one is killed as soon as a case is finished, however busy the machine is
        kill_after(process, whole_s * (i + moments.random()) / KILLS if i < KILLS else 0.0)
        before = finished_cases(tmp_path / out)
        partly += 0 < len(before) < len(finished_cases(tmp_path / "whole"))
        inodes = {name: (tmp_path / out / name).stat().st_ino for name in before}
        done = waxstudy("run", "long.toml", "--out", out)
        assert (done.returncode, done.stderr) == (0, "")
        assert contents(tmp_path / out) == whole, f"kill {i}"
        assert {name: (tmp_path / out / name).stat().st_ino for name in before} == inodes
        assert not list((tmp_path / out).rglob(".partial-*"))
    assert partly > 0  # else no kill fell between the first case and the last


@pytest.mark.slow
def test_a_run_killed_again_and_again_loses_no_finished_case(waxstudy: Waxstudy, tmp_path: Path) -> None:
    (tmp_path / "long.toml").write_text(FEWER)
    assert waxstudy("run", "long.toml", "--out", "whole").returncode == 0
    whole, kept = contents(tmp_path / "whole"), dict[str, str]()
    for _ in range(4 * len(finished_cases(tmp_path / "whole"))):
        process = start(tmp_path, "run", "long.toml", "--out", "killed")
        while process.poll() is None and len(finished_cases(tmp_path / "killed")) <= len(kept):
            time.sleep(0.02)
        process.kill()
        process.communicate()
        now = finished_cases(tmp_path / "killed")
        assert now.items() >= kept.items()
        kept = now
        if process.returncode == 0:
            break
    assert contents(tmp_path / "killed") == whole


def interrupt(folder: Path, *options: str) -> tuple[float, subprocess.Popen[str], str, str]:
    """Press Ctrl-C once the first case is finished; return the seconds to the end, and what was printed."""
    process = start(folder, "run", "long.toml", "--out", "run", *options)
    while process.poll() is None and not finished_cases(folder / "run"):
        time.sleep(0.02)
    pressed = time.perf_counter()
    process.send_signal(signal.SIGINT)
    stdout, stderr = process.communicate(timeout=60)
    return time.perf_counter() - pressed, process, stdout, stderr


@pytest.mark.slow
def test_a_second_run_in_the_same_folder_is_refused_while_the_first_is_at_work(
    waxstudy: Waxstudy, tmp_path: Path
) -> None:
    (tmp_path / "long.toml").write_text(LONG)
    first = start(tmp_path, "run", "long.toml", "--out", "run")
    while first.poll() is None and not finished_cases(tmp_path / "run"):
        time.sleep(0.02)
    first.send_signal(signal.SIGSTOP)  # so that it is still at work when the second starts
    second = waxstudy("run", "long.toml", "--out", "run")
    first.send_signal(signal.SIGCONT)
    assert (second.returncode, second.stdout) == (FAILED, "")
    told = "another run is at work in this folder; wait for it, or choose another with --out"
    assert second.stderr == f"error: run: {told}\n"
    first.communicate()
    assert first.returncode == 0


# what is left has to take far longer than to begin and to end a command, on any machine
LONGER = LONG.replace("members = 2", "members = 20")
INTERPRETED = FEWER.replace("step_s = 4", "step_s = 60").replace("members = 2", "members = 4")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "options"), [(LONGER, []), (INTERPRETED, ["--no-jit"])], ids=["compiled", "interpreted"]
)
def test_ctrl_c_ends_a_run_long_before_its_rest_would_end_and_keeps_what_is_finished(
    waxstudy: Waxstudy, tmp_path: Path, text: str, options: list[str]
) -> None:
    shares: list[float] = []
    while len(shares) < 3 and min(shares, default=1.0) > 1 / 3:  # another program may hold the processor once
        folder = tmp_path / str(len(shares))
        folder.mkdir()
        (folder / "long.toml").write_text(text)
        seconds, process, stdout, stderr = interrupt(folder, *options)
        assert (process.returncode, stdout) == (INTERRUPTED, "")
        assert stderr.strip() == "interrupted; what was finished is kept, the same command goes on from there"
        kept = finished_cases(folder / "run")
        assert kept
        report = waxstudy("report", folder / "run")
        assert report.returncode == 3
        assert f"`waxstudy run STUDY.toml --out {folder / 'run'}` goes on from there" in report.stderr
        began = time.perf_counter()
        assert waxstudy("run", folder / "long.toml", "--out", folder / "run", *options).returncode == 0
        assert finished_cases(folder / "run").items() >= kept.items()
        shares.append(seconds / (time.perf_counter() - began))
    assert min(shares) <= 1 / 3


@pytest.mark.parametrize(
    ("changed", "limit"),
    [({"dead_band_K = 0.5": "dead_band_K = 0.7"}, 64 * 1024), ({'reference = "O_WM"': 'reference = "O_CP"'}, 1024)],
    ids=["while cases are written", "when all are put together"],
)
def test_a_disk_that_takes_no_more_fails_the_run_and_leaves_earlier_results(
    waxstudy: Waxstudy, entry: Entry, small_study: Path, small_run: Path, changed: dict[str, str], limit: int
) -> None:
    before = results(small_run)
    for old, new in changed.items():
        small_study.write_text(SMALL.replace(old, new))

    def full() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    done = waxstudy("run", "small.toml", "--out", "run", preexec_fn=full, env=NO_BYTECODE)
    assert (done.returncode, done.stdout) == (FAILED, "")
    assert done.stderr == "error: run: the results cannot be written: File too large\n"
    assert results(small_run) == before
    assert entry("report", "run").code == 0
    assert entry("run", "small.toml", "--out", "run").code == 0


def test_a_full_output_is_told_and_a_reader_that_has_seen_enough_is_not(small_run: Path) -> None:
    command = [str(WAXSTUDY), "report", str(small_run), "--json"]
    with open("/dev/full", "w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == FAILED
    assert done.stderr == "error: the output cannot be written: No space left on device\n"
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writer)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_file_that_ends_too_early_is_not_told_as_an_interruption() -> None:
    @click.command()
    def reads() -> None:
        pickle.loads(b"")

    with pytest.raises(EOFError):
        exit_code(lambda: reads.main([], standalone_mode=False))
