"""What the diagnosis finds in records that the same code made: `python -m benchmarks.self_consistency`.

Every effect of the library in three severities, and records without one, on the fast room: all channels, a minute, 14
days, noise as `waxstudy reality` has it. Nothing here says how well it does with another physics. Beside the true gap
over its noise floor stands what is left of that (`beyond`) when all that nobody knows of the room takes the values
that suit the believed model best.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

from benchmarks.self_consistency_outcome import outcome
from benchmarks.self_consistency_records import SEVERITIES, Made, nulls, with_effect
from waxstudy.blind_test import figures
from waxstudy.results.atomic import whole_file
from waxstudy.simulation.sources import digest

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "results" / "self-consistency"
PACKAGES = ("blind_test", "dataset", "diagnosis", "plugin", "results", "simulation", "study", "synthetic")
LEAST = 2.0  # true gap over the noise floor from which an effect must be found


def sources() -> str:
    """Digest of all that an outcome depends on, so that nothing stale is taken for new."""
    folders = [*(ROOT / "waxstudy" / name for name in PACKAGES), *(ROOT / "plugins").glob("waxstudy_*")]
    files = [
        file
        for folder in folders
        for kind in ("*.py", "limits.csv", "criteria.csv", "weights.csv")
        for file in folder.rglob(kind)
    ]
    return digest(sorted([*files, *(ROOT / "benchmarks").glob("self_consistency_*.py")]))


def computed(records: Sequence[Made], folder: Path, workers: int) -> list[dict[str, Any]]:
    """Return the outcome of each record; what the folder has already is taken from there."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = {made.name: folder / f"{made.name}.json" for made in records}
    missing = [made for made in records if not paths[made.name].exists()]
    with ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn")) as pool:
        for number, future in enumerate(as_completed([pool.submit(outcome, made) for made in missing])):
            if future.exception():
                pool.shutdown(cancel_futures=True)
            told = future.result()
            with whole_file(paths[told["name"]]) as path:
                path.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")
            print(f"{number + 1} of {len(missing)}: {told['name']}", file=sys.stderr)
    return [json.loads(path.read_text(encoding="utf-8")) for path in paths.values()]


def share(count: int, of: int) -> str:
    """Return a share with its 95 % interval (Wilson)."""
    if of == 0:
        return "none of none"
    figure = figures.share([True] * count + [False] * (of - count))
    return f"{count} of {of}: {figure.value:.3f} (95 % {figure.low:.3f} to {figure.high:.3f})"


def line(told: Mapping[str, Any]) -> str:
    found = "; ".join(f"{' | '.join(each['group'])} {_said(each['parameters'])}" for each in told["found"])
    size = f"{told['gap'] / told['floor']:9.1f} {told['beyond']:8.1f}"
    how = "right" if told["right"] else ("missed" if not told["found"] else "wrong")
    at = ", ".join(told["unexplained"])
    return (
        f"{told['effect']:15} {told['severity']:7} {size} {told['verdict']:10} {how:7} "
        f"{_true(told['true'])} -> {found or '-'}" + (f" [unexplained: {at}]" if at else "")
    )


def _said(parameters: Mapping[str, Sequence[float]]) -> str:
    return ", ".join(f"{name} {v:.4g} ({low:.4g} to {high:.4g})" for name, (v, low, high) in parameters.items())


def _true(values: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {value:.4g}" for name, value in values.items())


def summary(told: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the shares: right where the gap is large enough, and false alarms."""
    effects, none = [t for t in told if t["effect"]], [t for t in told if not t["effect"]]
    large = [t for t in effects if t["gap"] > LEAST * t["floor"]]
    beyond = [t for t in large if t["beyond"] > LEAST]
    lines = ["Self-consistency (the same code makes and fits these records):"]
    for label, chosen in (("right", large), *((f"right, {s}", _of(large, s)) for s in SEVERITIES)):
        lines.append(f"{label}, gap above {LEAST:g} floors: {right(chosen)}")
    lines.append(f"right, also with the room fitted within its tolerances: {right(beyond)}")
    wrong = [t for t in effects if t["found"] and not t["right"]]
    lines.append(f"wrong names, whatever the gap: {share(len(wrong), len(effects))}")
    covered = [(t["true"][name], *ends) for t in large if t["right"] for f in t["found"] for name, ends in _own(t, f)]
    lines.append(
        f"true parameters in their 95 % interval: {share(sum(lo <= x <= hi for x, _, lo, hi in covered), len(covered))}"
    )
    lines.append(f"false alarms in nulls: {share(sum(bool(t['found']) for t in none), len(none))}")
    lines.append(f"nulls called unknown: {share(sum(t['verdict'] == 'unknown' for t in none), len(none))}")
    return lines


def right(told: Sequence[Mapping[str, Any]]) -> str:
    return share(sum(each["right"] for each in told), len(told))


def _of(told: Sequence[Mapping[str, Any]], severity: str) -> list[Mapping[str, Any]]:
    return [each for each in told if each["severity"] == severity]


def _own(told: Mapping[str, Any], found: Mapping[str, Any]) -> Iterable[tuple[str, Sequence[float]]]:
    """Return the fitted parameters of the true effect."""
    return found["parameters"].items() if found["name"] == told["effect"] else ()


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.self_consistency", description=__doc__)
    parser.add_argument("--nulls", type=int, default=200, help="records without an effect  [default: 200]")
    parser.add_argument("--severities", nargs="+", choices=SEVERITIES, default=SEVERITIES, help="[default: all]")
    parser.add_argument("--effects", nargs="+", help="effects to make records of  [default: all]")
    parser.add_argument("--workers", type=int, default=2, help="processes  [default: 2]")
    parser.add_argument("--folder", type=Path, default=FOLDER, help="where outcomes are kept, a folder per source")
    asked = parser.parse_args()
    records = [made for made in with_effect(asked.severities) if not asked.effects or made.effect in asked.effects]
    told = computed([*records, *nulls(asked.nulls)], asked.folder / sources(), asked.workers)
    print(f"{'effect':15} {'':7} {'gap/floor':>9} {'beyond':>8} {'verdict':10} {'':7} true -> found")
    for each in told:
        if each["effect"]:
            print(line(each))
    for each in told:
        if not each["effect"] and (each["found"] or each["verdict"] != "none"):
            groups = "; ".join(" | ".join(found["group"]) for found in each["found"])
            print(f"{each['name']} ({each['case']}): {each['verdict']} {groups or ', '.join(each['unexplained'])}")
    print("\n".join(summary(told)))


if __name__ == "__main__":
    main()
