"""The folder of compiled code, named by a digest of all sources: numba's own cache misses edits in other files."""

from __future__ import annotations

import logging
import shutil
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import llvmlite
import numba
import numpy as np

from waxstudy.simulation.cache_place import cache_base, private
from waxstudy.simulation.sources import digest, source_digest

log = logging.getLogger(__name__)
T = TypeVar("T")


def cache_folder() -> Path:
    """Folder of the compiled code; one subfolder per digest."""
    versions = (numba.__version__, llvmlite.__version__, np.__version__, sys.version)
    return cache_base() / digest((*versions, source_digest(__name__)))


_one_at_a_time = threading.Lock()  # numba has one cache folder for the whole process


def cached(build: Callable[[Path | None], T]) -> T:
    """Build with the disk cache, or without it where it cannot be used; a damaged one is removed for the next time."""
    with _one_at_a_time:
        return _cached(build, cache_folder())


def _cached(build: Callable[[Path | None], T], folder: Path) -> T:
    if private(folder) is None:
        return build(None)
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(folder)
    try:
        return build(folder)
    except numba.core.errors.NumbaError:
        raise
    except Exception as error:  # a damaged cache may raise anything while it is read
        built = build(None)  # what is wrong with the code itself is raised here again
        log.info("compiled code cannot be cached in %s: %s", folder, error)
        shutil.rmtree(folder, ignore_errors=True)
        return built
    finally:
        numba.config.CACHE_DIR = before
