"""One thread for linear algebra: the matrices are small, and its threads would only wait for each other."""

from __future__ import annotations

import os

ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def use_one_thread() -> None:
    """Take one thread, unless the user asks for others; it counts for libraries that are loaded after it."""
    if not set(ONE_THREAD) & set(os.environ):
        os.environ.update(ONE_THREAD)
