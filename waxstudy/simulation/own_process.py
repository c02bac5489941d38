"""A process of its own for one run of another engine, which may crash, hang, or keep what it allocates.

`ask` starts it as `python -m MODULE FOLDER`; there `listen` gives the question, `send` the answer. It dies with the
process that asked, however that ends.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO, NoReturn

PRINTED = "printed.txt"  # in the folder: whatever the engine prints
POLL_S = 0.05


def ask(module: str, folder: Path, job: Any, stop: Callable[[], bool]) -> tuple[bytes, int]:
    """Return the answer to a job, empty if the process ended without one, and its exit code; raise `Stopped`."""
    path = [entry or os.getcwd() for entry in sys.path]
    with (folder / PRINTED).open("wb") as printed:
        process = subprocess.Popen(
            [sys.executable, "-m", module, str(folder)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=printed,
            cwd=folder,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(path)},
        )
    try:
        answer = _exchange(process, pickle.dumps(path) + pickle.dumps(job), stop)
    finally:
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            with contextlib.suppress(BrokenPipeError):
                if pipe is not None:
                    pipe.close()
    return answer, process.returncode


def _exchange(process: subprocess.Popen[bytes], question: bytes, stop: Callable[[], bool]) -> bytes:
    """Ask, and wait for the answer; stdin stays open, for its end would end the process."""
    from waxstudy.plugin import Stopped

    asked, answered = process.stdin, process.stdout
    assert asked is not None
    assert answered is not None
    parts: list[bytes] = []

    def put() -> None:
        # it has ended already, and what it printed says why; or nobody waits any more, and the pipe is closed
        with contextlib.suppress(BrokenPipeError, ValueError):
            asked.write(question)
            asked.flush()

    def read() -> None:
        with contextlib.suppress(ValueError):  # nobody waits any more, and the pipe is closed
            parts.append(answered.read())

    # a process that is slow to start lets a long question wait, as it lets us wait for the answer
    threading.Thread(target=put, daemon=True).start()
    reader = threading.Thread(target=read, daemon=True)
    reader.start()
    while reader.is_alive():
        reader.join(POLL_S)
        if stop():
            raise Stopped
    return parts[0] if parts else b""


def listen() -> tuple[BinaryIO, BinaryIO]:
    """Return, in the process that was asked, where the pickled job comes from and where the answer goes to."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the one that asked
    answer = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # whatever the engine prints
    source = sys.stdin.buffer
    sys.path[:] = pickle.load(source)
    return source, answer


def send(answer: BinaryIO, *parts: Any) -> NoReturn:
    """Give the answer, bytes or memory one after another, and end: the engine need not tidy up."""
    sys.stdout.flush()
    for part in parts:
        answer.write(part)
    answer.flush()
    os._exit(0)


def end_with_asker(source: BinaryIO, folder: Path) -> None:
    """Go, and take the folder along, when stdin ends: it does however the process that asked ends."""

    def wait() -> None:
        source.read()
        shutil.rmtree(folder, ignore_errors=True)
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()
