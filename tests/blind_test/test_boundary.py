"""Claims about what a diagnoser's process can see, and that it ends with the command that started it."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.blind_test.test_solve import answers, started
from tests.conftest import Waxstudy
from waxstudy.blind_test.make import Place

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="processes end otherwise there")

# prints its own surroundings instead of a diagnosis
TELL = """\
import json, os, sys
seen = {"environment": dict(os.environ), "arguments": sys.argv[1:], "folder": os.getcwd()}
print(json.dumps({"verdict": "none", "seen": seen}))
"""

# looks for a word in every process that it can see, and in a folder that it was told of
SPY = """\
import json, pathlib, sys
word, folder = sys.argv[1], pathlib.Path(sys.argv[2])
said = []
for each in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
    try:
        text = each.read_bytes().decode(errors="replace")
    except OSError:
        continue
    said += [text] if word in text and "spy.py" not in text else []
print(json.dumps({"verdict": "none", "said": said, "files": sorted(map(str, folder.glob("*")))}))
"""


def test_a_diagnoser_gets_no_path_of_the_set_and_no_variable_of_ours(
    place: Place, waxstudy: Waxstudy, tmp_path: Path
) -> None:
    (tmp_path / "tell.py").write_text(TELL)
    (tmp_path / "command").mkdir()
    (tmp_path / "command" / "tell.py").write_text(TELL)
    secret = {"WAXSTUDY_SECRET": "swordfish", "OLDPWD": str(place.folder), "PWD": str(tmp_path)}
    command = ("blind-test", "solve", "test", "--share", "0.2", "--", sys.executable, "command/tell.py")
    assert waxstudy(*command, env=secret).returncode == 0
    (answer,) = answers(place).values()
    seen = answer["answer"]["seen"]
    assert "WAXSTUDY_SECRET" not in seen["environment"]
    assert str(place.folder) not in json.dumps({**seen, "arguments": seen["arguments"][1:]})
    assert seen["environment"]["HOME"] == seen["environment"]["TMPDIR"] == seen["folder"]
    assert seen["environment"]["OPENBLAS_NUM_THREADS"] == "1"
    assert not Path(seen["folder"]).exists()


def can_unshare() -> bool:
    if not shutil.which("unshare"):
        return False
    tried = ["unshare", "--user", "--map-root-user", "--mount", "--pid", "--fork", "--mount-proc", "true"]
    return subprocess.run(tried, capture_output=True, check=False).returncode == 0


@pytest.mark.skipif(not can_unshare(), reason="namespaces cannot be made on this machine")
def test_in_namespaces_of_its_own_it_sees_neither_our_command_line_nor_the_set(
    place: Place, waxstudy: Waxstudy, tmp_path: Path
) -> None:
    """The recipe of docs/blind_test.md; without it, the command line of whoever asks can be read."""
    (tmp_path / "spy.py").write_text(SPY)
    word, folder = "blind-test", str(place.folder)
    spy = (sys.executable, str(tmp_path / "spy.py"), word, folder)
    bare = ("blind-test", "solve", "test", "--share", "0.2", "--name", "bare", "--", *spy)
    assert waxstudy(*bare).returncode == 0
    (seen,) = answers(place, "bare").values()
    assert seen["answer"]["said"]
    assert seen["answer"]["files"]
    apart = ("unshare", "--user", "--map-root-user", "--mount", "--pid", "--fork", "--mount-proc")
    cover = ("sh", "-c", 'mount -t tmpfs none "$0" && exec "$@"', folder)
    done = waxstudy("blind-test", "solve", "test", "--share", "0.2", "--name", "apart", "--", *apart, *cover, *spy)
    assert done.returncode == 0, done.stderr
    (seen,) = answers(place, "apart").values()
    assert seen["exit_code"] == 0, seen
    assert seen["answer"]["said"] == []
    assert seen["answer"]["files"] == []


def is_there(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def begun(folder: Path, script: Path) -> tuple[subprocess.Popen[str], int]:
    """Start a solving whose diagnoser waits; return it and the diagnoser's number."""
    told = folder / "told"
    script.write_text(f"import os, time; open({str(told)!r}, 'w').write(str(os.getpid())); time.sleep(600)")
    process = started(folder, "blind-test", "solve", "test", "--workers", 1, "--", sys.executable, script.name)
    while not (told.exists() and told.read_text()):
        assert process.poll() is None
        time.sleep(0.02)
    return process, int(told.read_text())


@pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")
@pytest.mark.parametrize("by", ["SIGTERM", "SIGHUP", "SIGKILL"])
def test_a_diagnoser_ends_with_the_command_that_asked_it(
    place: Place, tmp_path: Path, by: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    monkeypatch.setenv("TMPDIR", str(temporary))
    process, diagnoser = begun(tmp_path, tmp_path / "wait.py")
    assert is_there(diagnoser)
    os.kill(process.pid, signal.Signals[by])  # it alone, not its group
    process.wait(timeout=30)
    for _ in range(200):
        if not is_there(diagnoser):
            break
        time.sleep(0.05)
    assert not is_there(diagnoser)
    assert answers(place) == {}
    if by != "SIGKILL":
        assert process.returncode == 130
        assert list(temporary.iterdir()) == []


def children(process: int) -> list[int]:
    return [int(each) for path in Path(f"/proc/{process}/task").glob("*/children") for each in path.read_text().split()]


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
    workers = children(process.pid)
    assert len(workers) >= 2
    os.kill(process.pid, signal.Signals[by])  # it alone, not its group
    process.wait(timeout=60)
    assert process.returncode == (130 if by == "SIGTERM" else -signal.SIGKILL)
    for _ in range(200):
        if not any(map(is_there, workers)):
            break
        time.sleep(0.05)
    assert not any(map(is_there, workers))
    assert len(list(tmp_path.glob("new/boxes/*.box"))) < cases


@pytest.mark.skipif(sys.platform != "linux", reason="it can be asked on Linux only")
def test_a_process_whose_parent_ended_before_it_could_ask_ends_as_well() -> None:
    parents = [str(os.getpid()), str(os.getppid())]
    asking = "import sys; from waxstudy.blind_test.child import die_with_parent; die_with_parent(int(sys.argv[1]))"
    codes = [subprocess.run([sys.executable, "-c", asking, each], check=False).returncode for each in parents]
    assert codes == [0, -signal.SIGKILL]
