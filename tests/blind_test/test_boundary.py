"""Claims about what a diagnoser's process can see, and that it ends with the command that started it."""

from __future__ import annotations

import errno
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from tests.blind_test.conftest import CASES
from tests.blind_test.test_solve import answers, started
from tests.conftest import ROOT, WAXSTUDY, Waxstudy, call_anew
from waxstudy.blind_test.make import Place

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="processes end otherwise there")

# prints its own surroundings instead of a diagnosis
TELL = """\
import json, os, sys
seen = {"environment": dict(os.environ), "arguments": sys.argv[1:], "folder": os.getcwd(), "input": sys.stdin.read()}
print(json.dumps({"verdict": "none", "seen": seen}))
"""

# tells what can be looked up of the process that started it
LOOK_UP = """\
import json, os, pathlib
above, told = pathlib.Path("/proc", str(os.getppid())), {}
for name in ("cmdline", "environ", "cwd", "fd/0"):
    try:
        each = above / name
        told[name] = os.readlink(each) if each.is_symlink() else each.read_bytes().decode(errors="replace")
    except OSError as error:
        told[name] = error.strerror
print(json.dumps({"verdict": "none", "told": told}))
"""

# looks for the blind test in every process that it can see, and in a folder, which it uncovers if it can
SPY = """\
import json, pathlib, subprocess, sys
word, folder, said = "blind-test", pathlib.Path(sys.argv[1]), []
subprocess.run(["umount", folder], capture_output=True)
for each in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
    try:
        text = each.read_bytes().decode(errors="replace")
    except OSError:
        continue
    said += [text] if word in text else []
print(json.dumps({"verdict": "none", "said": said, "files": sorted(map(str, folder.glob("*")))}))
"""
DOCS = ROOT / "docs" / "blind_test_seal.md"


@pytest.fixture
def waxstudy(tmp_path: Path) -> Waxstudy:
    """Run the installed command in a process whose words, memory and files are its own."""
    return partial(call_anew, tmp_path)


def test_a_diagnoser_gets_no_path_of_the_set_no_variable_and_no_input_of_ours(
    place: Place, waxstudy: Waxstudy, tmp_path: Path
) -> None:
    (tmp_path / "tell.py").write_text(TELL)
    (tmp_path / "command").mkdir()
    (tmp_path / "command" / "tell.py").write_text(TELL)
    secret = {"WAXSTUDY_SECRET": "swordfish", "OLDPWD": str(place.folder), "PWD": str(tmp_path)}
    (tmp_path / "temporary").mkdir()
    from_here = {"TMPDIR": "temporary", "WAXSTUDY_CACHE": "cache"}  # which the command leaves
    command = ("blind-test", "solve", "test", "--share", "0.2", "--", sys.executable, "command/tell.py")
    with (tmp_path / "key").open() as key:
        assert waxstudy(*command, env={**secret, **from_here}, stdin=key).returncode == 0
    (answer,) = answers(place).values()
    seen = answer["answer"]["seen"]
    assert seen["input"] == ""
    assert "WAXSTUDY_SECRET" not in seen["environment"]
    assert str(place.folder) not in json.dumps({**seen, "arguments": seen["arguments"][1:]})
    assert seen["environment"]["HOME"] == seen["environment"]["TMPDIR"] == seen["folder"]
    assert Path(seen["folder"]).parent == tmp_path / "temporary"
    assert seen["environment"]["WAXSTUDY_CACHE"] == str(tmp_path / "cache")
    assert seen["environment"]["OPENBLAS_NUM_THREADS"] == "1"
    assert not Path(seen["folder"]).exists()


@pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")
def test_neither_the_set_nor_the_key_can_be_looked_up_in_the_process_that_asks(
    place: Place, waxstudy: Waxstudy, tmp_path: Path
) -> None:
    apart = tmp_path / "apart"
    apart.mkdir()
    (apart / "look.py").write_text(LOOK_UP)
    secret = {"WAXSTUDY_CACHE": str(tmp_path / "cache"), "PWD": str(tmp_path), "WAXSTUDY_SECRET": str(place.folder)}
    command = ("blind-test", "solve", place.folder, "--share", "0.2", "--", sys.executable, apart / "look.py")
    with (tmp_path / "key").open() as key:
        done = waxstudy(*command, env=secret, stdin=key)
    assert done.returncode == 0, done.stderr
    (answer,) = answers(place).values()
    told = answer["answer"]["told"]
    assert told["cmdline"].rstrip("\0") == "waxstudy blind-test solve"
    assert str(tmp_path) not in told["environ"] + told["cwd"]


def can_unshare(*options: str) -> bool:
    """Whether namespaces can be made: `unshare` may lack, and a system or a container may forbid it."""
    tried = ["unshare", "--user", *options, "true"]
    return bool(shutil.which("unshare")) and subprocess.run(tried, capture_output=True, check=False).returncode == 0


# the administrator's own processes may look everything up, until they have given that right away
NO_RIGHTS = ("setpriv", "--bounding-set=-all") if hasattr(os, "geteuid") and os.geteuid() == 0 else ()


@pytest.mark.skipif(sys.platform != "linux", reason="it can be asked on Linux only")
@pytest.mark.skipif(bool(NO_RIGHTS) and not shutil.which("setpriv"), reason="the administrator's rights stay")
def test_who_is_no_administrator_reads_no_memory_folder_or_open_file_of_it(place: Place, tmp_path: Path) -> None:
    (tmp_path / "look.py").write_text(LOOK_UP)
    solve = ("blind-test", "solve", "test", "--share", "0.2", "--", sys.executable, "look.py")
    done = subprocess.run([*NO_RIGHTS, WAXSTUDY, *solve], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (answer,) = answers(place).values()
    told = answer["answer"]["told"]
    assert {told[name] for name in ("environ", "cwd", "fd/0")} == {os.strerror(errno.EACCES)}


def recipe(place: Place, *diagnoser: str) -> list[str]:
    """Return the command of the docs, with this set and another diagnoser in the places of theirs."""
    (text,) = re.findall(r"^waxstudy (blind-test solve .*unshare.*(?:\n .*)*)", DOCS.read_text(), re.MULTILINE)
    words = shlex.split(text.replace("\\\n", " "))
    assert words[-2:] == ["python", "/opt/mine/my_diagnoser.py"]
    return [str(place.folder) if word == "/data/blind" else word for word in words[:-2]] + list(diagnoser)


NAMESPACES = ("--map-root-user", "--mount", "--pid", "--kill-child", "--mount-proc", "--net")
needs_namespaces = pytest.mark.skipif(
    not shutil.which("setpriv") or not can_unshare(*NAMESPACES),
    reason="not all namespaces can be made on this machine",
)


@needs_namespaces
def test_in_namespaces_of_its_own_it_sees_no_process_of_ours_and_not_the_set(
    place: Place, waxstudy: Waxstudy, tmp_path: Path
) -> None:
    (tmp_path / "spy.py").write_text(SPY)
    spy = (sys.executable, str(tmp_path / "spy.py"), str(place.folder))
    assert waxstudy("blind-test", "solve", "test", "--name", "bare", "--", *spy).returncode == 0
    for seen in answers(place, "bare").values():
        assert seen["answer"]["said"]
        assert seen["answer"]["files"]
    done = waxstudy(*recipe(place, *spy))
    assert done.returncode == 0, done.stderr
    apart = answers(place, "mine")
    assert len(apart) == CASES
    for seen in apart.values():
        assert seen["exit_code"] == 0, seen
        assert (seen["answer"]["said"], seen["answer"]["files"]) == ([], [])


def is_there(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def below(process: int) -> list[int]:
    """Return the processes that one started, and those that they started."""
    found = [
        int(each) for path in Path(f"/proc/{process}/task").glob("*/children") for each in path.read_text().split()
    ]
    return found + [each for child in found for each in below(child)]


def begun(folder: Path, command: Callable[..., list[str]]) -> tuple[subprocess.Popen[str], list[int]]:
    """Start a solving whose diagnoser waits; return it and the processes below it."""
    told, script = folder / "told", folder / "wait.py"
    script.write_text(f"import time; open({str(told)!r}, 'w').close(); time.sleep(600)")
    process = started(folder, *command(sys.executable, str(script)), "--fast")
    while not told.exists():
        assert process.poll() is None
        time.sleep(0.02)
    return process, below(process.pid)


def ended(processes: list[int]) -> bool:
    for _ in range(200):
        if not any(map(is_there, processes)):
            return True
        time.sleep(0.05)
    return False


def bare(*diagnoser: str) -> list[str]:
    return ["blind-test", "solve", "test", "--", *diagnoser]


@pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")
@pytest.mark.parametrize("by", ["SIGTERM", "SIGHUP", "SIGKILL"])
def test_a_diagnoser_ends_with_the_command_that_asked_it(
    place: Place, tmp_path: Path, by: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setenv("TMPDIR", str(temporary))
    process, diagnosers = begun(tmp_path, bare)
    assert any(map(is_there, diagnosers))
    os.kill(process.pid, signal.Signals[by])  # it alone, not its group
    process.wait(timeout=30)
    assert ended(diagnosers)
    assert answers(place) == {}
    if by != "SIGKILL":
        assert process.returncode == 130
        assert list(temporary.iterdir()) == []
    else:
        assert list(temporary.iterdir())
        solved = call_anew(tmp_path, "blind-test", "solve", "test", "--name", "next", "--", "true")
        assert solved.returncode == 0
        assert list(temporary.iterdir()) == []


@needs_namespaces
def test_in_namespaces_all_that_a_diagnoser_started_ends_with_a_killed_command(place: Place, tmp_path: Path) -> None:
    process, diagnosers = begun(tmp_path, partial(recipe, place))
    assert len(diagnosers) >= 2  # unshare and what it holds
    process.kill()
    process.wait()
    assert ended(diagnosers)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")
@pytest.mark.parametrize("by", ["SIGTERM", "SIGKILL"])
def test_workers_end_with_the_command_that_started_them_whatever_they_are_at(tmp_path: Path, by: str) -> None:
    cases = 30
    command = ("blind-test", "make", "--cases", cases, "--seed", 4, "--out", "new", "--key-file", "key", "--quiet")
    process = started(tmp_path, *command)
    while not list(tmp_path.glob("new/records/*/data.csv")):
        assert process.poll() is None
        time.sleep(0.05)
    workers = below(process.pid)
    assert len(workers) >= 2
    os.kill(process.pid, signal.Signals[by])  # it alone, not its group
    process.wait(timeout=60)
    assert process.returncode == (130 if by == "SIGTERM" else -signal.SIGKILL)
    assert ended(workers)
    assert len(list(tmp_path.glob("new/boxes/*.box"))) < cases


@pytest.mark.skipif(sys.platform != "linux", reason="it can be asked on Linux only")
def test_a_process_whose_parent_ended_before_it_could_ask_ends_as_well() -> None:
    parents = [str(os.getpid()), str(os.getppid())]
    asking = "import sys; from waxstudy.simulation.workers import die_with_parent; die_with_parent(int(sys.argv[1]))"
    codes = [subprocess.run([sys.executable, "-c", asking, each], check=False).returncode for each in parents]
    assert codes == [0, -signal.SIGKILL]
