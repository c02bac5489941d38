"""Where the points of a sweep are computed: in threads, in processes, or by dask on other machines."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager

from waxstudy.plugin import BackendMissing
from waxstudy.simulation.threads import use_one_thread
from waxstudy.simulation.workers import worker_processes
from waxstudy.sweeps.kinds import Kind
from waxstudy.sweeps.point import STOP

ANSWERS_WITHIN_S = 10.0  # a scheduler that is there answers in well under a second


@contextmanager
def executor(kind: Kind, workers: int, scheduler: str | None) -> Iterator[Executor]:
    """Give an executor; it ends with the block, and what was being computed with it.

    Without a scheduler's address dask gets a cluster of processes on this machine. Raises `BackendMissing` if dask is
    not installed or its scheduler does not answer.
    """
    if kind == "dask":
        with _dask(workers, scheduler) as pool:
            yield pool
    elif kind == "processes":
        use_one_thread()  # of each process: else they wait for each other
        with worker_processes(workers) as pool:
            yield pool
    else:
        threads = ThreadPoolExecutor(workers)
        STOP[0] = 0
        try:
            yield threads
        finally:  # nothing runs any more where the block has ended well
            STOP[0] = 1
            threads.shutdown(cancel_futures=True)


@contextmanager
def _dask(workers: int, scheduler: str | None) -> Iterator[Executor]:
    try:
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise BackendMissing("dask is not installed: pip install 'waxstudy[dask]'") from error
    own = None if scheduler else LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
    try:
        client = Client(own or scheduler, timeout=ANSWERS_WITHIN_S)
    except (OSError, ValueError) as error:
        raise BackendMissing(f"the dask scheduler at {scheduler} does not answer: {error}") from error
    try:
        yield client.get_executor(pure=False)
    finally:
        client.close()
        if own:
            own.close()
