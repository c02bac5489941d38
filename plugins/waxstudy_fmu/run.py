"""One run of an FMU, asked of a process of its own: code of others may crash, hang, or keep what it allocates."""

from __future__ import annotations

import contextlib
import os
import pickle
import subprocess
import sys
import threading
from collections.abc import Callable

from waxstudy.plugin import FloatArray, SimulationError, Stopped
from waxstudy.results.atomic import scratch_folder
from waxstudy_fmu.job import Job

POLL_S = 0.05
LAST_LINES = 3


def simulate(job: Job, stop: Callable[[], bool]) -> FloatArray:
    """Return the record of a job; raise what the chain raises, `SimulationError` for the FMU's faults, or `Stopped`."""
    path = [entry or os.getcwd() for entry in sys.path]
    question = pickle.dumps(path) + pickle.dumps(job)
    with scratch_folder("waxstudy-fmu-run-") as folder, (folder / "printed.txt").open("w+b") as printed:
        process = subprocess.Popen(
            [sys.executable, "-m", "waxstudy_fmu.worker", str(folder)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=printed,
            cwd=folder,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(path)},
        )
        try:
            answer = _exchange(process, question, stop)
        finally:
            process.kill()
            process.wait()
            for pipe in (process.stdin, process.stdout):
                with contextlib.suppress(BrokenPipeError):
                    if pipe is not None:
                        pipe.close()
        printed.seek(0)
        said = printed.read().decode(errors="replace").splitlines()[-LAST_LINES:]
    return _understood(answer, process.returncode, "; ".join(line.strip() for line in said))


def _exchange(process: subprocess.Popen[bytes], question: bytes, stop: Callable[[], bool]) -> bytes:
    """Ask, and wait for the answer; stdin stays open, for its end would end the process."""
    asked, answered = process.stdin, process.stdout
    assert asked is not None
    assert answered is not None
    parts: list[bytes] = []

    def ask() -> None:
        with contextlib.suppress(BrokenPipeError):
            asked.write(question)
            asked.flush()

    def read() -> None:
        with contextlib.suppress(ValueError):  # nobody waits any more, and the pipe is closed
            parts.append(answered.read())

    threading.Thread(target=ask, daemon=True).start()
    reader = threading.Thread(target=read, daemon=True)
    reader.start()
    while reader.is_alive():
        reader.join(POLL_S)
        if stop():
            raise Stopped
    return parts[0] if parts else b""


def _understood(answer: bytes, code: int, said: str) -> FloatArray:
    printed = f"; it printed: {said}" if said else ""
    if not answer:
        raise SimulationError(f"the FMU's process ended by itself (code {code}){printed}")
    result: FloatArray
    result, error, is_of_fmu = pickle.loads(answer)
    if error is not None:
        raise SimulationError(f"{error}{printed}") if is_of_fmu else error
    return result
