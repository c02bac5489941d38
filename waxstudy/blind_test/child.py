"""The process of a diagnoser: what it is given, how long it may take, and that it ends when we do."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

from waxstudy.blind_test.answer import Answer, NoAnswer
from waxstudy.simulation.cache_place import cache_base
from waxstudy.simulation.threads import ONE_THREAD
from waxstudy.simulation.workers import die_with_parent

TAIL = 2000  # letters of stderr that are kept of a failure
INTERRUPTED = tuple(each for name in (signal.SIGINT, signal.SIGTERM) for each in (-name, 128 + name))
A_MOMENT_S = 2.0  # in which a signal that ended a diagnoser has reached us as well
# what a process needs to find its interpreter and libraries and to write text; all else stays with us
KEPT = ("PATH", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "LANG", "LC_ALL", "LC_CTYPE", "TZ", "SYSTEMROOT", "PATHEXT")


class NoProcess(Exception):
    """A command cannot be started; the message says which and why."""


_running: set[subprocess.Popen[str]] = set()
_stopped = threading.Event()  # what ends from then on was ended, and has not answered


def begin() -> None:
    _stopped.clear()


def end_all() -> None:
    """End what still runs, with its children."""
    _stopped.set()
    for process in list(_running):
        _end(process)


def answered(command: Sequence[str], folder: Path, timeout_s: float) -> dict[str, Any] | None:
    """Run a command in a folder; return its answer, or what it said instead; None if it was interrupted with us."""
    told = _called(command, folder, timeout_s)
    return None if _stopped.wait(A_MOMENT_S if told["exit_code"] in INTERRUPTED else 0) else told


def environment(home: Path) -> dict[str, str]:
    """Return the variables that a diagnoser gets: nothing that says where the records or their key are."""
    kept = {name: os.environ[name] for name in KEPT if name in os.environ}
    own = {"HOME": str(home), "TMPDIR": str(home), "WAXSTUDY_CACHE": str(cache_base())}
    return {**kept, **own, **ONE_THREAD}


def _called(command: Sequence[str], folder: Path, timeout_s: float) -> dict[str, Any]:
    begun = time.perf_counter()
    try:
        process = subprocess.Popen(
            command,
            cwd=folder,
            env=environment(folder),
            encoding="utf-8",
            errors="replace",
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
            preexec_fn=partial(die_with_parent, os.getpid()) if os.name == "posix" else None,
        )
    except OSError as error:
        raise NoProcess(f"{command[0]}: cannot be run: {error.strerror or error}") from error
    _running.add(process)
    if _stopped.is_set():  # all were ended while this one was being started
        _end(process)
    try:
        out, err = process.communicate(timeout=timeout_s)
    except subprocess.TimeoutExpired:
        _end(process)
        out, err = process.communicate()
        err += f"\nended after {timeout_s:g} s"
    finally:
        _running.discard(process)
    told: dict[str, Any] = {"seconds": round(time.perf_counter() - begun, 2), "exit_code": process.returncode}
    answer, problem = _read(out, process.returncode)
    return {**told, "answer": answer} if answer else {**told, "answer": None, "problem": problem, "stderr": err[-TAIL:]}


def _end(process: subprocess.Popen[str]) -> None:
    if os.name == "posix":
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()


def _read(out: str, exit_code: int) -> tuple[Any, str]:
    """Return the answer and no problem, or None and why there is none."""
    if exit_code:
        return None, f"it ended with exit code {exit_code}"
    try:
        said = json.loads(out)
        Answer.read(said)
    except (ValueError, NoAnswer) as error:
        return None, f"it printed no diagnosis: {error}"
    return said, ""
