"""The process of one run: a job comes in on stdin, a result goes out on stdout, and the end of stdin ends it.

Started as `python -m waxstudy_energyplus.worker FOLDER`. EnergyPlus keeps state of its own in a process and may end
it; so each run has one, which dies with the one that asked for it and takes its folder along. It starts in a tenth of
a second, for it imports next to nothing.
"""

from __future__ import annotations

import pickle
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO

from waxstudy.simulation.own_process import end_with_asker, listen, send
from waxstudy.simulation.watch import Watch
from waxstudy_energyplus.library import MODEL, WEATHER, Engine, EngineFailed
from waxstudy_energyplus.loop import Job, Loop


def main(folder: Path) -> None:
    source, answer = listen()
    send(answer, *_result(folder, source, answer))


def _result(folder: Path, source: BinaryIO, answer: BinaryIO) -> Sequence[Any]:
    """Return a pickled error and its traceback, or none of them and then the record's numbers as they are in memory."""
    try:
        job = pickle.load(source)
        end_with_asker(source, folder)
        loop = _run(job, folder, answer)
        return pickle.dumps((None, "")), loop.rows, loop.chain
    except BaseException as error:
        text = traceback.format_exc()
        try:
            pickle.loads(pickle.dumps(error))
        except Exception:
            error = RuntimeError(f"{type(error).__name__}: {error}")
        return (pickle.dumps((error, text)),)


def _run(job: Job, folder: Path, answer: BinaryIO) -> Loop:
    def give_up(call: str) -> None:
        error = EngineFailed(f"EnergyPlus was silent for longest_silence_s = {job.longest_silence_s:g} s {call}")
        send(answer, pickle.dumps((error, "")))

    engine = Engine(job.engine, Watch(job.longest_silence_s, give_up))
    loop = job.loop(engine)
    code = engine.run(["-w", str(folder / WEATHER), "-d", str(folder), str(folder / MODEL)])
    if code:
        raise EngineFailed(f"EnergyPlus gave up with code {code}")
    if loop.step < job.steps:
        raise EngineFailed(
            f"EnergyPlus ran {loop.step} of {job.steps} steps: has the weather file all days of the run?"
        )
    loop.end()
    return loop


if __name__ == "__main__":
    main(Path(sys.argv[1]))
