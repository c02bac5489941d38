"""The command line in a process forked from one that has loaded its libraries, which saves a second."""

from __future__ import annotations

import multiprocessing
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from subprocess import CompletedProcess, TimeoutExpired
from tempfile import TemporaryDirectory

# libraries alone: nothing of the project is loaded, found or kept from one command to the next
LIBRARIES = ("click", "numba", "numpy", "pandas", "pvlib", "pydantic", "rich.console", "scipy.signal", "scipy.stats")
LIMIT_S = 300.0
CAN_FORK = sys.platform == "linux"

if CAN_FORK:
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as `make test` has it; later it would not be read
    multiprocessing.get_context("forkserver").set_forkserver_preload(list(LIBRARIES))


def run_preloaded(folder: Path, words: Sequence[str], environment: Mapping[str, str]) -> CompletedProcess[str]:
    """Run a command in a folder with an environment, as `subprocess.run` would; the first word is its program."""
    with TemporaryDirectory() as kept:
        printed = [Path(kept) / name for name in ("stdout", "stderr")]
        for path in printed:
            path.touch()
        of_it = (folder, list(words), dict(environment), printed)
        process = multiprocessing.get_context("forkserver").Process(target=_command, args=of_it)
        process.start()
        process.join(LIMIT_S)
        is_late = process.exitcode is None
        process.kill()
        out, err = (each.read_text(encoding="utf-8") for each in printed)
    if is_late:
        raise TimeoutExpired(words, LIMIT_S, out, err)
    assert process.exitcode is not None
    return CompletedProcess(words, process.exitcode, out, err)


def _command(folder: Path, words: Sequence[str], environment: Mapping[str, str], printed: Sequence[Path]) -> None:
    for number, path in enumerate(printed, start=1):
        os.dup2(os.open(path, os.O_WRONLY), number)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = list(words)
    from waxstudy.cli import main

    main(sys.argv[1:])
