"""Run the campaign and print what came of it: `python -m tests.attack`, or `make attack`."""

from __future__ import annotations

import argparse
import sys

from tests.attack.campaign import Told, run
from tests.attack.classes import CLASSES


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.attack", description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--share", type=float, default=1.0, help="share of each class")
    parser.add_argument("--only", choices=[each.name for each in CLASSES], action="append", help="class; repeatable")
    parser.add_argument("--number", type=int, help="one attack of a class")
    asked = parser.parse_args()
    seed = asked.seed
    chosen = [each for each in CLASSES if not asked.only or each.name in asked.only]
    print(f"seed {seed}")
    print(f"{'class':<12} {'tried':>5} {'failed':>6}   time", flush=True)
    failed = 0
    for each in run(chosen, seed, asked.share, asked.number):
        print(line(each), flush=True)
        failed += len(each.failures)
        for failure in each.failures:
            print(f"  {reproduced(failure.name, seed, failure.number)}\n    {failure.what}", flush=True)
    return 1 if failed else 0


def line(told: Told) -> str:
    left_out = f"   left out: {told.left_out}" if told.left_out else ""
    return f"{told.name:<12} {told.tried:>5} {len(told.failures):>6} {told.took_s:>5.0f} s{left_out}"


def reproduced(name: str, seed: int, number: int) -> str:
    """Return the command that makes an attack again."""
    return f"python -m tests.attack --only {name} --seed {seed} --number {number}"


if __name__ == "__main__":
    sys.exit(main())
