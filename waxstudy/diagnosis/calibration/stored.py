"""Calibrations that were made before, kept in the user's cache folder: a second record of a loop does not wait.

What is stored are numbers; the problems that they belong to are built from the healthy record again.
"""

from __future__ import annotations

import json
import logging
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from waxstudy.diagnosis.calibration.calibrate import (
    Calibration,
    Effects,
    calibrate,
    early_part,
    lasting_unknowns,
    weighed_by_left,
)
from waxstudy.diagnosis.calibration.healthy import Healthy
from waxstudy.diagnosis.estimate.hypothesis import Hypothesis
from waxstudy.diagnosis.model.as_built import AsBuilt, knobs
from waxstudy.diagnosis.model.conventions import Convention
from waxstudy.diagnosis.model.discrepancy import Discrepancy
from waxstudy.diagnosis.model.edits import with_effects
from waxstudy.diagnosis.model.nuisance import of_record
from waxstudy.diagnosis.model.segments import Segment, segments
from waxstudy.diagnosis.observations.partition import FIT
from waxstudy.diagnosis.observations.record import Record
from waxstudy.diagnosis.residuals.segment_problem import SegmentProblem
from waxstudy.plugin import Belief
from waxstudy.results.atomic import whole_file
from waxstudy.simulation.cache import cache_folder
from waxstudy.simulation.cache_place import private
from waxstudy.simulation.sources import digest, source_digest

log = logging.getLogger(__name__)
FOLDER, MOST = "calibrations", 200  # files that are kept, the newest
Kept = Mapping[str, Any]


def calibrated(record: Record, belief: Belief, effects: Effects, thorough: float, room_tolerance: float) -> Calibration:
    """Return what a healthy record says of a loop, from the cache where the same was asked before."""
    folder = private(cache_folder() / FOLDER)
    if folder is None:
        return calibrate(record, belief, effects, thorough, room_tolerance)
    path = folder / f"{_key(record, belief, effects, thorough, room_tolerance)}.json"
    try:
        return _recalled(json.loads(path.read_text(encoding="utf-8")), record, belief, effects, room_tolerance)
    except FileNotFoundError:
        pass
    except Exception as error:  # a damaged or foreign file may say anything
        log.info("%s cannot be used: %s", path, error)
    made = calibrate(record, belief, effects, thorough, room_tolerance)
    _write(path, _kept(made))
    return made


def _key(record: Record, belief: Belief, effects: Effects, thorough: float, room_tolerance: float) -> str:
    choices = [choice for choice in (*belief.blocks.values(), belief.room) if choice]
    used = [each.component.__module__ for each in choices] + [effect.__module__ for effect in effects]
    return digest(
        [
            repr(
                (
                    record.interval_s,
                    record.start_s,
                    sorted(record.stated_noise.items()),
                    record.assumed,
                    sorted(record.spreads.items()),
                )
            ),
            *(part for name, values in record.values.items() for part in (name, values.tobytes())),
            *_told(record),
            repr((dict(belief.blocks), belief.room, belief.room_error_factor, thorough, room_tolerance)),
            *(f"{effect.__module__}.{effect.__qualname__} {effect.name}" for effect in effects),
            *sorted({source_digest(module) for module in used}),
            _sources(),
        ]
    )


def _told(record: Record) -> Iterator[str | bytes]:
    """Yield what stands in for drives that nobody recorded."""
    for channel, found in record.stand_ins.items():
        yield repr((channel, found.factor_sd, found.factor_varies))
        yield found.values.tobytes()
        for shape in found.shapes:
            yield repr((shape.name, shape.sd, shape.is_once, shape.varies, shape.field))
            yield shape.heat_W.tobytes()


@cache
def _sources() -> str:
    files = [path for path in Path(__file__).parents[2].rglob("*") if path.suffix in (".py", ".csv")]
    return digest(sorted(files))


def _write(path: Path, kept: Kept) -> None:
    try:
        with whole_file(path) as temporary:
            temporary.write_text(json.dumps(kept), encoding="utf-8")
        for old in sorted(path.parent.glob("*.json"), key=os.path.getmtime)[:-MOST]:
            old.unlink(missing_ok=True)
    except OSError as error:
        log.info("a calibration cannot be kept in %s: %s", path.parent, error)


def _kept(made: Calibration) -> Kept:
    known = made.as_built
    return {
        "chain": [[knob.name, departure] for knob, departure in known.chain],
        "always": [[effect.name, dict(values)] for effect, values in known.always],
        "conventions": {name: asdict(each) for name, each in known.conventions.items()},
        "as_good": {name: [asdict(each) for each in ways] for name, ways in known.as_good.items()},
        "discrepancies": {channel: asdict(each) for channel, each in known.discrepancies.items()},
        "covariance": known.covariance.tolist(),
        "departures": {name: each.fitted.departures.tolist() for name, each in made.healthy.items()},
    }


def _recalled(kept: Kept, record: Record, belief: Belief, effects: Effects, room_tolerance: float) -> Calibration:
    """Return a calibration whose numbers are known; raise any error where they do not belong to it."""
    found, healthy = AsBuilt((), np.zeros(0), np.zeros((0, 0))), {}
    cut = [segment for segment in segments(record, belief) if not segment.is_supply]
    if {segment.name for segment in cut} != set(kept["departures"]):
        raise ValueError("other links")
    for segment in cut:
        read = (kept["conventions"][segment.name], *kept["as_good"].get(segment.name, ()))
        first, *others = (Convention(**each) for each in read)
        found = replace(
            found,
            conventions={**found.conventions, segment.name: first},
            as_good={**found.as_good, segment.name: tuple(others)},
            ways={**found.ways, segment.name: segment.conventions},
        )
        about = segment, record, belief, effects, found, kept
        found, problem, fitted = _of_room(*about, room_tolerance) if segment.with_room else _of_chain(*about)
        healthy[segment.name] = Healthy(problem, fitted)
    return Calibration(found, healthy)


def _of_chain(
    segment: Segment, record: Record, belief: Belief, effects: Effects, known: AsBuilt, kept: Kept
) -> tuple[AsBuilt, SegmentProblem, Hypothesis]:
    departures = {name: float(value) for name, value in kept["chain"]}
    chain = tuple((knob, departures[knob.name]) for knob in knobs(effects, segment.stages, belief))
    there = replace(known, chain=(*known.chain, *chain))
    named = {effect.name: effect for effect in effects}
    always = [(named[name], values) for name, values in kept["always"] if named[name].stage in segment.stages]
    believed = with_effects(there.believed(belief), always)
    parts = np.full(len(record), FIT)
    problem = SegmentProblem(segment, record, believed, as_built=there, unknowns=(), parts=parts)
    fitted = _at(problem, kept)
    return weighed_by_left(replace(there, always=(*there.always, *always)), problem, fitted)


def _of_room(
    segment: Segment,
    record: Record,
    belief: Belief,
    effects: Effects,
    known: AsBuilt,
    kept: Kept,
    room_tolerance: float,
) -> tuple[AsBuilt, SegmentProblem, Hypothesis]:
    lasting = lasting_unknowns(segment, record, belief, effects, room_tolerance)
    unknowns = [*lasting, *of_record(belief, record, segment.driven_by)]
    early = early_part(record)
    discrepancies = {channel: Discrepancy(**each) for channel, each in kept["discrepancies"].items()}
    found = replace(known, discrepancies=discrepancies)
    problem = SegmentProblem(segment, record, belief, as_built=found, unknowns=unknowns, parts=early)
    fitted = _at(problem, kept)
    covariance, count = np.array(kept["covariance"], dtype=float), len(lasting)
    if covariance.shape != (count, count):
        raise ValueError("other unknowns")
    found = replace(found, knobs=tuple(lasting), departures=fitted.departures[:count], covariance=covariance)
    return found, problem, fitted


def _at(problem: SegmentProblem, kept: Kept) -> Hypothesis:
    departures: Sequence[float] = kept["departures"][problem.name]
    if len(departures) != len(problem.sd):
        raise ValueError("other unknowns")
    fitted = problem.at((), np.array(departures, dtype=float), problem.conventions[0])
    if fitted is None:
        raise ValueError(f"{problem.name} cannot be simulated")
    return fitted
