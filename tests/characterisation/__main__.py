"""Compare today's diagnosis with the stored one on the characterisation set: `make characterise`.

`--store` writes what is found instead; a change of it needs its reasons in CHANGELOG.md. Records are made once, in
results/characterisation, and their digests are compared as well: a change of a record is no change of the diagnosis.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from tests.characterisation.outcome import outcome
from tests.characterisation.records import Recipe, recipes

STORED = Path(__file__).with_name("stored.json")


def computed(chosen: Sequence[Recipe], workers: int) -> dict[str, dict[str, Any]]:
    found = {}
    with ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn")) as pool:
        for number, job in enumerate(as_completed([pool.submit(outcome, recipe) for recipe in chosen]), start=1):
            told = job.result()
            found[told.pop("name")] = told
            print(f"\r{number} of {len(chosen)} records", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return dict(sorted(found.items()))


def differences(stored: Mapping[str, Any], found: Mapping[str, Any]) -> Iterator[str]:
    """Yield a line for each figure that is another one than was stored."""
    for name, told in found.items():
        before = stored.get(name)
        if before is None:
            yield f"{name}: not stored"
            continue
        for key in before.keys() | told.keys():
            if key != "seconds" and before.get(key) != told.get(key):
                yield f"{name}: {key}\n    stored {json.dumps(before.get(key))}\n    now    {json.dumps(told.get(key))}"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.characterisation", description=__doc__)
    parser.add_argument("--store", action="store_true", help="write what is found instead of comparing")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="only every Nth record")
    parser.add_argument("--first", type=int, default=0, metavar="N", help="the first of these")
    parser.add_argument("--only", default="", metavar="TEXT", help="only records with this in their name")
    parser.add_argument("--workers", type=int, default=2)
    asked = parser.parse_args()
    chosen = [recipe for recipe in recipes()[asked.first :: asked.every] if asked.only in recipe.name]
    stored = json.loads(STORED.read_text(encoding="utf-8")) if STORED.exists() else {}
    found = computed(chosen, asked.workers)
    seconds = sum(told.pop("seconds") for told in found.values())
    lines = list(differences(stored, found))
    print("\n".join(lines))
    print(f"{len(found)} records, {len(lines)} differences, {seconds:.0f} s of diagnosis")
    if asked.store:
        text = ",\n".join(
            f" {json.dumps(name)}: {json.dumps(told)}" for name, told in sorted({**stored, **found}.items())
        )
        STORED.write_text(f"{{\n{text}\n}}\n", encoding="utf-8")
    elif lines:
        sys.exit(1)


if __name__ == "__main__":
    main()
