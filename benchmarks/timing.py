"""How long something takes."""

from __future__ import annotations

import resource
import time
from collections.abc import Callable

REPEATS = 7


def best_s(work: Callable[[], object]) -> float:
    """Shortest of several runs, the first (warm-up) left out."""
    work()
    times = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return min(times)


def processor_s() -> float:
    """Seconds of processor so far, of this process and of those that it waited for; others at work do not count."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime
