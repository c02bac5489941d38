"""The command line in a process that lives on: a start costs a second, and a call that hangs costs the process."""

from __future__ import annotations

import faulthandler
import io
import multiprocessing
import os
import resource
import warnings
from contextlib import redirect_stderr, redirect_stdout
from multiprocessing.connection import Connection
from pathlib import Path
from types import TracebackType

from tests.attack.verdict import Ended

MOST_BYTES = 6_000_000_000  # of address space: who needs more was led to
START_S = 120.0


def _serve(pipe: Connection) -> None:
    from waxstudy.cli import main

    faulthandler.disable()
    resource.setrlimit(resource.RLIMIT_AS, (MOST_BYTES, MOST_BYTES))
    pipe.send("ready")
    while True:
        folder, arguments = pipe.recv()
        os.chdir(folder)
        pipe.send(_called(main, arguments))


def _called(main: object, arguments: list[str]) -> Ended:
    out, err = (io.TextIOWrapper(io.BytesIO(), encoding="utf-8", errors="replace") for _ in range(2))
    code: int | None = None
    # the filters of a new process; entering makes warnings that were shown once be shown again
    with redirect_stdout(out), redirect_stderr(err), warnings.catch_warnings():
        try:
            main(arguments)  # type: ignore[operator]
        except SystemExit as error:
            code = int(error.code or 0)
        except BaseException as error:
            err.write(f"Traceback: {type(error).__name__}: {error}")
            code = 1
    texts = []
    for stream in (out, err):
        stream.flush()
        texts.append(stream.buffer.getvalue().decode("utf-8", "replace"))  # type: ignore[attr-defined]
    return Ended(code, *texts)


class Worker:
    """Calls commands one after the other; the process is made anew where one does not end in time."""

    def __init__(self) -> None:
        self._begin()

    def _begin(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs,), daemon=True)
        self._process.start()
        theirs.close()
        if not self._pipe.poll(START_S):
            raise RuntimeError("the worker did not start")
        self._pipe.recv()

    def call(self, folder: Path, *arguments: object, limit_s: float) -> Ended:
        """Return how the command ended; code None where it did not within the limit, or took the process with it."""
        self._pipe.send((str(folder), [str(each) for each in arguments]))
        try:
            if self._pipe.poll(limit_s):
                return self._pipe.recv()  # type: ignore[no-any-return]
        except EOFError:
            pass
        self._process.kill()
        self._process.join()
        ended = Ended(None, "", f"ended with {self._process.exitcode}")
        self._begin()
        return ended

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._process.kill()
        self._process.join()
