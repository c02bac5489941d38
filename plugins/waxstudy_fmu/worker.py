"""The process of one run: a job comes in on stdin, a record goes out on stdout, and the end of stdin ends it.

Started as `python -m waxstudy_fmu.worker FOLDER`.
"""

from __future__ import annotations

import os
import pickle
import shutil
import signal
import sys
import threading
from pathlib import Path
from typing import Any, BinaryIO

from waxstudy_fmu.watch import Watch, send


def main(folder: Path) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the one that asked
    answer = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # whatever the FMU prints
    sys.path[:] = pickle.load(sys.stdin.buffer)
    job = pickle.load(sys.stdin.buffer)
    threading.Thread(target=_end_with, args=(sys.stdin.buffer, folder), daemon=True).start()
    watch = Watch(job.longest_silence_s, answer)
    threading.Thread(target=watch.look, daemon=True).start()
    send(answer, _result(job, folder, watch))


def _end_with(source: BinaryIO, folder: Path) -> None:
    """Wait for the end of stdin, which comes however the asking process ends, and go with it."""
    source.read()
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(1)


def _result(job: Any, folder: Path, watch: Watch) -> bytes:
    from waxstudy_fmu.stepping import FmuFailed, record

    try:
        return pickle.dumps((record(job, folder, watch), None, False))
    except FmuFailed as error:
        return pickle.dumps((None, str(error), True))
    except BaseException as error:
        try:
            pickle.loads(answer := pickle.dumps((None, error, False)))
        except Exception:
            answer = pickle.dumps((None, f"{type(error).__name__}: {error}", True))
        return answer


if __name__ == "__main__":
    main(Path(sys.argv[1]))
