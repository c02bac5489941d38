"""Run a module's tests for each of its mutations, each time in a fork of a process that has loaded all libraries.

To start an interpreter and load numba and pandas takes longer than most of these tests. Called by `tests.mutation` in
its copy of the repository: SESSION TIMEOUT_S, then what pytest is told.
"""

from __future__ import annotations

import ast
import importlib
import importlib.util
import os
import signal
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

import pytest
from cosmic_ray.mutating import use_mutation
from cosmic_ray.plugins import get_operator
from cosmic_ray.work_db import WorkDB, use_db
from cosmic_ray.work_item import TestOutcome, WorkerOutcome, WorkItem, WorkResult

# pytest has to load its own plugins itself
OWN = ("_pytest", "pytest", "hypothesis", "_hypothesis", "xdist", "anyio")
LOADED = Path("libraries.txt")
LOOK_S = 0.02


def main(session: str, timeout_s: float, told: Sequence[str]) -> None:
    arguments = ["-q", "-x", "-p", "no:cacheprovider", *told]
    if not _passes(lambda: _tested_and_noted(arguments), float("inf")):
        raise SystemExit(f"the tests fail without any mutation: {' '.join(told)}")
    for name in LOADED.read_text().split():
        with suppress(Exception):
            importlib.import_module(name)
    # from now on nobody takes the code of one mutation for that of the next
    sys.dont_write_bytecode = True
    os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    with use_db(session) as known:
        for item in known.pending_work_items:
            _try(known, item, lambda: _tested(arguments), timeout_s)


def _try(known: WorkDB, item: WorkItem, tested: Callable[[], int], timeout_s: float) -> None:
    (mutation,) = item.mutations
    path = Path(mutation.module_path)
    Path(importlib.util.cache_from_source(str(path))).unlink(missing_ok=True)
    operator = get_operator(mutation.operator_name)(**mutation.operator_args)
    with use_mutation(path, operator, mutation.occurrence) as (before, after):
        is_change = after is not None and _run_of(after) not in ("", _run_of(before))
        passes = is_change and _passes(tested, timeout_s)
    if not is_change:
        known.set_result(item.job_id, WorkResult(worker_outcome=WorkerOutcome.SKIPPED))
        return
    lines = before.splitlines(), after.splitlines()
    first = next((i for i, (old, new) in enumerate(zip(*lines, strict=False)) if old != new), 0)
    outcome = TestOutcome.SURVIVED if passes else TestOutcome.KILLED
    diff = "\n".join(f"{sign}{text[first]}" for sign, text in zip("-+", lines, strict=True))
    known.set_result(item.job_id, WorkResult(worker_outcome=WorkerOutcome.NORMAL, test_outcome=outcome, diff=diff))


def _run_of(text: str) -> str:
    """Return what of a module is run, "" where it is no Python: what functions annotate is not run."""
    try:
        tree = ast.parse(text)
    except SyntaxError:  # the star before arguments that are named is taken for an operator
        return ""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            node.returns = None
        elif isinstance(node, ast.arg):
            node.annotation = None
    return ast.dump(tree)


def _passes(tested: Callable[[], int], timeout_s: float) -> bool:
    """Say whether tests pass in a process of their own, in time."""
    process = os.fork()
    if not process:
        os.setsid()
        code = 1
        with suppress(BaseException):
            code = int(tested())
        os._exit(code)
    end = time.monotonic() + timeout_s
    while True:
        ended, status = os.waitpid(process, os.WNOHANG)
        if ended:
            return status == 0
        if time.monotonic() > end:
            os.killpg(process, signal.SIGKILL)
            os.waitpid(process, 0)
            return False
        time.sleep(LOOK_S)


def _tested(arguments: Sequence[str]) -> int:
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)
    return int(pytest.main(list(arguments)))


def _tested_and_noted(arguments: Sequence[str]) -> int:
    """Note the libraries that the tests load: what lies outside the repository, where no mutation is."""
    code = _tested(arguments)
    files = {name: getattr(module, "__file__", None) or "" for name, module in list(sys.modules.items())}
    found = [name for name, file in files.items() if "site-packages" in file and not name.startswith(OWN)]
    LOADED.write_text("\n".join(found))
    return code


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), sys.argv[3:])
