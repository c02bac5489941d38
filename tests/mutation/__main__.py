"""Change the code in one place after another, and see whether a test notices: `make mutate`.

Works on a copy of the last commit. Of each module as many mutations as `--most` says are drawn by a seed. Prints how
many of them the module's tests killed, and each that survived.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomli_w

COSMIC_RAY = ("cosmic_ray.cli",)
ROOT = Path(__file__).parents[2]
QUICK = ("-m", "not slow")
# module -> the tests that are quick enough to be run for every mutation of it
MODULES: dict[str, tuple[str, ...]] = {
    "waxstudy/results/kpis.py": ("tests/results/test_kpis.py",),
    "waxstudy/results/checksums.py": ("tests/results/test_run_folder.py",),
    "waxstudy/simulation/kernel.py": ("tests/simulation/test_engine.py", "-k", "False or equations"),  # interpreted
    "waxstudy/simulation/shift.py": ("tests/simulation/test_shift.py",),
    "waxstudy/diagnosis/criteria.py": ("tests/diagnosis/test_criteria.py",),
    "waxstudy/diagnosis/select/evidence.py": ("tests/diagnosis/test_evidence.py",),
    "waxstudy/diagnosis/select/appraise.py": ("tests/diagnosis/test_weighing.py",),
    "waxstudy/diagnosis/select/weigh.py": ("tests/diagnosis/test_weighing.py",),
    "waxstudy/diagnosis/select/posterior.py": ("tests/diagnosis/test_weigh.py",),
    "waxstudy/diagnosis/select/gain_spread.py": ("tests/diagnosis/test_weigh.py",),
    "waxstudy/diagnosis/residuals/switching.py": ("tests/diagnosis/test_residuals.py",),
    "waxstudy/diagnosis/residuals/continuous.py": (
        "tests/diagnosis/test_opening_path.py",
        "tests/diagnosis/test_residuals.py",
    ),
    "waxstudy/identification/times.py": ("tests/fit/test_times.py",),
    "waxstudy/identification/valve.py": ("tests/fit/test_valve.py",),
    "plugins/waxstudy_paper/actuators.py": ("tests/paper/test_actuators.py",),
}


@dataclass(frozen=True)
class Outcome:
    """What became of one module's mutations; `survived` has a line and what was put there for each."""

    module: str
    killed: int
    survived: list[str]

    @property
    def count(self) -> int:
        return self.killed + len(self.survived)


def mutated(module: str, timeout_s: float, most: int, seed: int) -> Outcome:
    """Try mutations of a module, at most so many, in a copy of the repository."""
    with tempfile.TemporaryDirectory() as place:
        copy = Path(place, "copy")
        subprocess.run(["git", "clone", "--quiet", "--shared", str(ROOT), str(copy)], check=True)
        about = {
            "module-path": module,
            "timeout": timeout_s,
            "excluded-modules": [],
            "test-command": "",  # the tests are run by ours
            "distributor": {"name": "local"},
        }
        (copy / "mutation.toml").write_bytes(tomli_w.dumps({"cosmic-ray": about}).encode())
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(copy), str(copy / "plugins")))}
        _called([*COSMIC_RAY, "init", "mutation.toml", "m.sqlite"], copy, environment)
        _drawn(copy / "m.sqlite", most, random.Random(f"{seed} {module}"))
        _called(["tests.mutation.forked", "m.sqlite", str(timeout_s), *QUICK, *MODULES[module]], copy, environment)
        told = _called([*COSMIC_RAY, "dump", "m.sqlite"], copy, environment)
    results = [(item, result) for item, result in map(json.loads, told.splitlines()) if result]
    tried = [(item, result) for item, result in results if result["worker_outcome"] != "skipped"]
    survived = [_told(item, result) for item, result in tried if result["test_outcome"] == "survived"]
    return Outcome(module, len(tried) - len(survived), survived)


def _drawn(session: Path, most: int, drawing: random.Random) -> None:
    """Leave as many mutations of a session as are asked for; the others are marked as skipped."""
    from cosmic_ray.work_db import use_db
    from cosmic_ray.work_item import WorkerOutcome, WorkResult

    with use_db(str(session)) as known:
        jobs = [item.job_id for item in known.work_items]
        for job in set(jobs) - set(drawing.sample(jobs, min(most, len(jobs)))):
            known.set_result(job, WorkResult(worker_outcome=WorkerOutcome.SKIPPED))


def _called(command: list[str], folder: Path, environment: dict[str, str]) -> str:
    """Run a module of Python."""
    done = subprocess.run(
        [sys.executable, "-m", *command], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise SystemExit(f"{command[0]}: {done.stdout}{done.stderr}")
    return done.stdout


def _told(item: Any, result: Any) -> str:
    (mutation,) = item["mutations"]
    changed = [
        line for line in (result["diff"] or "").splitlines() if line[:1] in "+-" and line[:3] not in ("+++", "---")
    ]
    return f"{mutation['module_path']}:{mutation['start_pos'][0]} {mutation['operator_name']}: {' '.join(changed)}"


def told(each: Outcome) -> Iterator[str]:
    share = each.killed / each.count if each.count else 1.0
    yield f"{each.module:50} {each.killed:4} of {each.count:4} killed  {share:4.0%}"
    yield from (f"  survived: {line}" for line in each.survived)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.mutation", description=__doc__)
    parser.add_argument("modules", nargs="*", metavar="MODULE", help=f"one of {', '.join(MODULES)}  [default: all]")
    parser.add_argument("--workers", type=int, default=2, help="modules at a time")
    parser.add_argument("--most", type=int, default=30, help="mutations of each module  [default: 30]")
    parser.add_argument("--seed", type=int, default=1, help="of which they are drawn  [default: 1]")
    parser.add_argument("--timeout-s", type=float, default=120.0, help="after which a mutation counts as killed")
    said = parser.parse_args()
    if unknown := set(said.modules) - set(MODULES):
        parser.error(f"no tests are known for {', '.join(sorted(unknown))}")
    with ThreadPoolExecutor(said.workers) as pool:
        for outcome in pool.map(
            lambda module: mutated(module, said.timeout_s, said.most, said.seed), said.modules or MODULES
        ):
            print("\n".join(told(outcome)), flush=True)


if __name__ == "__main__":
    main()
