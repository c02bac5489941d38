"""Where the points of a sweep are computed: in threads, in processes, or by dask on other machines."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import contextmanager

import numpy as np

from waxstudy.plugin import BackendMissing
from waxstudy.simulation.threads import use_one_thread
from waxstudy.simulation.workers import worker_processes
from waxstudy.sweeps.kinds import Kind

ANSWERS_WITHIN_S = 10.0  # a scheduler that is there answers in well under a second


@contextmanager
def executor(kind: Kind, workers: int, scheduler: str | None) -> Iterator[tuple[Executor, np.ndarray]]:
    """Give an executor and a stop of its own (1,); it ends with the block, and what was being computed with it.

    The stop is 1 once the block ends, for threads to look at; other processes hold a copy, and are ended.
    Without a scheduler's address dask gets a cluster of processes on this machine. Raises `BackendMissing` if dask is
    not installed or its scheduler does not answer.
    """
    stop = np.zeros(1, dtype=np.int64)
    if kind == "dask":
        with _dask(workers, scheduler) as pool:
            yield pool, stop
    elif kind == "processes":
        use_one_thread()  # of each process: else they wait for each other
        with worker_processes(workers) as pool:
            yield pool, stop
    else:
        threads = ThreadPoolExecutor(workers)
        try:
            yield threads, stop
        finally:  # nothing runs any more where the block has ended well
            stop[0] = 1
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
