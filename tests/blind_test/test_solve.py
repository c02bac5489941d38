"""Claims about letting diagnosers loose: alone with one record, any command, failures, and being killed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from tests.blind_test.conftest import CASES, NONE, answering
from tests.conftest import WAXSTUDY, Waxstudy
from waxstudy.blind_test.child import _read
from waxstudy.blind_test.make import Place
from waxstudy.blind_test.record import digest_of
from waxstudy.results.atomic import sole_use

FINISHED = "test/answers/external/[!.][!o]*.json"  # neither half written ones nor command.json
# prints what it can see instead of a diagnosis of anything
LOOK = """\
import json, os, pathlib, sys
folder = pathlib.Path(sys.argv[-1])
seen = sorted(str(path.relative_to(folder.parent)) for path in folder.parent.rglob("*"))
print(json.dumps({"verdict": "none", "seen": seen, "words": sys.argv[1:-1]}))
"""


def answers(place: Place, name: str = "external") -> dict[str, Any]:
    folder = place.folder / "answers" / name
    finished = [path for path in folder.glob("[!.]*.json") if path.stem != "command"]
    return {path.stem: json.loads(path.read_text()) for path in finished}


def test_a_diagnoser_sees_one_record_and_nothing_else(place: Place, waxstudy: Waxstudy, tmp_path: Path) -> None:
    (tmp_path / "look.py").write_text(LOOK)
    done = waxstudy("blind-test", "solve", "test", "--name", "looker", "--", sys.executable, "look.py", "--fast")
    assert (done.returncode, done.stdout) == (0, f"looker: {CASES} records answered, 0 of them by a failure\n")
    found = answers(place, "looker")
    assert sorted(found) == place.names()
    for each in found.values():
        assert each["answer"]["seen"] == ["record", "record/data.csv", "record/dataset.toml"]
        assert each["answer"]["words"] == ["--fast"]
        assert each["exit_code"] == 0
        assert each["seconds"] > 0.0


def test_what_fails_is_kept_with_what_it_said_and_counts_as_untestable(
    place: Place, waxstudy: Waxstudy, tmp_path: Path
) -> None:
    script = tmp_path / "bad.py"
    script.write_text("import sys; print('no'); sys.exit('out of order' if sys.argv[1].endswith('record') else 0)")
    assert waxstudy("blind-test", "solve", "test", "--", sys.executable, "bad.py").returncode == 0
    one = next(iter(answers(place).values()))
    assert (one["exit_code"], one["answer"], one["stderr"]) == (1, None, "out of order\n")
    done = waxstudy("blind-test", "score", "test", "--key-file", "key", "--json")
    own = json.loads(done.stdout)["diagnosers"]["external"]
    assert sorted(own["failed"]) == place.names()
    assert own["all"]["right_group"]["count"] in (0, None)
    assert {each["said"] for each in own["failures"]} == {"failed"}


MISTAKES = {
    "bare parameters": '{"verdict": "effect", "effects": [{"name": "a", "stage": "valve", "parameters": {"x": 0.02}}]}',
    "a bare shrinkage": '{"verdict": "effect", "effects": [{"name": "a", "stage": "valve", "shrink": 0.9}]}',
    "a word for a group": '{"verdict": "group", "effects": [{"name": "a", "stage": "valve", "group": "let-by"}]}',
    "names for what is unexplained": '{"verdict": "unknown", "unexplained": ["valve"]}',
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_an_answer_with_a_usual_mistake_is_a_failure_that_says_why(mistake: str) -> None:
    answer, problem = _read(MISTAKES[mistake], 0)
    assert answer is None
    assert "cannot be read" in problem


@pytest.mark.parametrize("posterior", ["{}", "null"])
def test_an_answer_may_state_no_probabilities(posterior: str) -> None:
    answer, problem = _read(f'{{"verdict": "none", "posterior": {posterior}}}', 0)
    assert answer is not None, problem
    refused, why = _read('{"verdict": "none", "posterior": {"none": 0.5}}', 0)
    assert refused is None
    assert "sum of 1" in why


def test_a_diagnoser_may_say_what_is_no_text_and_is_named_as_a_folder(place: Place, waxstudy: Waxstudy) -> None:
    bytes_on_stderr = "import sys; sys.stderr.buffer.write(bytes([255, 254])); sys.exit(3)"
    assert waxstudy("blind-test", "solve", "test", "--", sys.executable, "-c", bytes_on_stderr).returncode == 0
    assert {each["exit_code"] for each in answers(place).values()} == {3}
    done = waxstudy("blind-test", "solve", "test", "--name", "../evil", "--", sys.executable)
    assert (done.returncode, "folder's name" in done.stderr) == (2, True)


def test_a_diagnoser_that_takes_too_long_is_ended(place: Place, waxstudy: Waxstudy, tmp_path: Path) -> None:
    (tmp_path / "slow.py").write_text("import time; time.sleep(60)")
    options = ("--timeout-s", 1, "--share", 0.1)
    assert waxstudy("blind-test", "solve", "test", *options, "--", sys.executable, "slow.py").returncode == 0
    (one,) = answers(place).values()
    assert one["answer"] is None
    assert "ended after 1 s" in one["stderr"]


def test_two_commands_never_answer_under_one_name_at_once(place: Place, waxstudy: Waxstudy, tmp_path: Path) -> None:
    (folder := place.folder / "answers" / "external").mkdir(parents=True)
    call = ("blind-test", "solve", "test", "--", *answering(tmp_path, NONE))
    with sole_use(folder):
        done = waxstudy(*call)
    assert (done.returncode, answers(place)) == (2, {})
    assert "another command is answering here; wait for it" in done.stderr
    assert waxstudy(*call).returncode == 0


def test_two_commands_never_make_records_in_one_folder_at_once(place: Place, waxstudy: Waxstudy) -> None:
    made = {path: path.read_bytes() for path in place.folder.rglob("*") if path.is_file()}
    call = ("blind-test", "make", "--cases", CASES, "--out", "test", "--key-file", "key")
    with sole_use(place.folder):
        done = waxstudy(*call)
    assert done.returncode == 2
    assert "another command is making records in this folder; wait for it" in done.stderr
    assert {path: path.read_bytes() for path in place.folder.rglob("*") if path.is_file()} == made
    records = {path: path.stat().st_ino for path in place.records.rglob("*")}
    assert waxstudy(*call).returncode == 0
    assert {path: path.stat().st_ino for path in place.records.rglob("*")} == records  # somebody may be reading them


def test_answers_of_another_command_are_not_mixed_in(place: Place, waxstudy: Waxstudy, tmp_path: Path) -> None:
    assert waxstudy("blind-test", "solve", "test", "--", *answering(tmp_path, NONE)).returncode == 0
    done = waxstudy("blind-test", "solve", "test", "--", *answering(tmp_path, NONE), "--other")
    assert (done.returncode, "answers of another command" in done.stderr) == (2, True)


@pytest.mark.parametrize("baseline", ["random", "rules"])
def test_baselines_answer_every_record(place: Place, waxstudy: Waxstudy, baseline: str) -> None:
    assert waxstudy("blind-test", "solve", "test", "--with", baseline, "--share", 0.3).returncode == 0
    assert all(each["answer"] for each in answers(place, baseline).values())


def test_an_unknown_diagnoser_is_refused_with_those_that_there_are(place: Place, waxstudy: Waxstudy) -> None:
    done = waxstudy("blind-test", "solve", "test", "--with", "mine")
    assert done.returncode == 2
    assert "ours, forward, random, refit, rules" in done.stderr


def test_leave_one_out_waits_for_the_ordinary_answers(place: Place, waxstudy: Waxstudy) -> None:
    done = waxstudy("blind-test", "solve", "test", "--leave-one-out", "--key-file", "key")
    assert (done.returncode, "first solve all records with ours" in done.stderr) == (2, True)


@pytest.mark.slow
def test_an_effect_is_taken_out_of_the_library(small_study: Path, waxstudy: Waxstudy) -> None:
    """Of a record of the valve alone, which a diagnosis is soon done with."""
    lacking = ("sensor_temperature_C", "control_output", "heating_signal", "supply_temperature_C")
    without = [word for channel in lacking for word in ("--without", channel)]
    reality = ("reality", small_study, "--case", "O_WM", "--interval-s", 120, "--out", "valve")
    assert waxstudy(*reality, "--effect", "let-by", "--set", "fraction=0.02", *without).returncode == 0
    done = waxstudy("blind-test", "without", "let-by", "valve")
    assert done.returncode == 0, done.stderr
    said = json.loads(done.stdout)
    assert "let-by" not in {each["name"] for each in said["tried"]}
    assert "stuck-open" in {each["name"] for each in said["tried"]}
    misspelled = waxstudy("blind-test", "without", "let-bye", "valve")
    assert (misspelled.returncode, "did you mean 'let-by'" in misspelled.stderr) == (2, True)


def _listening() -> None:
    for each in (signal.SIGINT, signal.SIGHUP):
        signal.signal(each, signal.SIG_DFL)


def started(folder: Path, *arguments: object, **streams: Any) -> subprocess.Popen[str]:
    """Start a command in a session of its own, ready to be ended: a background job may be told to ignore that."""
    return subprocess.Popen(
        [str(WAXSTUDY), *map(str, arguments)],
        cwd=folder,
        encoding="utf-8",
        stdout=subprocess.DEVNULL,
        start_new_session=True,
        preexec_fn=_listening,
        **streams,
    )


def killed(folder: Path, begun: int, count: str, *arguments: object, by: signal.Signals = signal.SIGKILL) -> None:
    """Start a command and end it, with its processes, once it has written so many files."""
    process = started(folder, *arguments)
    while len(list(folder.glob(count))) < begun:
        assert process.poll() is None, "it ended before it could be killed"
        time.sleep(0.02)
    os.killpg(process.pid, by)
    process.wait()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_making_that_was_killed_loses_and_changes_nothing(
    finished_test: Path, tmp_path: Path, waxstudy: Waxstudy
) -> None:
    (tmp_path / "key").write_text((finished_test / "key").read_text())
    arguments = ("blind-test", "make", "--cases", CASES, "--out", "test", "--key-file", "key")
    killed(tmp_path, 2, "test/boxes/[!.]*.box", *arguments)
    made = {path: path.read_bytes() for path in (tmp_path / "test" / "boxes").glob("[!.]*.box")}
    assert 2 <= len(made) < CASES
    assert waxstudy(*arguments).returncode == 0
    assert {path: path.read_bytes() for path in made} == made
    whole, again = Place(finished_test / "test"), Place(tmp_path / "test")
    assert again.sealed == whole.sealed
    assert [digest_of(again.record(name)) for name in again.names()] == [
        digest_of(whole.record(name)) for name in whole.names()
    ]


@pytest.mark.parametrize("by", ["SIGKILL", "SIGINT"])
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_solving_that_was_ended_goes_on_from_there(place: Place, waxstudy: Waxstudy, tmp_path: Path, by: str) -> None:
    script = tmp_path / "slowly.py"
    script.write_text(f"import time; time.sleep(0.2); print({NONE!r})")
    arguments = ("blind-test", "solve", "test", "--", sys.executable, "slowly.py")
    killed(tmp_path, 2, FINISHED, *arguments, by=signal.Signals[by])
    before = answers(place)
    assert 2 <= len(before) < CASES
    assert all(each["answer"] for each in before.values())
    assert waxstudy(*arguments).returncode == 0
    after = answers(place)
    assert sorted(after) == place.names()
    assert {name: after[name] for name in before} == before


@pytest.mark.parametrize("end", ["os.kill(os.getpid(), signal.SIGINT)", "sys.exit(130)"])
@pytest.mark.skipif(sys.platform == "win32", reason="no signal of this kind")
def test_a_diagnoser_that_the_interrupt_reached_first_has_not_answered(place: Place, tmp_path: Path, end: str) -> None:
    script = tmp_path / "interrupted.py"
    script.write_text(
        "import os, signal, subprocess, sys\n"
        "signal.signal(signal.SIGINT, signal.SIG_DFL)\n"
        "late = ['sh', '-c', f'sleep 0.3; kill -INT {os.getppid()}']\n"
        "subprocess.Popen(late, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)\n"
        f"{end}\n"
    )
    arguments = ("blind-test", "solve", "test", "--workers", 1, "--", sys.executable, "interrupted.py")
    with started(tmp_path, *arguments, stderr=subprocess.PIPE) as process:
        said = process.communicate(timeout=60)[1]
    assert process.returncode != 0
    assert "the same command goes on from there" in said
    assert not answers(place)
