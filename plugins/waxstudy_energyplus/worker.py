"""The process of one run: a job comes in on stdin, a result goes out on stdout, and the end of stdin ends it.

Started as `python -m waxstudy_energyplus.worker FOLDER`. EnergyPlus keeps state of its own in a process and may end
it; so each run has one, which dies with the one that asked for it and takes its folder along.
"""

from __future__ import annotations

import pickle
import sys
import traceback
from pathlib import Path
from typing import Any, BinaryIO

from waxstudy.simulation.own_process import end_with_asker, listen, send
from waxstudy.simulation.watch import Watch


def main(folder: Path) -> None:
    source, answer = listen()
    send(answer, _result(folder, source, answer))


def _result(folder: Path, source: BinaryIO, answer: BinaryIO) -> bytes:
    try:
        job = pickle.load(source)
        end_with_asker(source, folder)
        return pickle.dumps((_run(job, folder, answer), None, ""))
    except BaseException as error:
        text = traceback.format_exc()
        try:
            pickle.loads(pickle.dumps(error))
        except Exception:
            error = RuntimeError(f"{type(error).__name__}: {error}")
        return pickle.dumps((None, error, text))


def _run(job: Any, folder: Path, answer: BinaryIO) -> tuple[Any, Any]:
    from waxstudy_energyplus.library import MODEL, WEATHER, EnergyPlusError, Engine

    def give_up(call: str) -> None:
        error = EnergyPlusError(f"EnergyPlus was silent for longest_silence_s = {job.longest_silence_s:g} s {call}")
        send(answer, pickle.dumps((None, error, "")))

    engine = Engine(Watch(job.longest_silence_s, give_up))
    loop = job.loop(engine)
    code = engine.run(["-w", str(folder / WEATHER), "-d", str(folder), str(folder / MODEL)])
    if code:
        raise EnergyPlusError(f"EnergyPlus gave up with code {code}")
    return loop.minutes, loop.chain


if __name__ == "__main__":
    main(Path(sys.argv[1]))
