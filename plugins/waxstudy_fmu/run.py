"""One run of an FMU, asked of a process of its own: code of others may crash, hang, or keep what it allocates."""

from __future__ import annotations

import pickle
from collections.abc import Callable

from waxstudy.plugin import FloatArray, SimulationError
from waxstudy.results.atomic import scratch_folder
from waxstudy.simulation.own_process import PRINTED, ask
from waxstudy_fmu.job import Job

LAST_LINES = 3


def simulate(job: Job, stop: Callable[[], bool]) -> FloatArray:
    """Return the record of a job; raise what the chain raises, `SimulationError` for the FMU's faults, or `Stopped`."""
    with scratch_folder("waxstudy-fmu-run-") as folder:
        answer, code = ask("waxstudy_fmu.worker", folder, job, stop)
        said = (folder / PRINTED).read_text(errors="replace").splitlines()[-LAST_LINES:]
    return _understood(answer, code, "; ".join(line.strip() for line in said))


def _understood(answer: bytes, code: int, said: str) -> FloatArray:
    printed = f"; it printed: {said}" if said else ""
    if not answer:
        raise SimulationError(f"the FMU's process ended by itself (code {code}){printed}")
    result: FloatArray
    result, error, is_of_fmu = pickle.loads(answer)
    if error is not None:
        raise SimulationError(f"{error}{printed}") if is_of_fmu else error
    return result
