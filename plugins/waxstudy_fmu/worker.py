"""The process of one run: a job comes in on stdin, a record goes out on stdout, and the end of stdin ends it.

Started as `python -m waxstudy_fmu.worker FOLDER`.
"""

from __future__ import annotations

import pickle
import sys
from pathlib import Path
from typing import Any

from waxstudy.simulation.own_process import end_with_asker, listen, send
from waxstudy.simulation.watch import Watch


def main(folder: Path) -> None:
    source, answer = listen()
    job = pickle.load(source)
    end_with_asker(source, folder)

    def give_up(call: str) -> None:
        said = f"the FMU did not return from {call} within longest_silence_s = {job.longest_silence_s:g} s"
        send(answer, pickle.dumps((None, said, True)))

    send(answer, _result(job, folder, Watch(job.longest_silence_s, give_up)))


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
