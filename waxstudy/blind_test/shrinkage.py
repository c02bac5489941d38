"""How far a gap truly shrinks with what was claimed: on the record without noise, on held-out days."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from concurrent.futures import as_completed
from dataclasses import replace
from pathlib import Path
from typing import Any

from waxstudy.blind_test.draw import Case, Measured
from waxstudy.blind_test.make import Place, Tick
from waxstudy.blind_test.marks import Mark
from waxstudy.plugin.files import read_file
from waxstudy.plugin.trial import engine_of
from waxstudy.results.atomic import whole_file
from waxstudy.simulation.workers import worker_processes

SHORT_DAYS, LEAST_DAYS, LEAST_SHARE = 6, 3, 0.3  # a record from which days are held out; how many, or which share

Job = tuple[str, Mapping[str, Any], str, Mapping[str, float]]  # record, box, effect, values


def true_shrinkages(
    place: Place, who: str, own: Sequence[Mark], boxes: Mapping[str, Mapping[str, Any]], workers: int, tick: Tick
) -> dict[str, float]:
    """Return the true shrinkage of each record whose one effect was found; what was computed is kept."""
    folder = place.folder / "shrinkage" / who
    folder.mkdir(parents=True, exist_ok=True)
    jobs = [job for mark in own if (job := _job(mark, boxes))]
    known = {job[0]: _kept(folder / f"{job[0]}.json", job) for job in jobs}
    missing = [job for job in jobs if known[job[0]] is None]
    with worker_processes(workers) as pool:
        futures = {pool.submit(true_shrinkage, *job): job for job in missing}
        for number, future in enumerate(as_completed(futures)):
            job = futures[future]
            known[job[0]] = {**_asked(job), "shrinkage": future.result()}
            with whole_file(folder / f"{job[0]}.json") as path:
                path.write_text(json.dumps(known[job[0]]) + "\n", encoding="utf-8")
            tick(f"shrinkage of {number + 1} of {len(missing)}", (number + 1) / len(missing))
    found = {name: each["shrinkage"] for name, each in known.items() if each}
    return {name: value for name, value in found.items() if value is not None}


def _asked(job: Job) -> dict[str, Any]:
    _, box, effect, values = job
    return {"effect": effect, "values": dict(values), "beside": "healthy" if "baseline" in box else "believed"}


def _kept(path: Path, job: Job) -> dict[str, Any] | None:
    """Return what was computed before of the same claim, or None."""
    try:
        found: dict[str, Any] = json.loads(read_file(path))
        return found if {**found, **_asked(job)} == found and "shrinkage" in found else None
    except (OSError, ValueError, TypeError):
        return None


def _job(mark: Mark, boxes: Mapping[str, Mapping[str, Any]]) -> Job | None:
    """Return what is to be computed of a record, None where no effect with its values was rightly named."""
    if mark.truth.kind != "single" or mark.truth.is_measured or not mark.right_claims or mark.truth.over <= 1.0:
        return None
    claim = mark.right_claims[0][1]
    values = {name: said[0] for name, said in claim.parameters.items()}
    return (mark.truth.name, boxes[mark.truth.name], claim.name, values) if values else None


def true_shrinkage(name: str, box: Mapping[str, Any], effect_name: str, values: Mapping[str, float]) -> float | None:
    """Return 1 - after^2 / before^2 of the channel where the true gap stands out, on the last days; or None.

    What nobody knows of the room follows the days before, or a healthy record; a short record has no days to hold out.
    """
    from waxstudy.blind_test.record import without_noise
    from waxstudy.blind_test.sizes.missed import gaps
    from waxstudy.blind_test.truth import Stand, library, recorded, without_cause

    case = _case(box)
    staged = engine_of(case.engine).make(case.scene)
    about = without_noise(staged, case.measured)
    free = recorded(staged, replace(case.measured, missing=0.0), about)
    stand = Stand(about, free, (), staged.departures)
    stretch = stand.stretch_of(case.causes[0])
    effect = next((each for each in library() if each.name == effect_name), None)
    if stretch is None or effect is None:
        return None
    chosen = effect
    held_out = _held_out(case.measured.days)
    limits = gaps(stand.missed(stretch, free, ()))
    refit = replace(stand.refit(stretch, free, (), limits), held_out=held_out)
    if "baseline" in box:  # what is claimed has changed since
        refit = refit.beside(stand.refit(stretch, without_cause(case, staged, stand, 0), (), limits))
    after = refit.fitted(lambda belief: chosen.apply(belief, chosen.Parameters(**values)))
    if after is None:
        return None
    channel = box["causes"][0]["size"]["channel"]
    errors = (fit.missed[channel] for fit in (refit.base, after))
    old, new = (gaps({channel: each[-round((held_out or 1.0) * len(each)) :]})[channel] for each in errors)
    return 1.0 - new**2 / old**2


def _held_out(days: int) -> float:
    """Return the share of a record at its end that is held out."""
    return max(LEAST_DAYS / days, LEAST_SHARE) if days >= SHORT_DAYS else 0.0


def _case(box: Mapping[str, Any]) -> Case:
    scene, measured = box["scene"], Measured(**box["measured"])
    return Case(box["name"], box["stratum"], box["kind"], box["engine"], box["attempt"], measured, scene)
