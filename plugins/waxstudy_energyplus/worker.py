"""The process of one run: a job comes in on stdin, a result goes out on stdout, and the end of stdin ends it.

Started as `python -m waxstudy_energyplus.worker FOLDER`. EnergyPlus keeps state of its own in a process and may end
it; so each run has one, which dies with the one that asked for it and takes its folder along.
"""

from __future__ import annotations

import os
import pickle
import shutil
import signal
import sys
import threading
import traceback
from pathlib import Path
from typing import Any, BinaryIO


def main(folder: Path) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the one that asked
    answer = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # whatever the engine prints
    sys.path[:] = pickle.load(sys.stdin.buffer)
    result = _result(folder, sys.stdin.buffer)
    answer.write(result)
    answer.flush()
    os._exit(0)  # the engine's library need not tidy up


def _result(folder: Path, source: BinaryIO) -> bytes:
    try:
        job = pickle.load(source)
        threading.Thread(target=_end_with, args=(source, folder), daemon=True).start()
        return pickle.dumps((_run(job, folder), None, ""))
    except BaseException as error:
        text = traceback.format_exc()
        try:
            pickle.loads(pickle.dumps(error))
        except Exception:
            error = RuntimeError(f"{type(error).__name__}: {error}")
        return pickle.dumps((None, error, text))


def _end_with(source: BinaryIO, folder: Path) -> None:
    """Wait for the end of stdin, which comes however the asking process ends, and go with it."""
    source.read()
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(1)


def _run(job: Any, folder: Path) -> tuple[Any, Any]:
    from waxstudy_energyplus.library import EnergyPlusError, Engine
    from waxstudy_energyplus.loop import Loop

    engine = Engine()
    loop = Loop(job, engine)
    code = engine.run(["-w", str(folder / "year.epw"), "-d", str(folder), str(folder / "room.epJSON")])
    if code:
        raise EnergyPlusError(f"EnergyPlus gave up with code {code}")
    return loop.minutes, loop.chain


if __name__ == "__main__":
    main(Path(sys.argv[1]))
