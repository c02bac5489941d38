"""What others can look up of our process: its command line, variables and working folder say where the set is."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import chdir, contextmanager

from waxstudy.simulation.cache_place import cache_base
from waxstudy.simulation.workers import LIBC

PR_SET_DUMPABLE = 4


@contextmanager
def out_of_sight() -> Iterator[None]:
    """Hide what we were called with and where; what is read or written within the block has absolute paths.

    On Linux nobody but the administrator reads our memory and open files from then on.
    """
    from setproctitle import setproctitle

    setproctitle("waxstudy blind-test solve")  # first: it overwrites variables up to the first new one
    # the user may have named both from the folder that we leave
    os.environ["WAXSTUDY_CACHE"] = str(cache_base())
    tempfile.tempdir = tempfile.gettempdir()
    if sys.platform == "linux":
        LIBC.prctl(PR_SET_DUMPABLE, 0)
    with chdir(os.sep):
        yield
