"""The command line in a process forked from one that has loaded its libraries: a second less than one that begins."""

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

_server = multiprocessing.get_context("forkserver")
_server.set_forkserver_preload(list(LIBRARIES))


def forked(folder: Path, arguments: Sequence[str], environment: Mapping[str, str]) -> CompletedProcess[str]:
    """Run a command in a folder with an environment, as `subprocess.run` would."""
    with TemporaryDirectory() as kept:
        printed = [Path(kept) / name for name in ("stdout", "stderr")]
        process = _server.Process(target=_command, args=(folder, arguments, environment, printed))
        process.start()
        process.join(LIMIT_S)
        if process.exitcode is None:
            process.kill()
            raise TimeoutExpired(arguments, LIMIT_S)
        out, err = (each.read_text(encoding="utf-8") for each in printed)
    return CompletedProcess(arguments, process.exitcode, out, err)


def _command(folder: Path, arguments: Sequence[str], environment: Mapping[str, str], printed: Sequence[Path]) -> None:
    for number, path in enumerate(printed, start=1):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT), number)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = list(arguments)
    from waxstudy.cli import main

    main(sys.argv[1:])
